"""Signs of life for the supervisor of the process: notifications to systemd (sd_notify), and a file for a health check.

The loop itself gives them between two turns, so a process that hangs gives none.
"""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from safeloc.errors import InputError

_FILE_EVERY_S = 1.0
"""Seconds between two touches of the file."""

_TELL_EVERY_S = 1.0
"""Seconds between two signs to the parent of a worker."""


class Supervised:
    """The signs of life of this process.

    alive        a file that is touched while the process runs, and removed at a regular end; None: no file
    environment  NOTIFY_SOCKET and WATCHDOG_USEC, as set by systemd; without them there are no notifications
    tell         hears each sign instead of systemd: the parent of a worker, once a second
    """

    def __init__(
        self, alive: Path | None = None, environment: Mapping[str, str] = os.environ,
        tell: Callable[[str], None] | None = None,
    ) -> None:  # fmt: skip
        self._alive, self._tell = alive, tell
        self._address = environment.get("NOTIFY_SOCKET", "")
        self.every_s = _every_s(environment, alive) if tell is None else _TELL_EVERY_S
        self._last = 0.0

    def ready(self) -> None:
        """Announce that lines are read from now on. InputError if the file cannot be written."""
        self._touch()
        self._notify("READY=1")

    def living(self) -> None:
        """Give a sign of life if one is due; called after each turn."""
        now = time.monotonic()
        if self.every_s is not None and now >= self._last + self.every_s:
            self._last = now
            self._notify("WATCHDOG=1")
            self._touch()

    def wait_s(self) -> float | None:
        """Return the time until the next sign of life; None if none is wanted."""
        return None if self.every_s is None else max(0.0, self._last + self.every_s - time.monotonic())

    def ending(self) -> None:
        """Announce that no more lines are read."""
        self._notify("STOPPING=1")
        if self._alive is not None:
            self._alive.unlink(missing_ok=True)

    def _touch(self) -> None:
        if self._alive is None:
            return
        try:
            self._alive.touch()
        except OSError as error:
            raise InputError(f"{self._alive}: cannot be written: {error.strerror}.") from error

    def _notify(self, text: str) -> None:
        if self._tell is not None:
            self._tell(text)
            return
        if not self._address.startswith(("/", "@")):
            return
        where = f"\0{self._address[1:]}" if self._address.startswith("@") else self._address
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sock:
                sock.setblocking(False)
                sock.sendto(text.encode(), where)
        except OSError:
            pass  # the supervisor notices the missing sign; nobody else can be notified


def _every_s(environment: Mapping[str, str], alive: Path | None) -> float | None:
    """Return the seconds between two signs: a third of systemd's limit, at most that of the file; None if none is wanted."""
    limit = environment.get("WATCHDOG_USEC", "")
    mine = environment.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
    allowed = int(limit) / 3_000_000 if limit.isascii() and limit.isdecimal() and mine and int(limit) > 0 else None
    wanted = [one for one in (allowed, _FILE_EVERY_S if alive is not None else None) if one is not None]
    return min(wanted, default=None)
