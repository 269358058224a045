"""Sockets under load: peers take turns, a turn is short, and what waits is bounded."""

from __future__ import annotations

import os
import select
import selectors
import socket
from collections.abc import Iterator
from typing import Any

import pytest

from safeloc.runtime.service import udp
from safeloc.runtime.service.address import Address
from safeloc.runtime.service.feeds import Arrived, Event, Left
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.replies import FACTOR, FIRST_BYTES, Allowance
from safeloc.runtime.service.tcp import AT_ONCE, LINES_AT_ONCE, TcpPort
from safeloc.runtime.service.udp import LINES_AT_ONCE as LINES_OF_A_TURN
from safeloc.runtime.service.udp import MOST_LINES, UdpPort
from tests.runtime.service.processes import wait_for

HERE = Address("127.0.0.1", 0)


class Turns:
    """A port that is driven turn by turn, as the loop does."""

    def __init__(self, port: TcpPort | UdpPort) -> None:
        self.port, self.selector = port, selectors.SelectSelector()
        port.open(self.selector)

    def turn(self) -> list[Event]:
        """What is heard in one."""
        heard = [event for key, mask in self.selector.select(0.05) for event in key.data(mask)]
        return [*heard, *self.port.look()]

    def peer(self) -> socket.socket:
        """A connection to it."""
        made = socket.create_connection(self.selector_port())
        assert isinstance(self.port, TcpPort)
        known = len(self.port.peers)
        wait_for(lambda: self.turn() is not None and len(self.port.peers) > known, "no peer")  # type: ignore[union-attr]
        return made

    def selector_port(self) -> tuple[str, int]:
        """Where it listens."""
        sock: Any = getattr(self.port, "_listener", None) or self.port._socket
        return sock.getsockname()[:2]


@pytest.fixture
def journal() -> Iterator[Journal]:
    """That nobody reads."""
    fd = os.open(os.devnull, os.O_WRONLY)
    yield Journal(fd)
    os.close(fd)


@pytest.fixture
def tcp(journal: Journal) -> Iterator[Turns]:
    """A port for connections."""
    turns = Turns(TcpPort(HERE, journal))
    yield turns
    turns.port.close()


@pytest.fixture
def datagrams(journal: Journal) -> Iterator[Turns]:
    """A port for datagrams."""
    turns = Turns(UdpPort(HERE, journal))
    yield turns
    turns.port.close()


def lines_of(events: list[Event], origin: str) -> list[bytes]:
    """What was heard of one peer."""
    return [event.line.text for event in events if isinstance(event, Arrived) and event.origin == origin]


