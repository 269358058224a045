"""The process: a loop that reads lines, steps the vehicles, saves snapshots and delivers reports.

A report that withdraws a position is delivered only after a snapshot with the withdrawal is on disk. So a process that is
killed and restarted can never report a withdrawn position, unless a new reference has been accepted. If the lines can be
read again (a file, without watchdog) this is not needed: the same lines withdraw the position again.

After an unexpected exception nothing is saved, since the memory is not trusted: the next process resumes from the last
snapshot, as after kill -9.
"""

from __future__ import annotations

import gc
import json
import os
import selectors
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from safeloc.errors import SafelocError
from safeloc.runtime.embedding.snapshot import require_same
from safeloc.runtime.service.feeds import Arrived, Event, Feed, Left, Over
from safeloc.runtime.service.fleet import Fleet
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.outlets import Outlet
from safeloc.runtime.service.replies import Allowance
from safeloc.runtime.service.saved_fields import SavedProcess, checked_fields
from safeloc.runtime.service.saving import Saver
from safeloc.runtime.service.supervised import Supervised
from safeloc.runtime.service.vehicle import Output
from safeloc.runtime.service.watchdog import Watchdog

_TURN_S = 0.000_2
"""Seconds for which the thread that writes snapshots may occupy the interpreter before the loop continues."""

_STOPPING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)

_LAST_TURN_S = 1.0
"""Most seconds of the turn in which a stop signal arrives; lines that are not handled by then are dropped."""

_LAST_WORDS_S = 5.0
"""Most seconds that the process waits at its end for readers to take their reports."""


@dataclass(frozen=True)
class Parts:
    """The components of the loop; saver and watchdog are optional.

    Without a watchdog, the position of a vehicle that ends no cycle for the longest gap is withdrawn.
    """

    selector: selectors.BaseSelector
    feed: Feed
    outlet: Outlet
    fleet: Fleet
    journal: Journal
    saver: Saver | None = None
    save_every_s: float = 1.0
    watchdog: Watchdog | None = None
    supervised: Supervised = field(default_factory=lambda: Supervised(None, {}))


