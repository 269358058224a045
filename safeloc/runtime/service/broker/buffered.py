"""A socket whose data are read and sent in large pieces, though its user reads and sends a few bytes at a time.

paho-mqtt calls the system three times for each packet that it reads, and once for each that it sends. Each call lets
another thread have the interpreter, and while a snapshot is written that thread keeps it for half a millisecond.
"""

from __future__ import annotations

import socket
import ssl
import time
from contextlib import suppress
from typing import Any

_PIECE = 65_536
"""Most bytes that are read at once."""

_LAST_S = 1.0
"""Most seconds for what is left to be sent at a regular end, and for the other end to close."""


class BufferedSocket:
    """A non-blocking socket, or a TLS socket, with a buffer in each direction.

    unsent   bytes that `flush` has not handed to the system yet
    polite   `close` is a regular end
    """

    def __init__(self, inner: Any) -> None:
        self._inner = inner
        self._came, self._at = b"", 0
        self._ended: OSError | bool = False
        self.unsent = bytearray()
        self.polite = False

    def fill(self) -> bool:
        """Read what is there, up to one piece; return whether there is anything for `recv` to tell, an end included."""
        if self._at < len(self._came) or self._ended:
            return True
        try:
            self._came, self._at = self._inner.recv(_PIECE), 0
        except (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError):
            return False
        except OSError as error:
            self._ended = error
            return True
        self._ended = not self._came
        return True

    @property
    def filled(self) -> bool:
        """Return whether read bytes are left."""
        return self._at < len(self._came)

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
        """Return up to so many bytes that `fill` has read; b"" at the end, BlockingIOError if none are left."""
        if self._at >= len(self._came):
            if isinstance(self._ended, OSError):
                raise self._ended
            if self._ended:
                return b""
            raise BlockingIOError
        data = self._came[self._at : self._at + size]
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
