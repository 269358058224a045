"""Workers: one process prepares the machine, forks as many others as are asked for, and starts each again that ends.

The parent has no thread, no socket and no client of a broker when it forks; a worker makes its own. A socket pair ties each
worker to its parent. Over it the worker gives signs of life, and its end tells the worker to end in order: so does a parent
that was killed, and no worker outlives it.
"""

from __future__ import annotations

import gc
import os
import secrets
import selectors
import signal
import socket
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field

from safeloc.errors import InputError, SafelocError
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.supervised import Supervised

_STOPPING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
_LEFT_TO_THE_PARENT = (signal.SIGINT, signal.SIGHUP)
"""Signals that a terminal sends to workers as well; their parent passes them on, once."""

_STEADY_S = 30.0
"""A worker that lived for so long has not failed at its start, whatever ended it."""

_MOST_SHORT_LIVES = 5
"""Short lives in a row of one worker after which all end: starting it again would only hide the fault."""

_AGAIN_S = 0.5
"""Seconds before a worker starts again after its second short life; twice as many after each further one."""

_SILENT_S = 10.0
"""Seconds without a sign of life after which a worker counts as hanging, and is killed."""

_END_S = 12.0
"""Most seconds for the regular end of all workers; those that are left are killed."""

_LOOK_S = 1.0
"""Most seconds between two looks for workers that hang."""


@dataclass(frozen=True)
class Link:
    """A worker's tie to its parent. `number` counts the workers from 0; who follows a worker that ended has its number and name."""

    number: int
    name: str
    sock: socket.socket

    def tell(self, text: str) -> None:
        """Give a sign of life."""
        with suppress(OSError):  # the parent has ended the tie, or is gone; the loop sees the latter
            self.sock.send(text.encode()[:1])


@dataclass
class _Slot:
    """The place of one worker; without one, pid is 0 and it starts at `due`."""

    number: int
    pid: int = 0
    sock: socket.socket | None = None
    began: float = 0.0
    last_sign_at: float = 0.0
    ready: bool = False
    short_lives: int = 0
    due: float = 0.0
    codes: list[int] = field(default_factory=list)