class Loop:
    """The loop; it runs until the feed ends or a signal stops it."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._over = False
        self._stop, self._stop_by = "", float("inf")
        self._failed = False
        self._saved_at = time.monotonic()
        self._changed = False
        self._replays = parts.feed.replays and parts.watchdog is None
        gap_s = parts.fleet.settings.longest_gap_ms / 1_000
        self._clock = parts.watchdog or Watchdog(gap_s, gap_s)
        self._allowance = Allowance() if isinstance(parts.outlet, Feed) else None
        parts.fleet.on_failure = self._vehicle_failed

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Continue from a snapshot; InputError if it does not fit."""
        parts, content = self._parts, checked_fields(SavedProcess, saved)
        require_same("way of reading lines", "steps" if parts.fleet.settings.inputs else "records", content.lines)
        unsure = parts.feed.resume(content.feed)
        parts.fleet.restore(content.vehicles, unsure)
        parts.outlet.trim(content.outlet, self._replays and not unsure)
        for name in parts.fleet.vehicles:
            self._clock.ended(name, time.monotonic())
        parts.journal.info("resumed", vehicles=len(content.vehicles), unsure=unsure)

    def run(self) -> None:
        """Run to the end. An error is raised after waiting reports were delivered and a snapshot was saved, if possible."""
        parts = self._parts
        parts.feed.open(parts.selector)
        if parts.saver is not None:
            parts.fleet.make_ready_to_save()
        gc.collect()
        gc.freeze()  # machines are large and permanent: scanning them repeatedly would delay reports
        sys.setswitchinterval(_TURN_S)
        try:
            with self._signals():
                parts.journal.info("started", pid=os.getpid(), machine=parts.fleet.name)
                parts.supervised.ready()
                while not self._over and not self._stop:
                    self._once()
                    parts.supervised.living()
                if self._over:
                    self._tell(parts.fleet.finish(), "")
        except (SafelocError, BrokenPipeError):
            raise  # an expected error: the memory is correct
        except BaseException as error:
            self._failed = True
            parts.journal.error("failed", why=f"{type(error).__name__}: {error}", trace=_trace(error))
            raise
        finally:
            self._end()

    # ------------------------------------------------------------------ one turn

    def _once(self) -> None:
        parts = self._parts
        for key, mask in parts.selector.select(self._patience_s()):
            self._handle(key.data(mask))
            if not self._must_save:
                parts.outlet.flush()  # so that no peer waits for lines of the next ones
        self._handle(parts.feed.look())
        self._watch()
        self._hand_over()
        parts.feed.hold(parts.outlet.full)
        self._save_in_time()

    @property
    def _must_save(self) -> bool:
        """Return whether a waiting report withdraws a position that the snapshot on disk still has, and no line repeats
        it."""
        fleet = self._parts.fleet
        return self._parts.saver is not None and (fleet.by_clock or (fleet.withdrew and not self._replays))

    def _hand_over(self) -> None:
        parts = self._parts
        if parts.saver is not None and self._must_save:
            parts.saver.save(self._content())
            parts.fleet.withdrew = parts.fleet.by_clock = False
        parts.outlet.flush()

    def _patience_s(self) -> float | None:
        parts = self._parts
        limits = [parts.feed.again_s, self._clock.next_s(time.monotonic()), parts.supervised.wait_s()]
        if parts.saver is not None and self._changed:
            limits.append(max(0.0, self._saved_at + parts.save_every_s - time.monotonic()))
        return min((limit for limit in limits if limit is not None), default=None)

    def _handle(self, events: Iterator[Event]) -> None:
        fleet, from_start = self._parts.fleet, self._parts.feed.from_start
        for event in events:
            match event:
                case Arrived(origin, line, vehicle):
                    self._changed = True
                    if self._allowance is not None:
                        self._allowance.line_came(origin, len(line.text))
                    self._tell(fleet.handle(origin, line, from_start=from_start, only=vehicle), origin)
                case Left(origin, why):
                    fleet.gone(origin, why)
                    if self._allowance is not None:
                        self._allowance.left(origin)
                case Over():
                    self._over = True
            if time.monotonic() > self._stop_by:
                return  # the lines that are left count as lost, like those sent while the process is not running

    def _watch(self) -> None:
        """End the cycles of silent vehicles if there is a watchdog, else withdraw their positions."""
        parts, clock, now = self._parts, self._clock, time.monotonic()
        if not parts.feed.live or parts.outlet.full:
            clock.pass_over(now)
            return
        for name in clock.overdue(now):
            if parts.watchdog is not None:
                self._tell(parts.fleet.silence(name, "the watchdog ended the cycle"), "", watched=True)
            else:
                why = f"it ended no cycle for {parts.fleet.settings.longest_gap_ms} ms"
                self._tell(parts.fleet.withdraw(name, why), "", watched=True)
                clock.forget(name)

    def _tell(self, outputs: list[Output], origin: str, *, watched: bool = False) -> None:
        """Send outputs to the peer of the vehicle, or else to the sender of the line.

        watched   the watchdog caused them, and no line
        """
        parts = self._parts
        for one in outputs:
            vehicle = one.get("vehicle", "")
            self._put(parts.fleet.origins.get(vehicle, origin), one)
            event = one.get("event")
            if event is not None:
                parts.journal.warning(**one)
            if event in ("halted", "forgotten"):
                self._clock.forget(vehicle)
            elif "mode" in one and not watched:
                self._clock.ended(vehicle, time.monotonic())

    def _put(self, origin: str, one: Output) -> None:
        data = json.dumps(one).encode() + b"\n"
        if self._allowance is not None and one.get("event") == "refused":
            allowed = self._allowance.refusal(origin, one, len(data))
            if allowed is None:
                return
            data = data if allowed is one else json.dumps(allowed).encode() + b"\n"
        self._parts.outlet.put(origin, data)

    def _vehicle_failed(self, vehicle: str, error: Exception) -> None:
        self._parts.journal.error("vehicle failed", vehicle=vehicle, trace=_trace(error))

    # ------------------------------------------------------------------ snapshots

    def _content(self) -> Callable[[], Mapping[str, Any]]:
        """Return a function that returns the content of a snapshot as of now."""
        parts = self._parts
        vehicles, feed, outlet = parts.fleet.freeze(), parts.feed.position(), parts.outlet.position()
        lines = "steps" if parts.fleet.settings.inputs else "records"

        def content() -> Mapping[str, Any]:
            parts.outlet.sync()
            return {"lines": lines, "feed": feed, "outlet": outlet, "vehicles": vehicles()}

        self._changed, self._saved_at = False, time.monotonic()
        return content

    def _save_in_time(self) -> None:
        saver = self._parts.saver
        if saver is None or not self._changed or time.monotonic() < self._saved_at + self._parts.save_every_s:
            return
        if saver.failed is not None:
            self._parts.journal.error("not saved", why=str(saver.failed))
        if saver.busy or (self._replays and self._parts.outlet.waiting):
            return
        saver.ask(self._content())

    # ------------------------------------------------------------------ beginning and end

    @contextmanager
    def _signals(self) -> Iterator[None]:
        """Let SIGTERM, SIGINT and SIGHUP end the loop after its turn; a pipe wakes it. An ignored signal stays ignored."""
        reading, writing = os.pipe()
        os.set_blocking(reading, False)
        os.set_blocking(writing, False)
        self._parts.selector.register(reading, selectors.EVENT_READ, lambda _mask: self._woken(reading))
        handled = [number for number in _STOPPING if signal.getsignal(number) is not signal.SIG_IGN]
        before = {number: signal.signal(number, self._request_stop) for number in handled}
        wakeup = signal.set_wakeup_fd(writing)
        try:
            yield
        finally:
            signal.set_wakeup_fd(wakeup)
            for number, handler in before.items():
                signal.signal(number, handler)
            self._parts.selector.unregister(reading)
            os.close(reading)
            os.close(writing)

    def _request_stop(self, number: int, _frame: object) -> None:
        self._stop = signal.Signals(number).name
        self._stop_by = min(self._stop_by, time.monotonic() + _LAST_TURN_S)

    def _woken(self, reading: int) -> Iterator[Event]:
        os.read(reading, 1_024)
        yield from ()

    def _end(self) -> None:
        """Deliver the waiting reports, then save a snapshot, so that both agree."""
        parts = self._parts
        parts.supervised.ending()
        try:
            if not self._failed:
                self._last_words()
        finally:
            try:
                if parts.saver is not None:
                    if not self._failed:
                        parts.saver.save(self._content())
                    parts.saver.end()
            finally:
                parts.feed.close()
                if not isinstance(parts.outlet, Feed):
                    parts.outlet.close()
                why = "failed" if self._failed else self._stop or "no more to read"
                parts.journal.info("stopped", why=why, wrong=parts.fleet.wrong, **vars(parts.fleet.tally))

    def _last_words(self) -> None:
        parts = self._parts
        until = time.monotonic() + _LAST_WORDS_S
        self._hand_over()
        while parts.outlet.waiting and time.monotonic() < until:
            time.sleep(0.005)
            parts.outlet.flush()
        if parts.outlet.waiting:
            parts.journal.warning("unsent", why=f"not read within {_LAST_WORDS_S} s")


def _trace(error: BaseException) -> str:
    """Return the lines of code that led to the error, the innermost first."""
    frames = traceback.extract_tb(error.__traceback__)
    return " < ".join(f"{Path(frame.filename).name}:{frame.lineno} {frame.name}" for frame in reversed(frames))


def exit_code(fleet: Fleet) -> int:
    """Return the exit code of a run: 0, 1 if a reported interval did not contain the true position, 3 if no cycle was
    completed."""
    if fleet.wrong:
        return 1
    return 0 if fleet.tally.cycles else 3
