"""A connection to a broker of some bytes: what goes past paho-mqtt and what it does itself are in order and complete."""

from __future__ import annotations

import selectors
import socket
import struct
from collections.abc import Iterator
from typing import Any

import pytest

from safeloc.runtime.service.broker import connection as module
from safeloc.runtime.service.broker.connection import Connection
from safeloc.runtime.service.broker.packets import Came, publish
from safeloc.runtime.service.broker.settings import Broker

pytest.importorskip("paho.mqtt.client")

CONNACK, PINGREQ = b"\x20\x02\0\0", b"\xc0\0"
TOPIC = "fleet/records/3/v1"


class Peer:
    """The broker's end of one connection."""

    def __init__(self, *, lasting: bool) -> None:
        self._server = socket.create_server(("127.0.0.1", 0))
        broker = Broker("127.0.0.1", self._server.getsockname()[1], "fleet", partitions=4, lease_s=5.0)
        self.selector = selectors.DefaultSelector()
        self.one = Connection(broker, "session", ("will", b""), lasting=lasting)
        self.one.open(self.selector)
        self.sock, _ = self._server.accept()
        self.sock.settimeout(5.0)
        self.heard()
        self.says(CONNACK)
        assert self.one.ready

    def heard(self) -> bytes:
        """What the connection has sent."""
        self.one.flush()
        return self.sock.recv(1 << 20)

    def says(self, data: bytes) -> None:
        """Send it, and let the connection read."""
        self.sock.sendall(data)
        for key, mask in self.selector.select(5.0):
            list(key.data(mask))

    def close(self) -> None:
        """End it."""
        self.one.close(politely=False)
        self.sock.close()
        self._server.close()
        self.selector.close()


@pytest.fixture
def peer() -> Iterator[Peer]:
    """The broker's end of a lasting connection."""
    made = Peer(lasting=True)
    yield made
    made.close()


def record(mid: int, payload: bytes = b"{}\n") -> bytes:
    """A record of QoS 1."""
    body = struct.pack(">H", len(TOPIC)) + TOPIC.encode() + struct.pack(">H", mid) + payload
    assert len(body) < 128
    return bytes((0x32, len(body))) + body


def came(peer: Peer) -> list[int]:
    """The identifiers of the records that came."""
    found = [one.mid for one in peer.one.came]
    peer.one.came.clear()
    return found


def test_records_come_in_order_whatever_is_between_them(peer: Peer) -> None:
    """Also cut anywhere, and around a packet for paho, which confirms what was published."""
    renewal = peer.one.publish("lease", b"mine", qos=1, retained=True)
    sent = peer.heard()
    mid = sent[4 + sent[3] : 6 + sent[3]]
    data = record(1) + b"\x40\x02" + mid + record(2) + record(3)
    for cut in range(1, 40):
        peer.says(data[:cut])
        peer.says(data[cut:])
        assert came(peer) == [1, 2, 3]
    assert renewal.is_published()
    assert not peer.one.lost


def test_a_long_record_goes_through_paho(peer: Peer) -> None:
    """It is the same message, and the one behind it is not lost."""
    name = TOPIC.encode()
    body = struct.pack(">H", len(name)) + name + b"\0\1" + bytes(300_000)
    size = len(body)
    data = bytes((0x32, size % 128 + 128, size // 128 % 128 + 128, size // 16_384)) + body + record(2)
    for at in range(0, len(data), 50_000):
        peer.says(data[at : at + 50_000])
    while len(peer.one.came) < 2:
        peer.says(b"")
    assert peer.one.came[0] == Came(TOPIC, bytes(300_000), 1, retained=False, again=False)
    assert came(peer) == [1, 2]


def test_what_is_sent_keeps_its_order(peer: Peer) -> None:
    """A report behind a lease, an acknowledgement behind both, and a lease behind that."""
    peer.one.publish("lease", b"first", qos=1, retained=True)
    peer.one.publish("report", b"second", retained=True)
    peer.one.acknowledge(7)
    peer.one.publish("lease", b"fourth", qos=1, retained=True)
    sent = peer.heard()
    places = [
        sent.index(part) for part in (b"first", publish("report", b"second", retained=True), b"\x40\x02\0\7", b"fourth")
    ]
    assert places == sorted(places)


def test_what_is_published_past_paho_is_what_it_publishes(peer: Peer) -> None:
    """Byte for byte."""
    other = Peer(lasting=False)
    for topic, payload, retained in (("reports/3/v1", b"{}", True), ("events/é", b"x" * 20_000, False)):
        peer.one.publish(topic, payload, retained=retained)
        other.one.publish(topic, payload, retained=retained)
        assert peer.heard() == other.heard()
    other.close()


def test_paho_hears_that_the_broker_is_there(peer: Peer, monkeypatch: pytest.MonkeyPatch) -> None:
    """It gets a record each second; else it would take a broker for dead that sends nothing but records."""
    through: list[Any] = []
    inner = peer.one._client.on_message
    peer.one._client.on_message = lambda *given: (through.append(given[2].mid), inner(*given))  # type: ignore[func-returns-value, misc]
    now = [1_000.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    for second in range(3):
        now[0] += 1.0
        peer.one.look()
        peer.says(b"".join(record(10 * second + some) for some in range(1, 5)))
    assert through == [1, 11, 21]
    assert came(peer) == [1, 2, 3, 4, 11, 12, 13, 14, 21, 22, 23, 24]


@pytest.mark.parametrize("last", [b"", record(2)[:5], b"\x32"])
def test_the_end_of_a_connection(peer: Peer, last: bytes) -> None:
    """What came whole is there, half a packet is not."""
    peer.says(record(1) + last)
    peer.sock.close()
    for _ in range(2):
        for key, mask in peer.selector.select(1.0):
            list(key.data(mask))
    assert peer.one.lost
    assert came(peer) == [1]


def test_what_is_no_mqtt_ends_the_connection(peer: Peer) -> None:
    """A length of five bytes."""
    peer.says(record(1) + b"\x32\xff\xff\xff\xff\x7f")
    assert peer.one.lost
    assert came(peer) == [1]
