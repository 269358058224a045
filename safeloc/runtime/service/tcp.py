"""Peers over TCP on the loopback interface: each sends lines, and gets the reports of its vehicles.

Behind a proxy that checks certificates, each connection begins with the proxy's header, and is for one vehicle.

Peers take turns. A few lines of a peer are handled at once, and the rest after all other peers had a turn: so a peer with
few lines never waits long for a peer with many. A peer whose waiting lines can be read at once has a part in every turn, so
lines that piled up while the process was busy are handled soon. Peers with more waiting lines share a short time.
"""

from __future__ import annotations

import selectors
import socket
import time
from collections import deque
from collections.abc import Iterator

from safeloc.errors import InputError
from safeloc.runtime.service.address import Address, bound
from safeloc.runtime.service.feeds import Arrived, Event, Feed, Left
from safeloc.runtime.service.introduction import Introduction
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.lines import Line, LineCutter
from safeloc.runtime.service.outlets import FULL, Outlet

AT_ONCE = 32_768
"""Bytes read from one peer; no more are read until their lines were handled."""

LINES_AT_ONCE = 16
"""Lines of one peer in a turn; a vehicle sends a handful in a cycle."""

FLOODS_S = 0.003
"""Seconds in each turn for all peers with more waiting lines than can be read at once."""

_MOST_PEERS = 200
_TOO_MUCH = 8 * FULL
"""Bytes of waiting reports with which a peer is disconnected, since it does not read."""


class _Peer:
    """One connection. Its lines are not read while too many reports wait for it, or while all reading is held."""

    def __init__(
        self, origin: str, sock: socket.socket, port: TcpPort, introduction: Introduction | None = None
    ) -> None:
        self.origin, self._sock, self._port, self._introduction = origin, sock, port, introduction
        self._cutter = LineCutter()
        self._buffer = bytearray()
        self._mask = 0
        self._lines: Iterator[Line] = iter(())
        self._next: Line | None = None
        self.ended = self.floods = False

    @property
    def behind(self) -> bool:
        """Return whether received lines of this peer are not handled yet."""
        return self._next is not None

    @property
    def deaf(self) -> bool:
        """Return whether too many reports wait for this peer to read its lines."""
        return len(self._buffer) > FULL

    def attend(self) -> None:
        """Update the selector: register for reading, for writing, for both or for nothing."""
        reads = not (self.ended or self._port.held or self.deaf or self.behind)
        mask = (selectors.EVENT_READ if reads else 0) | (selectors.EVENT_WRITE if self._buffer else 0)
        if mask == self._mask:
            return
        selector = self._port.selector
        if self._mask == 0:
            selector.register(self._sock, mask, self._ready)
        elif mask == 0:
            selector.unregister(self._sock)
        else:
            selector.modify(self._sock, mask, self._ready)
        self._mask = mask

    def put(self, data: bytes) -> None:
        """Buffer a line for the peer."""
        self._buffer += data

    @property
    def waiting(self) -> int:
        """Return the number of bytes that wait for this peer."""
        return len(self._buffer)

    def flush(self) -> None:
        """Write as much as the peer takes now. Disconnect a peer that is gone or does not read."""
        try:
            while self._buffer:
                del self._buffer[: self._sock.send(self._buffer)]
        except BlockingIOError:
            if len(self._buffer) > _TOO_MUCH:
                self._port.drop(self, "does not read")
                return
        except OSError as error:
            self._port.drop(self, str(error.strerror))
            return
        if self.ended and not self._buffer:
            self._port.drop(self, "")
        else:
            self.attend()

    def _ready(self, mask: int) -> Iterator[Event]:
        if mask & selectors.EVENT_WRITE:
            self._port.has_room(self)
        if mask & selectors.EVENT_READ and self._mask & selectors.EVENT_READ:
            yield from self._read()

    def _read(self) -> Iterator[Event]:
        try:
            data = self._sock.recv(AT_ONCE)
        except BlockingIOError:
            return
        except OSError as error:
            self._port.drop(self, str(error.strerror))
            yield Left(self.origin, "the connection broke")
            return
        if data:
            self.floods = len(data) == AT_ONCE  # more data wait to be read
            yield from self._take(data)
            return
        self.ended = True
        tail = self._cutter.tail()
        if tail is not None:
            yield Arrived(self.origin, tail._replace(cut=True), self._vehicle)
        yield Left(self.origin, "the peer closed the connection")
        self._port.has_room(self)
        self.attend()

    def _take(self, data: bytes) -> Iterator[Event]:
        if self._introduction is not None and self._vehicle is None:
            try:
                data = self._introduction.after(data)
            except InputError as error:
                self._port.drop(self, str(error))
                return
            if self._vehicle is not None:
                self._port.introduced(self, self._vehicle)
        self._lines = self._cutter.feed(data)
        self._next = next(self._lines, None)
        yield from self.next_lines()

    @property
    def _vehicle(self) -> str | None:
        """Return the only vehicle for which the peer may send, from the proxy's header; None without a proxy: any."""
        return None if self._introduction is None else self._introduction.vehicle

    def next_lines(self) -> Iterator[Event]:
        """Yield a few of the lines that were read; if there are more, the peer gets another turn."""
        for _ in range(LINES_AT_ONCE):
            line = self._next
            if line is None:
                break
            self._next = next(self._lines, None)
            yield Arrived(self.origin, line, self._vehicle)
        if self.behind:
            self._port.another_turn(self)
        if self.origin in self._port.peers:
            self.attend()

    def close(self) -> None:
        """Remove the peer, and its last incomplete line."""
        self._buffer.clear()
        self._lines, self._next = iter(()), None
        self.ended = True
        self.attend()
        self._sock.close()


