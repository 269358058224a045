"""A socket whose data are read and sent in large pieces, though its user reads and sends a few bytes at a time.

paho-mqtt calls the system three times for each packet that it reads, and once for each that it sends. Each call lets
another thread have the interpreter, and while a snapshot is written that thread keeps it for half a millisecond.

Whole packets can be taken out of what came, so that paho never sees them (`sift`).
"""

from __future__ import annotations

import socket
import ssl
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from safeloc.runtime.service.broker.packets import LONGEST, extent

_PIECE = 65_536
"""Most bytes that are read at once."""

_LAST_S = 1.0
"""Most seconds for what is left to be sent at a regular end, and for the other end to close."""


class BufferedSocket:
    """A non-blocking socket, or a TLS socket, with a buffer in each direction.

    take     is given each complete packet of up to LONGEST bytes: its first byte, and where in the data its body begins and
             ends; if it returns False, the packet is left for `recv`, as everything is without `take`
    unsent   bytes that `flush` has not handed to the system yet
    polite   `close` is a regular end
    """

    def __init__(self, inner: Any, take: Callable[[int, bytes, int, int], bool] | None = None) -> None:
        self._inner, self._take = inner, take
        self._came, self._at = b"", 0
        self._free = 0  # up to this place `recv` may read
        self._owed = 0  # bytes of a long packet that `recv` may read and that have not come yet
        self._ended: OSError | bool = False
        self.unsent = bytearray()
        self.polite = False

    def fill(self) -> bool:
        """Read what is there, up to one piece; return whether there is anything new to sift or to be told by `recv`, an end
        included."""
        if self.filled or self._ended:
            return True
        try:
            piece = self._inner.recv(_PIECE)
        except (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError):
            return False
        except OSError as error:
            self._ended = error
            piece = b""
        self._ended = self._ended or not piece
        self._came, self._at = self._came[self._at :] + piece, 0
        self._free = len(self._came) if self._take is None else min(self._owed, len(piece))
        self._owed -= min(self._owed, len(piece))
        return True

    def sift(self) -> bool:
        """Let `take` have the packets in front, up to one that it does not want, or that is not complete. Return whether
        there is anything for `recv` to tell."""
        if self._take is not None and not self.filled:
            self._sift(self._take)
        return self.filled or bool(self._ended)

    def _sift(self, take: Callable[[int, bytes, int, int], bool]) -> None:
        data, at = self._came, self._at
        while at < len(data):
            body = extent(data, at)
            if body is None or body[1] > len(data):
                if self._ended or (body is not None and body[1] - at > LONGEST):
                    self._owed = 0 if body is None else body[1] - len(data)
                    self._free = len(data)
                break
            if not take(data[at], data, *body):
                self._free = body[1]
                break
            at = body[1]
        self._at = at

    @property
    def filled(self) -> bool:
        """Return whether bytes are left for `recv`."""
        return self._at < self._free

    @property
    def decrypted(self) -> bool:
        """Return whether TLS has decrypted bytes that no selector reports."""
        return hasattr(self._inner, "pending") and self._inner.pending() > 0

    def flush(self) -> None:
        """Hand as much to the system as it takes now; OSError if the connection is broken."""
        while self.unsent:
            try:
                del self.unsent[: self._inner.send(self.unsent)]
            except (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError):
                return

    # ------------------------------------------------------------------ as paho-mqtt uses a socket

    def recv(self, size: int) -> bytes:
        """Return up to so many bytes that were read and not taken; b"" at the end, BlockingIOError if none are left."""
        if self._at >= self._free:
            if self._free < len(self._came):
                raise BlockingIOError  # `sift` has to look at the rest
            if isinstance(self._ended, OSError):
                raise self._ended
            if self._ended:
                return b""
            raise BlockingIOError
        data = self._came[self._at : min(self._at + size, self._free)]
        self._at += len(data)
        return data

    def send(self, data: bytes | bytearray) -> int:
        """Keep all bytes for `flush`."""
        self.unsent += data
        return len(data)

    def fileno(self) -> int:
        """Return the number of the socket, for selectors."""
        return int(self._inner.fileno())

    def setblocking(self, flag: bool) -> None:
        """Set it on the socket."""
        self._inner.setblocking(flag)

    def close(self) -> None:
        """Close the socket. What is unsent is lost, or at a regular end sent before, within a second."""
        if self.polite:
            self.polite = False
            with suppress(OSError):  # the connection is broken: nothing more can be said
                self._say_all()
        self._inner.close()

    def _say_all(self) -> None:
        """Send what is left, and wait until the other end has read all of it and closes.

        A socket that is closed while something comes is reset, and the broker tells the last will though the end was regular.
        """
        until = time.monotonic() + _LAST_S
        self._inner.settimeout(_LAST_S)
        self._inner.sendall(self.unsent)
        self._inner.shutdown(socket.SHUT_WR)
        while (left_s := until - time.monotonic()) > 0:
            self._inner.settimeout(left_s)
            if not self._inner.recv(_PIECE):
                return