class Workers:
    """The parent. InputError where the system cannot fork."""

    def __init__(self, count: int, journal: Journal, supervised: Supervised) -> None:
        if not hasattr(os, "fork"):
            raise InputError(
                "--processes needs a system that can fork (Linux, macOS); start the command several times."
            )
        self._name = secrets.token_hex(8)
        self._slots = [_Slot(number) for number in range(count)]
        self._journal, self._supervised = journal, supervised
        self._selector = selectors.SelectSelector()
        self._asked = self._stop = self._failure = ""
        self._kill_at = float("inf")
        self._is_ready = False

    def run(self) -> Link | int:
        """Return in each worker its tie to the parent, and in the parent, when all have ended, the exit code.

        SafelocError if a worker failed again and again.
        """
        if threading.active_count() > 1:
            raise RuntimeError("a thread runs already; a worker would not have it, but would have its locks")
        gc.collect()
        gc.freeze()  # so that no worker writes to the pages of the machine, which all share
        with self._signals():
            link = self._until_the_end()
        if link is not None:
            for number in _LEFT_TO_THE_PARENT:
                signal.signal(number, signal.SIG_IGN)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPPING)
            return link
        if self._failure:
            raise SafelocError(self._failure)
        return self._exit_code()

    def _until_the_end(self) -> Link | None:
        while True:
            now = time.monotonic()
            if self._asked:
                self._end(self._asked)
            for slot in self._slots:
                self._see(slot, now)
            if self._stop and not any(slot.pid for slot in self._slots):
                return None
            for slot in self._slots:
                if not self._stop and not slot.pid and now >= slot.due:
                    link = self._start(slot)
                    if link is not None:
                        return link
            self._give_signs()
            for key, _ in self._selector.select(self._patience_s()):
                self._hear(key.data, key.fd)

    # ------------------------------------------------------------------ one worker

    def _start(self, slot: _Slot) -> Link | None:
        """Fork; return the tie in the worker. Signals wait until each of the two handles its own."""
        mine, theirs = socket.socketpair()
        sys.stdout.flush()
        sys.stderr.flush()
        signal.pthread_sigmask(signal.SIG_BLOCK, _STOPPING)
        pid = os.fork()
        if pid == 0:
            for sock in (mine, *(one.sock for one in self._slots)):
                if sock is not None:
                    sock.close()
            self._selector.close()
            theirs.setblocking(False)
            return Link(slot.number, f"{self._name}-{slot.number}", theirs)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPPING)
        theirs.close()
        mine.setblocking(False)
        slot.pid, slot.sock, slot.began, slot.ready = pid, mine, time.monotonic(), False
        slot.last_sign_at = slot.began
        self._selector.register(mine, selectors.EVENT_READ, slot)
        self._journal.info("worker started", worker=slot.number, pid=pid)
        return None

    def _see(self, slot: _Slot, now: float) -> None:
        """Look whether the worker has ended, or hangs."""
        if not slot.pid:
            return
        pid, status = os.waitpid(slot.pid, os.WNOHANG)
        if pid:
            self._ended(slot, os.waitstatus_to_exitcode(status), now)
        elif now > min(self._kill_at, slot.last_sign_at + _SILENT_S):
            self._journal.error(
                "worker killed", worker=slot.number, pid=slot.pid, why="it gives no sign, or does not end"
            )
            slot.last_sign_at = now
            os.kill(slot.pid, signal.SIGKILL)

    def _ended(self, slot: _Slot, code: int, now: float) -> None:
        """Note the end of a worker: by its exit code, or by a signal (negative)."""
        pid, slot.pid = slot.pid, 0
        self._cut(slot)
        slot.codes.append(code)
        if self._stop:
            self._journal.info("worker ended", worker=slot.number, pid=pid, code=code)
            return
        slot.short_lives = slot.short_lives + 1 if now < slot.began + _STEADY_S else 0
        slot.due = now + (_AGAIN_S * 2 ** (slot.short_lives - 2) if slot.short_lives > 1 else 0.0)
        self._journal.warning(
            "worker ended", worker=slot.number, pid=pid, code=code, again_s=round(slot.due - now, 1),
            short_lives=slot.short_lives,
        )  # fmt: skip
        if slot.short_lives >= _MOST_SHORT_LIVES:
            self._failure = (
                f"worker {slot.number} ended {_MOST_SHORT_LIVES} times in a row within {_STEADY_S:g} s of its start, the last "
                f"time with {f'signal {-code}' if code < 0 else f'exit code {code}'}; the log says why."
            )
            self._end("failed")

    def _cut(self, slot: _Slot) -> None:
        if slot.sock is not None:
            self._selector.unregister(slot.sock)
            slot.sock.close()
            slot.sock = None

    def _hear(self, slot: _Slot | None, fd: int) -> None:
        """Take in signs of life, or the signals that woke the loop (no slot)."""
        if slot is None:
            os.read(fd, 4_096)
            return
        if slot.sock is None:
            return
        try:
            signs = slot.sock.recv(4_096)
        except OSError:
            signs = b""
        if signs:
            slot.last_sign_at, slot.ready = time.monotonic(), True
        else:
            self._cut(slot)  # it ends

    # ------------------------------------------------------------------ all of them

    def _give_signs(self) -> None:
        if not self._is_ready and all(slot.ready for slot in self._slots):
            self._is_ready = True
            self._supervised.ready()
        if self._is_ready and not self._stop:
            self._supervised.living()

    def _patience_s(self) -> float:
        now = time.monotonic()
        limits = [_LOOK_S, self._supervised.wait_s(), *(slot.due - now for slot in self._slots if not slot.pid)]
        return max(0.0, min(limit for limit in limits if limit is not None)) if not self._stop else 0.05

    def _end(self, why: str) -> None:
        """Let every worker end in order: each sees that its tie ends."""
        if self._stop:
            return
        self._stop, self._kill_at = why, time.monotonic() + _END_S
        self._supervised.ending()
        self._journal.info("stopping", why=why)
        for slot in self._slots:
            if slot.sock is not None:
                with suppress(OSError):  # it has ended
                    slot.sock.shutdown(socket.SHUT_WR)

    def _exit_code(self) -> int:
        """Return 1 if a worker reported a wrong interval; 2 if one did not end in order; 0 if any completed a cycle, else 3."""
        codes = {code for slot in self._slots for code in slot.codes}
        last = {slot.codes[-1] for slot in self._slots if slot.codes}
        return 1 if 1 in codes else 2 if last - {0, 3} else 0 if 0 in codes else 3

    @contextmanager
    def _signals(self) -> Iterator[None]:
        """Let signals that stop, and ends of workers, wake the loop; restore what was before, in a worker too."""
        reading, writing = os.pipe()
        os.set_blocking(reading, False)
        os.set_blocking(writing, False)
        self._selector.register(reading, selectors.EVENT_READ, None)
        handled = [number for number in _STOPPING if signal.getsignal(number) is not signal.SIG_IGN]
        before = {number: signal.signal(number, self._signalled) for number in (*handled, signal.SIGCHLD)}
        wakeup = signal.set_wakeup_fd(writing)
        try:
            yield
        finally:
            signal.set_wakeup_fd(wakeup)
            for number, handler in before.items():
                signal.signal(number, handler)
            os.close(reading)
            os.close(writing)

    def _signalled(self, number: int, _frame: object) -> None:
        if number != signal.SIGCHLD:
            self._asked = self._asked or signal.Signals(number).name
