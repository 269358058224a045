"""Signs of life for who supervises the process: systemd (sd_notify), and a file that a health check looks at.

A sign is given by the loop itself, between two turns: a process that hangs gives none.
"""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Mapping
from pathlib import Path

from safeloc.errors import InputError

FILE_EVERY_S = 1.0
"""How often the file is touched."""


class Supervised:
    """alive      a file that is touched while the process runs, and taken away when it ends in order; None: no file

    environment  NOTIFY_SOCKET and WATCHDOG_USEC as systemd sets them; without them nobody is notified
    """

    def __init__(self, alive: Path | None = None, environment: Mapping[str, str] = os.environ) -> None:
        self._alive = alive
        self._address = environment.get("NOTIFY_SOCKET", "")
        self.every_s = _every_s(environment, alive)
        self._told = 0.0

    def ready(self) -> None:
        """Announce that lines are read from now on. InputError if the file cannot be written."""
        self._touch()
        self._notify("READY=1")

    def living(self) -> None:
        """Record the end of a turn."""
        now = time.monotonic()
        if self.every_s is not None and now >= self._told + self.every_s:
            self._told = now
            self._notify("WATCHDOG=1")
            self._touch()

    def wait_s(self) -> float | None:
        """Return the time until the next sign of life; None if nobody waits for one."""
        return None if self.every_s is None else max(0.0, self._told + self.every_s - time.monotonic())

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
        if not self._address.startswith(("/", "@")):
            return
        where = f"\0{self._address[1:]}" if self._address.startswith("@") else self._address
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sock:
                sock.setblocking(False)
                sock.sendto(text.encode(), where)
        except OSError:
            pass  # who supervises sees that no sign came; there is nobody else to tell


def _every_s(environment: Mapping[str, str], alive: Path | None) -> float | None:
    """Three signs in the time that is allowed; None where none is asked for."""
    told = environment.get("WATCHDOG_USEC", "")
    mine = environment.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
    allowed = int(told) / 3_000_000 if told.isascii() and told.isdecimal() and mine and int(told) > 0 else None
    wanted = [one for one in (allowed, FILE_EVERY_S if alive is not None else None) if one is not None]
    return min(wanted, default=None)