class TcpPort(Feed, Outlet):
    """A listening port that reads from all peers and writes back. `proxied`: a proxy introduces each connection."""

    def __init__(self, where: Address, journal: Journal, *, proxied: bool = False) -> None:
        self._where, self._journal, self._proxied = where, journal, proxied
        self.peers: dict[str, _Peer] = {}
        self._left: list[Left] = []
        self._written: set[_Peer] = set()
        self._behind: deque[_Peer] = deque()
        self._flooding: deque[_Peer] = deque()
        self._waited = 0
        self._count = 0
        self.held = False

    def open(self, selector: selectors.BaseSelector) -> None:
        """Listen; InputError if the port is taken."""
        self.selector = selector
        self._listener = bound(self._where, socket.SOCK_STREAM)
        self._listener.listen()
        selector.register(self._listener, selectors.EVENT_READ, self._ready)
        host, port = self._listener.getsockname()[:2]
        self._journal.info("listening", protocol="proxy" if self._proxied else "tcp", host=host, port=port)

    def hold(self, held: bool) -> None:
        """Stop reading or continue: a connection that is not read fills up, and its sender waits."""
        if held is not self.held:
            self.held = held
            for peer in self.peers.values():
                peer.attend()

    def look(self) -> Iterator[Event]:
        """Yield the peers that disconnected during a write, then further lines of all other peers in turn."""
        left, self._left = self._left, []
        yield from left
        yield from self._more_of_all()
        yield from self._more_of_floods()
        self._waited = len(self._behind)

    def _more_of_all(self) -> Iterator[Event]:
        """Give a turn to each peer that was behind when the last turn ended; the others already had one."""
        for _ in range(min(self._waited, len(self._behind))):
            if self.held or not self._behind:
                return
            peer = self._behind.popleft()
            if peer.deaf:
                self._behind.append(peer)
            else:
                yield from peer.next_lines()

    def _more_of_floods(self) -> Iterator[Event]:
        until, turns = time.monotonic() + FLOODS_S, len(self._flooding)
        while self._flooding and turns and not self.held and time.monotonic() < until:
            peer = self._flooding.popleft()
            if peer.deaf:
                self._flooding.append(peer)
                turns -= 1  # its lines cannot be handled now; stop if that is so for all peers
            else:
                turns = len(self._flooding) + 1
                yield from peer.next_lines()

    def introduced(self, peer: _Peer, vehicle: str) -> None:
        """Record the vehicle that the proxy's header names."""
        self._journal.info("peer introduced", peer=peer.origin, vehicle=vehicle)

    def another_turn(self, peer: _Peer) -> None:
        """Schedule another turn for a peer with unread lines."""
        (self._flooding if peer.floods else self._behind).append(peer)

    @property
    def again_s(self) -> float | None:
        """Return 0 while there is something to write or to read."""
        readable = not self.held and any(not peer.deaf for peers in (self._behind, self._flooding) for peer in peers)
        return 0.0 if self._left or readable else None

    def put(self, origin: str, data: bytes, *, event: bool = False) -> None:
        """Buffer a line for a peer; if the peer is gone, count it in the log."""
        del event
        peer = self.peers.get(origin)
        if peer is None:
            self._journal.warning("unsent", origin=origin, bytes=len(data))
        else:
            peer.put(data)
            self._written.add(peer)

    def flush(self) -> None:
        """Write to every peer as much as it takes now; the selector reports when it takes the rest."""
        written, self._written = self._written, set()
        for peer in written:
            peer.flush()

    def has_room(self, peer: _Peer) -> None:
        """Note that a peer takes more now. The loop flushes, after it has saved whatever must be saved before."""
        self._written.add(peer)

    @property
    def full(self) -> bool:
        """Return False: each peer is held separately."""
        return False

    @property
    def waiting(self) -> bool:
        """Return whether reports wait for any peer."""
        return any(peer.waiting for peer in self.peers.values())

    def drop(self, peer: _Peer, why: str) -> None:
        """Disconnect a peer; `why` is empty if it ended the connection itself."""
        if self.peers.pop(peer.origin, None) is not None:
            self._journal.info("peer left", peer=peer.origin, why=why or "closed")
            if not peer.ended:
                self._left.append(Left(peer.origin, why))
            peer.close()
            for peers in (self._behind, self._flooding):
                if peer in peers:
                    peers.remove(peer)

    def close(self) -> None:
        """Disconnect all peers and stop listening."""
        for peer in list(self.peers.values()):
            peer.close()
        self.peers.clear()
        self._behind.clear()
        self._flooding.clear()
        self.selector.unregister(self._listener)
        self._listener.close()

    def _ready(self, _mask: int) -> Iterator[Event]:
        try:
            sock, where = self._listener.accept()
        except OSError as error:
            self._journal.warning("peer not taken", why=error.strerror)
            return
        if len(self.peers) >= _MOST_PEERS:
            self._journal.warning("peer not taken", why=f"{_MOST_PEERS} are there")
            sock.close()
            return
        sock.setblocking(False)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._count += 1
        peer = _Peer(f"tcp:{self._count}", sock, self, Introduction() if self._proxied else None)
        self.peers[peer.origin] = peer
        peer.attend()
        self._journal.info("peer came", peer=peer.origin, address=f"{where[0]}:{where[1]}")
        yield from ()
