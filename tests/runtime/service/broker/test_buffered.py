"""A socket that reads and sends in large pieces: nothing is lost, repeated or held back, and an end comes after the data."""

from __future__ import annotations

import select
import socket
import threading
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.runtime.service.broker.buffered import BufferedSocket


@pytest.fixture
def pair() -> Iterator[tuple[BufferedSocket, socket.socket]]:
    """A buffered socket that does not block, and its peer."""
    one, peer = socket.socketpair()
    one.setblocking(False)
    with one, peer:
        yield BufferedSocket(one), peer


class Calls:
    """A socket of which it is counted how often the system is called."""

    def __init__(self, inner: socket.socket) -> None:
        self.inner, self.count = inner, 0

    def recv(self, size: int) -> bytes:
        """Count and read."""
        self.count += 1
        return self.inner.recv(size)

    def send(self, data: bytes) -> int:
        """Count and send."""
        self.count += 1
        return self.inner.send(data)


@given(st.lists(st.binary(min_size=1, max_size=200), min_size=1, max_size=20), st.lists(st.integers(1, 64), min_size=1))
def test_what_is_read_is_what_was_sent(pieces: list[bytes], sizes: list[int]) -> None:
    """In whatever sizes it is asked for; the system is called once for all of it."""
    inner, peer = socket.socketpair()
    with inner, peer:
        inner.setblocking(False)
        calls = Calls(inner)
        one = BufferedSocket(calls)
        sent = b"".join(pieces)
        peer.sendall(sent)
        assert one.fill()
        got, turn = b"", 0
        while one.filled:
            got += one.recv(sizes[turn % len(sizes)])
            turn += 1
        assert got == sent
        assert calls.count == 1
        with pytest.raises(BlockingIOError):
            one.recv(1)
        for piece in pieces:
            one.send(piece)
        assert calls.count == 1
        one.flush()
        assert (calls.count, bytes(one.unsent)) == (2, b"")
        assert peer.recv(1 << 20) == sent


def test_nothing_has_come(pair: tuple[BufferedSocket, socket.socket]) -> None:
    """There is nothing to tell, and no end."""
    one, peer = pair
    assert not one.fill()
    with pytest.raises(BlockingIOError):
        one.recv(1)
    peer.sendall(b"x")
    assert one.fill()
    assert one.recv(10) == b"x"


def test_an_end_comes_after_the_data(pair: tuple[BufferedSocket, socket.socket]) -> None:
    """And again, as often as it is asked."""
    one, peer = pair
    peer.sendall(b"last")
    peer.close()
    assert one.fill()
    assert one.recv(10) == b"last"
    for _ in range(2):
        assert one.fill()
        assert one.recv(10) == b""


def test_a_broken_connection_is_told_by_recv_and_flush() -> None:
    """As the error that the system gave."""

    class Broken:
        """A connection that was reset."""

        def recv(self, _size: int) -> bytes:
            raise ConnectionResetError("reset")

        def send(self, _data: bytes) -> int:
            raise BrokenPipeError("broken")

    one = BufferedSocket(Broken())
    assert one.fill()
    for _ in range(2):
        with pytest.raises(ConnectionResetError):
            one.recv(1)
    one.send(b"x")
    with pytest.raises(BrokenPipeError):
        one.flush()


def test_what_the_peer_does_not_take_waits(pair: tuple[BufferedSocket, socket.socket]) -> None:
    """In order, and without a byte too few or too many."""
    one, peer = pair
    sent = b"".join(number.to_bytes(4, "big") for number in range(1_000_000))
    one.send(sent)
    one.flush()
    assert one.unsent
    got = bytearray()
    while one.unsent:
        got += peer.recv(1 << 20)
        one.flush()
    while len(got) < len(sent):
        got += peer.recv(1 << 20)
    assert got == sent


@pytest.mark.parametrize("polite", [True, False])
def test_only_a_regular_end_sends_what_waits(pair: tuple[BufferedSocket, socket.socket], polite: bool) -> None:
    """A process that lost its partition must say nothing more."""
    one, peer = pair
    peer.shutdown(socket.SHUT_WR)
    one.send(b"the last word")
    one.polite = polite
    one.close()
    one.close()
    assert peer.recv(100) == (b"the last word" if polite else b"")


def test_a_regular_end_while_something_comes() -> None:
    """The peer reads all of it and then a regular end, no broken connection, for which a broker would tell the last will."""
    with socket.create_server(("127.0.0.1", 0)) as server, socket.create_connection(server.getsockname()) as peer:
        inner, _ = server.accept()
        peer.sendall(b"an acknowledgement that nobody reads")
        select.select([inner], [], [], 60)
        one = BufferedSocket(inner)
        one.send(b"the last word")
        one.polite = True
        ending = threading.Thread(target=one.close)
        ending.start()
        assert [peer.recv(100), peer.recv(100)] == [b"the last word", b""]
        peer.close()
        ending.join()
    assert one.fileno() == -1


def test_a_regular_end_of_a_broken_connection(pair: tuple[BufferedSocket, socket.socket]) -> None:
    """It is closed all the same."""
    one, peer = pair
    peer.close()
    one.send(b"x")
    one.polite = True
    one.close()
    assert one.fileno() == -1