def test_who_says_little_is_heard_before_who_says_much(tcp: Turns, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a flood only a few lines come before another peer's own; then the flood goes on where it was, in order."""
    monkeypatch.setattr("safeloc.runtime.service.tcp.FLOODS_S", 0.0)
    loud, calm = tcp.peer(), tcp.peer()
    flood = [b"%07d" % n for n in range(AT_ONCE // 4)]
    loud.sendall(b"\n".join(flood) + b"\n")
    first = tcp.turn()
    calm.sendall(b"calm\n")
    heard = list(first)
    wait_for(lambda: heard.extend(tcp.turn()) or lines_of(heard, "tcp:2") == [b"calm"], "calm is not heard")
    assert len(lines_of(heard, "tcp:1")) <= 4 * LINES_AT_ONCE
    monkeypatch.setattr("safeloc.runtime.service.tcp.FLOODS_S", 0.003)
    wait_for(lambda: heard.extend(tcp.turn()) or len(lines_of(heard, "tcp:1")) == len(flood), "the rest is not heard")
    assert lines_of(heard, "tcp:1") == flood
    loud.close()
    wait_for(lambda: heard.extend(tcp.turn()) or Left("tcp:1", "the peer closed the connection") in heard, "not gone")
    calm.close()


def test_who_fell_behind_is_heard_in_every_turn(tcp: Turns, monkeypatch: pytest.MonkeyPatch) -> None:
    """What piled up while the process had no time: some lines a turn, no more than of those that keep up, and beside a flood
    that has no time left."""
    monkeypatch.setattr("safeloc.runtime.service.tcp.FLOODS_S", 0.0)
    loud, late, later = tcp.peer(), tcp.peer(), tcp.peer()
    loud.sendall(b"x\n" * AT_ONCE)
    for peer in (late, later):
        peer.sendall(b"".join(b"%d\n" % n for n in range(100)))
    heard: list[Event] = []
    for turn in range(1, 7):
        told = tcp.turn()
        assert [LINES_AT_ONCE] * 2 == [len(lines_of(told, origin)) for origin in ("tcp:2", "tcp:3")], turn
        heard += told
    heard += tcp.turn()
    assert [b"%d" % n for n in range(100)] == lines_of(heard, "tcp:2") == lines_of(heard, "tcp:3")
    assert len(lines_of(heard, "tcp:1")) == LINES_AT_ONCE
    for peer in (loud, late, later):
        peer.close()


def test_no_more_is_read_of_a_peer_than_is_heard(tcp: Turns, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its sender waits instead: a peer in arrears is not read from."""
    monkeypatch.setattr("safeloc.runtime.service.tcp.FLOODS_S", 0.0)
    loud = tcp.peer()
    loud.setblocking(False)
    sent = 0
    while loud in select.select([], [loud], [], 0.1)[1]:
        sent += loud.send(b"x\n" * 50_000)
    heard = [event for _ in range(20) for event in tcp.turn()]
    assert len(heard) == LINES_AT_ONCE
    assert AT_ONCE // 2 < sent // 2
    loud.close()


def test_a_held_port_gives_nothing(tcp: Turns, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor does it keep the loop awake."""
    monkeypatch.setattr("safeloc.runtime.service.tcp.FLOODS_S", 0.0)
    loud = tcp.peer()
    loud.sendall(b"x\n" * 1_000)
    wait_for(lambda: bool(tcp.turn()), "nothing is heard")
    assert tcp.turn()
    tcp.port.hold(True)
    assert tcp.turn() == []
    assert tcp.port.again_s is None
    tcp.port.hold(False)
    assert tcp.port.again_s == 0.0
    loud.close()


def test_a_turn_of_datagrams_is_short(datagrams: Turns, monkeypatch: pytest.MonkeyPatch) -> None:
    """However many lines stand in them: some hundred a turn, and of one datagram so many and no more."""
    monkeypatch.setattr(udp, "TURN_S", 60.0)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        for _ in range(8):
            peer.sendto(b"x\n" * 32_000, datagrams.selector_port())
        heard = datagrams.turn()
    assert len(heard) <= LINES_OF_A_TURN + MOST_LINES + 1
    flaws = [event.line.flaw for event in heard if isinstance(event, Arrived) and event.line.flaw]
    assert set(flaws) == {f"more than {MOST_LINES} lines in one datagram"}


def test_datagrams_that_wait_are_bounded(datagrams: Turns, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also within one turn, before anything is handed over; the oldest are given up, in number and in bytes."""
    monkeypatch.setattr(udp, "MOST_WAITING", 10)
    monkeypatch.setattr(udp, "MOST_BYTES", 1_000)
    port: Any = datagrams.port
    for number in range(50):
        port.put("udp:127.0.0.1:9", b"%d" % number)
    assert [data for _, data in port._waiting] == [b"%d" % number for number in range(40, 50)]
    port.put("udp:127.0.0.1:9", b"x" * 995)
    assert len(port._waiting) == 3
    port.flush()
    assert not port.waiting


@pytest.mark.parametrize("line", [b"", b"x", b"[" * 300, b"{" * 60_000])
def test_refusals_are_a_small_factor_of_what_is_refused(line: bytes) -> None:
    """Of any flood of bad lines; the first few are all answered, and what was left out is counted."""
    allowance, told, left_out = Allowance(), 0, 0
    for _ in range(2_000):
        allowance.line_came("peer", len(line) + 1)
        refusal = allowance.refusal("peer", {"event": "refused"}, 120)
        if refusal is not None:
            told, left_out = told + 1, left_out + refusal.get("left_out", 0)
    assert told * 120 <= FIRST_BYTES + FACTOR * 2_000 * (len(line) + 1)
    assert told >= FIRST_BYTES // 120
    assert told + left_out <= 2_000 <= told + left_out + 120 // FACTOR


def test_peers_that_are_gone_are_forgotten() -> None:
    """What is remembered of them is bounded."""
    allowance = Allowance()
    for number in range(20_000):
        allowance.line_came(f"udp:127.0.0.1:{number}", 1)
    assert len(allowance._bytes) <= 10_000
