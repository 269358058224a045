"""The packets that go past paho-mqtt are those that it would read and make itself."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.runtime.service.broker.packets import Came, acknowledgement, extent, publish, read_publish

packet = pytest.importorskip("paho.mqtt._packet")
client = pytest.importorskip("paho.mqtt.client")

TOPIC = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=30)


def framed(first: int, body: bytes) -> bytes:
    """A packet with this body."""
    size, left = bytearray(), len(body)
    while True:
        left, low = divmod(left, 128)
        size.append(low | (0x80 if left else 0))
        if not left:
            return bytes((first, *size)) + body


def as_paho_reads(first: int, body: bytes) -> Came | None:
    """The message that paho finds in a PUBLISH; None if it finds the packet malformed."""
    try:
        found = packet.decode_publish(first, bytearray(body), client.MQTTv311)
    except (client.MalformedPacket, struct.error, ValueError):
        return None
    return Came(found.topic.decode(), bytes(found.payload), found.mid or 0, found.retain, found.dup)


@given(TOPIC, st.binary(max_size=300), st.integers(1, 65_535), st.sampled_from([0x30, 0x31, 0x32, 0x33, 0x3A, 0x3B]))
def test_a_message_is_read_as_by_paho(topic: str, payload: bytes, mid: int, first: int) -> None:
    """Topic, payload, identifier, and both flags; wherever in the data it stands."""
    name = topic.encode()
    body = struct.pack(">H", len(name)) + name + (struct.pack(">H", mid) if first & 6 else b"") + payload
    data = b"before" + framed(first, body) + b"behind"
    found = extent(data, 6)
    assert found is not None
    begin, end = found
    assert data[begin:end] == body
    came = read_publish(data[6], data, begin, end)
    assert (
        came
        == as_paho_reads(first, body)
        == Came(topic, payload, mid if first & 6 else 0, bool(first & 1), bool(first & 8))
    )


@given(st.integers(0, 255), st.binary(max_size=40))
def test_whatever_comes_is_read_as_by_paho_or_left_to_it(first: int, body: bytes) -> None:
    """What is no PUBLISH, or a flawed one, is not taken."""
    came = read_publish(first, body, 0, len(body))
    if came is None:
        return
    assert first & 0xF0 == 0x30
    try:
        assert came == as_paho_reads(first, body)
    except UnicodeDecodeError:
        assert came.topic == ""


@pytest.mark.parametrize(
    ("first", "body"),
    [
        (0x34, b"\0\1t\0\1payload"),  # QoS 2
        (0x36, b"\0\1t\0\1payload"),  # no QoS at all
        (0x40, b"\0\1"),  # PUBACK
        (0x30, b""), (0x30, b"\0"), (0x30, b"\0\0payload"), (0x30, b"\0\7topic"),  # without a topic, or with half of one
        (0x32, b"\0\1t"), (0x32, b"\0\1t\1"), (0x32, b"\0\1t\0\0payload"),  # without an identifier
    ],
)  # fmt: skip
def test_what_is_left_to_paho(first: int, body: bytes) -> None:
    """It decides what becomes of the connection."""
    assert read_publish(first, body, 0, len(body)) is None


def test_a_topic_that_is_no_text() -> None:
    """It is the topic of nobody."""
    body = b"\0\2\xff\xfe\0\7payload"
    assert read_publish(0x32, body, 0, len(body)) == Came("", b"payload", 7, retained=False, again=False)


@pytest.mark.parametrize("length", [0, 1, 127, 128, 16_383, 16_384, 2_097_151, 2_097_152, 268_435_455])
def test_where_a_packet_ends(length: int) -> None:
    """Its length has one to four bytes; as long as they are not all there, the end is not known."""
    size, left = bytearray(), length
    while left >= 128:
        size.append(left % 128 + 128)
        left //= 128
    size.append(left)
    data = bytes((0x30, *size))
    assert extent(data, 0) == (len(data), len(data) + length)
    assert all(extent(data[:some], 0) is None for some in range(len(data)))


def test_a_length_of_five_bytes_has_no_end() -> None:
    """It is no MQTT, which the client finds."""
    found = extent(b"\x30\xff\xff\xff\xff\x01", 0)
    assert found is not None
    assert found[1] > 1 << 60


@given(TOPIC, st.binary(max_size=20_000), st.booleans())
def test_a_report_is_read_back(topic: str, payload: bytes, retained: bool) -> None:
    """As a message of QoS 0."""
    made = publish(topic, payload, retained=retained)
    found = extent(made, 0)
    assert found is not None
    assert found[1] == len(made)
    assert read_publish(made[0], made, *found) == Came(topic, payload, 0, retained, again=False)


@given(st.integers(1, 65_535))
def test_an_acknowledgement(mid: int) -> None:
    """PUBACK with the identifier."""
    assert acknowledgement(mid) == b"\x40\x02" + struct.pack(">H", mid)
