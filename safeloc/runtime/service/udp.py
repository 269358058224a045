"""Datagrams on the loopback interface: they bring lines, and each report is sent as a separate datagram.

Datagrams may be lost, repeated or swapped, so every line needs a number; missing lines count as lost.
"""

from __future__ import annotations

import selectors
import socket
import time
from collections import deque
from collections.abc import Iterator
from typing import Any

from safeloc.runtime.service.address import Address, bound
from safeloc.runtime.service.feeds import Arrived, Event, Feed
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.lines import LONGEST_LINE, Line
from safeloc.runtime.service.outlets import FULL, Outlet

LINES_AT_ONCE = 256
"""Lines handled in one turn, up to the end of a datagram."""

MOST_LINES = 256
"""Most lines of one datagram; a vehicle sends a handful in a cycle. The rest is refused as one line."""

TURN_S = 0.005
"""Most seconds of a turn, up to the end of a datagram."""

_ROOM = 4_194_304
"""Size in bytes of the receive buffer that the operating system is asked for."""

MOST_WAITING = 10_000
"""Most waiting reports, and most remembered addresses. With more, the oldest are dropped; dropped reports are logged."""

MOST_BYTES = 8 * FULL
"""Most bytes of all waiting reports."""


class UdpPort(Feed, Outlet):
    """One socket for all peers; an origin is an address."""

    def __init__(self, where: Address, journal: Journal) -> None:
        self._where, self._journal = where, journal
        self._lines = 0
        self._addresses: dict[str, Any] = {}
        self._waiting: deque[tuple[str, bytes]] = deque()
        self._bytes = self._given_up = 0
        self._held = False

    def open(self, selector: selectors.BaseSelector) -> None:
        """Listen; InputError if the port is taken."""
        self._selector = selector
        self._socket = bound(self._where, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _ROOM)
        selector.register(self._socket, selectors.EVENT_READ, self._ready)
        host, port = self._socket.getsockname()[:2]
        self._journal.info("listening", protocol="udp", host=host, port=port)

    def hold(self, held: bool) -> None:
        """Stop reading or start again; datagrams that overflow meanwhile are lost, which line numbers show."""
        if held is not self._held:
            self._held = held
            if held:
                self._selector.unregister(self._socket)
            else:
                self._selector.register(self._socket, selectors.EVENT_READ, self._ready)

    def put(self, origin: str, data: bytes, *, event: bool = False) -> None:
        """Send a report to the address that the vehicle's last line came from."""
        del event
        self._waiting.append((origin, data))
        self._bytes += len(data)
        while len(self._waiting) > MOST_WAITING or self._bytes > MOST_BYTES:
            self._bytes -= len(self._waiting.popleft()[1])
            self._given_up += 1

    def flush(self) -> None:
        """Send each report as a datagram, as long as the system takes them."""
        while self._waiting and self._sent(*self._waiting[0]):
            self._bytes -= len(self._waiting.popleft()[1])
        if self._given_up:
            self._journal.warning("unsent", reports=self._given_up, why="the system takes no more")
            self._given_up = 0

    @property
    def full(self) -> bool:
        """Return False: reports that cannot be sent are dropped."""
        return False

    @property
    def waiting(self) -> bool:
        """Return whether reports wait."""
        return bool(self._waiting)

    @property
    def again_s(self) -> float | None:
        """Return the time until the next `look`: short while reports wait."""
        return 0.001 if self._waiting else None

    def close(self) -> None:
        """Stop reading and close the socket."""
        self.hold(True)
        self._socket.close()

    def _sent(self, origin: str, data: bytes) -> bool:
        """Send a datagram; return whether the next one can be tried, because this one is sent or dropped."""
        where = self._addresses.get(origin)
        if where is None:
            self._journal.warning("unsent", origin=origin, bytes=len(data), why="no address is known")
            return True
        try:
            self._socket.sendto(data, where)
        except BlockingIOError:
            return False
        except OSError as error:
            self._journal.warning("unsent", origin=origin, bytes=len(data), why=error.strerror)
        return True

    def _ready(self, _mask: int) -> Iterator[Event]:
        until, before = time.monotonic() + TURN_S, self._lines
        while self._lines < before + LINES_AT_ONCE and time.monotonic() < until:
            try:
                data, where = self._socket.recvfrom(LONGEST_LINE)
            except BlockingIOError:
                return
            except OSError as error:
                self._journal.warning("not received", why=error.strerror)
                return
            origin = f"udp:{where[0]}:{where[1]}"
            self._addresses[origin] = where
            if len(self._addresses) > MOST_WAITING:
                del self._addresses[next(iter(self._addresses))]
            yield from self._lines_in(origin, data)

    def _lines_in(self, origin: str, data: bytes) -> Iterator[Event]:
        for number, text in enumerate(data.split(b"\n", MOST_LINES)):
            if text:
                self._lines += 1
                flaw = f"more than {MOST_LINES} lines in one datagram" if number == MOST_LINES else ""
                yield Arrived(origin, Line(self._lines, b"" if flaw else text, flaw))
