"""The packets of MQTT 3.1.1 that come and go with each record: PUBLISH of QoS 0 and 1, and PUBACK.

The client (paho-mqtt) does everything else: it reads and makes these packets too, but needs several times as long.
"""

from __future__ import annotations

from typing import NamedTuple

LONGEST = 65_536
"""Most bytes of a packet that is read or made here."""

_PUBLISH, _PUBACK = 0x30, 0x40
_RETAINED, _AGAIN = 0x01, 0x08
_MORE = 0x80
_MOST_LENGTH_BYTES = 4
_ENDLESS = 1 << 62


class Came(NamedTuple):
    """A message from the broker.

    mid     for its acknowledgement; 0 if it needs none
    again   the broker says that it has sent it before
    """

    topic: str
    payload: bytes
    mid: int
    retained: bool
    again: bool


def extent(data: bytes, at: int) -> tuple[int, int] | None:
    """Return where the body of the packet at this place begins, and where it ends, which may be beyond the data.

    None if the data end before its length does. A length of too many bytes has no end: what follows is no MQTT.
    """
    length = shift = 0
    for place in range(at + 1, at + 1 + _MOST_LENGTH_BYTES):
        if place >= len(data):
            return None
        byte = data[place]
        length |= (byte & 0x7F) << shift
        if byte < _MORE:
            return place + 1, place + 1 + length
        shift += 7
    return at, _ENDLESS


def read_publish(first: int, data: bytes, begin: int, end: int) -> Came | None:
    """Return the message of a PUBLISH with this first byte and body; None for any other packet, and for a flawed one."""
    quality = first >> 1 & 3
    if first & 0xF0 != _PUBLISH or quality > 1 or end - begin < 2:
        return None
    topic = begin + 2
    payload = last = topic + (data[begin] << 8 | data[begin + 1])
    if quality:
        payload += 2
    if payload > end:
        return None
    mid = data[last] << 8 | data[last + 1] if quality else 0
    if last == topic or (quality and not mid):
        return None
    return Came(_topic(data[topic:last]), data[payload:end], mid, bool(first & _RETAINED), bool(first & _AGAIN))


def _topic(data: bytes) -> str:
    try:
        return data.decode()
    except UnicodeDecodeError:
        return ""  # no topic of ours


def publish(topic: str, payload: bytes, *, retained: bool) -> bytes:
    """Return a PUBLISH of QoS 0."""
    name = topic.encode()
    first = _PUBLISH | _RETAINED if retained else _PUBLISH
    return b"%b%b%b%b" % (_head(first, 2 + len(name) + len(payload)), len(name).to_bytes(2, "big"), name, payload)


def acknowledgement(mid: int) -> bytes:
    """Return a PUBACK."""
    return bytes((_PUBACK, 2, mid >> 8, mid & 0xFF))


def _head(first: int, length: int) -> bytes:
    head = [first]
    while length >= _MORE:
        head.append(length & 0x7F | _MORE)
        length >>= 7
    head.append(length)
    return bytes(head)
