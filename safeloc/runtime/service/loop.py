"""The process: a loop that waits for lines, and turns its work until the input ends or a signal stops it.

After an unexpected exception nothing is saved, since the memory is not trusted: the next process resumes from the last
snapshot, as after kill -9.
"""

from __future__ import annotations

import gc
import os
import selectors
import signal
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from safeloc.errors import SafelocError
from safeloc.runtime.service.feeds import Event
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.metrics import Metrics
from safeloc.runtime.service.roomy_stack import in_roomy_stack
from safeloc.runtime.service.station import Work, trace
from safeloc.runtime.service.supervised import Supervised

_TURN_S = 0.000_2
"""Seconds for which the thread that writes snapshots may occupy the interpreter before the loop continues."""

_LONGER = 4
"""How many times as long as `Work.gather_s` a process rests at most, when it has much to do."""

_BUSY_SHARE = 1 / 3
"""Share of the time from turn to turn that may be work; above, the rest becomes longer, since messages in larger bursts cost
less each."""

_STOPPING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)

_LAST_TURN_S = 1.0
"""Most seconds of the turn in which a stop signal arrives; lines that are not handled by then are dropped."""


class Loop:
    """The loop; it runs until its work is over, a signal stops it, or the tie to its parent ends (workers.py)."""

    def __init__(
        self, work: Work, selector: selectors.BaseSelector, journal: Journal, supervised: Supervised | None = None,
        metrics: Metrics | None = None, parent: socket.socket | None = None,
    ) -> None:  # fmt: skip
        self._parent = parent
        self._work, self._selector, self._journal, self._metrics = work, selector, journal, metrics
        self._supervised = supervised or Supervised(None, {})
        self._stop = ""
        self._failed = False
        self._turned_at = self._between_s = 0.0

    def run(self) -> None:
        """Run to the end. An error is raised after waiting reports were delivered and a snapshot was saved, if possible."""
        work = self._work
        work.open(self._selector)
        gc.collect()
        gc.freeze()  # machines are large and permanent: scanning them repeatedly would delay reports
        sys.setswitchinterval(_TURN_S)
        try:
            with self._signals():
                self._journal.info("started", pid=os.getpid(), machine=work.machine)
                self._supervised.ready()
                in_roomy_stack(self._turns)
                if work.over:
                    work.finish()
        except (SafelocError, BrokenPipeError):
            raise  # an expected error: the memory is correct
        except BaseException as error:
            self._failed = True
            self._journal.error("failed", why=f"{type(error).__name__}: {error}", trace=trace(error))
            raise
        finally:
            self._end()

    def _turns(self) -> None:
        while not self._work.over and not self._stop:
            self._once()
            self._supervised.living()

    def _once(self) -> None:
        ready = self._selector.select(self._patience_s())
        if ready and (rest_s := self._turned_at + self._between_s - time.monotonic()) > 0.0:
            time.sleep(rest_s)
            ready = self._selector.select(0.0)
        self._turned_at = time.monotonic()
        for key, mask in ready:
            self._work.take(key.data(mask))
        self._work.turn()
        worked_s, gather_s = time.monotonic() - self._turned_at, self._work.gather_s
        self._between_s = max(gather_s, min(worked_s / _BUSY_SHARE, _LONGER * gather_s))
        if self._metrics is not None and self._metrics.due():
            self._metrics.note({**self._work.sums(), **self._work.gauges()})

    def _patience_s(self) -> float | None:
        limits = (self._work.patience_s(), self._supervised.wait_s())
        return min((limit for limit in limits if limit is not None), default=None)

    # ------------------------------------------------------------------ beginning and end

    @contextmanager
    def _signals(self) -> Iterator[None]:
        """Let SIGTERM, SIGINT and SIGHUP end the loop after its turn; a pipe wakes it. An ignored signal stays ignored."""
        reading, writing = os.pipe()
        os.set_blocking(reading, False)
        os.set_blocking(writing, False)
        self._selector.register(reading, selectors.EVENT_READ, lambda _mask: self._woken(reading))
        if self._parent is not None:
            self._selector.register(self._parent, selectors.EVENT_READ, lambda _mask: self._parent_ended())
        handled = [number for number in _STOPPING if signal.getsignal(number) is not signal.SIG_IGN]
        before = {number: signal.signal(number, self._request_stop) for number in handled}
        wakeup = signal.set_wakeup_fd(writing)
        try:
            yield
        finally:
            signal.set_wakeup_fd(wakeup)
            for number, handler in before.items():
                signal.signal(number, handler)
            self._selector.unregister(reading)
            if self._parent is not None:
                self._selector.unregister(self._parent)
            os.close(reading)
            os.close(writing)

    def _request_stop(self, number: int, _frame: object) -> None:
        self._stop_now(signal.Signals(number).name)

    def _parent_ended(self) -> Iterator[Event]:
        """Stop: a parent says nothing over the tie, so what can be read is its end."""
        self._stop_now("the parent ends")
        yield from ()

    def _stop_now(self, why: str) -> None:
        self._stop = self._stop or why
        self._work.stop_by = min(self._work.stop_by, time.monotonic() + _LAST_TURN_S)

    def _woken(self, reading: int) -> Iterator[Event]:
        os.read(reading, 1_024)
        yield from ()

    def _end(self) -> None:
        self._supervised.ending()
        try:
            self._work.end(failed=self._failed)
        finally:
            why = "failed" if self._failed else self._stop or "no more to read"
            self._journal.info("stopped", why=why, **self._work.sums())
            if self._metrics is not None:
                self._metrics.close()


def exit_code(work: Work) -> int:
    """Return the exit code of a run: 0, 1 if a reported interval did not contain the true position, 3 if no cycle was
    completed."""
    sums = work.sums()
    if sums["wrong"]:
        return 1
    return 0 if sums["cycles"] else 3
