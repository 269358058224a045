"""The process: one loop that reads lines, steps the vehicles, saves snapshots, and delivers reports.

A report that withdraws a place leaves only after the withdrawal is on disk: a process that is killed and started
again can then never report a place that it had withdrawn, unless a reference brought it back. Where the lines can be
read again (a file, without watchdog) that is not needed: the same lines withdraw it again.

After an unexpected exception nothing is saved: the memory is not trusted, and the next process resumes from the last
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
from safeloc.runtime.service.kept import KeptProcess, kept_as
from safeloc.runtime.service.outlets import Outlet
from safeloc.runtime.service.replies import Allowance
from safeloc.runtime.service.saving import Saver
from safeloc.runtime.service.supervised import Supervised
from safeloc.runtime.service.vehicle import Told
from safeloc.runtime.service.watchdog import Watchdog

TURN_S = 0.000_2
"""How long the thread that writes snapshots may keep the interpreter before the loop has its turn."""

STOPPING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)

LAST_TURN_S = 1.0
"""How long the turn may take in which the process is told to stop; what is left of it then is not heard."""

LAST_WORDS_S = 5.0
"""How long a reader may take for what waits for it when the process ends."""


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
    """Runs until the feed ends or a signal stops it."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._over = False
        self._stop, self._stop_by = "", float("inf")
        self._failed = False
        self._saved_at = time.monotonic()
        self._changed = False
        self._replays = parts.feed.replays and parts.watchdog is None
        gap_s = parts.fleet.ways.longest_gap_ms / 1_000
        self._clock = parts.watchdog or Watchdog(gap_s, gap_s)
        self._allowance = Allowance() if isinstance(parts.outlet, Feed) else None
        parts.fleet.on_failure = self._vehicle_failed

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go on from a snapshot; InputError where it does not fit."""
        parts, kept = self._parts, kept_as(KeptProcess, saved)
        require_same("way of reading lines", "steps" if parts.fleet.ways.inputs else "records", kept.lines)
        unsure = parts.feed.go_on(kept.feed)
        parts.fleet.restore(kept.vehicles, unsure)
        parts.outlet.trim(kept.outlet, self._replays and not unsure)
        for name in parts.fleet.vehicles:
            self._clock.ended(name, time.monotonic())
        parts.journal.info("resumed", vehicles=len(kept.vehicles), unsure=unsure)

    def run(self) -> None:
        """Until there is no more. Errors come out after what waits was saved and handed over, as far as possible."""
        parts = self._parts
        parts.feed.open(parts.selector)
        if parts.saver is not None:
            parts.fleet.make_ready_to_save()
        gc.collect()
        gc.freeze()  # machines are large and stay: looking through them again and again would hold reports up
        sys.setswitchinterval(TURN_S)
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
            raise  # planned: what is in memory is as it should be
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
            self._heed(key.data(mask))
            if not self._must_save:
                parts.outlet.flush()  # no peer waits for what the next ones say
        self._heed(parts.feed.look())
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

    def _heed(self, events: Iterator[Event]) -> None:
        fleet, whole = self._parts.fleet, self._parts.feed.whole
        for event in events:
            match event:
                case Arrived(origin, line, vehicle):
                    self._changed = True
                    if self._allowance is not None:
                        self._allowance.said(origin, len(line.text))
                    self._tell(fleet.heed(origin, line, whole=whole, only=vehicle), origin)
                case Left(origin, why):
                    fleet.gone(origin, why)
                    if self._allowance is not None:
                        self._allowance.left(origin)
                case Over():
                    self._over = True
            if time.monotonic() > self._stop_by:
                return  # lines that were read and not heard are charged as any that came while nobody listened

    def _watch(self) -> None:
        """Vehicles that are silent: with a watchdog their cycles are ended, without one their places are withdrawn."""
        parts, clock, now = self._parts, self._clock, time.monotonic()
        if not parts.feed.live or parts.outlet.full:
            clock.pass_over(now)
            return
        for name in clock.overdue(now):
            if parts.watchdog is not None:
                self._tell(parts.fleet.silence(name, "the watchdog ended the cycle"), "", watched=True)
            else:
                why = f"it ended no cycle for {parts.fleet.ways.longest_gap_ms} ms"
                self._tell(parts.fleet.withdraw(name, why), "", watched=True)
                clock.forget(name)

    def _tell(self, told: list[Told], origin: str, *, watched: bool = False) -> None:
        """To whoever speaks for the vehicle, or else to who sent the line."""
        parts = self._parts
        for one in told:
            vehicle = one.get("vehicle", "")
            self._put(parts.fleet.origins.get(vehicle, origin), one)
            event = one.get("event")
            if event is not None:
                parts.journal.warning(**one)
            if event in ("halted", "forgotten"):
                self._clock.forget(vehicle)
            elif "mode" in one and not watched:
                self._clock.ended(vehicle, time.monotonic())

    def _put(self, origin: str, one: Told) -> None:
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
        """All there is to remember, as of now."""
        parts = self._parts
        vehicles, feed, outlet = parts.fleet.freeze(), parts.feed.position(), parts.outlet.position()
        lines = "steps" if parts.fleet.ways.inputs else "records"

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
        """SIGTERM, SIGINT and SIGHUP end the loop after its turn; a pipe wakes it. One that is ignored (nohup) stays so."""
        reading, writing = os.pipe()
        os.set_blocking(reading, False)
        os.set_blocking(writing, False)
        self._parts.selector.register(reading, selectors.EVENT_READ, lambda _mask: self._woken(reading))
        heeded = [number for number in STOPPING if signal.getsignal(number) is not signal.SIG_IGN]
        before = {number: signal.signal(number, self._told_to_stop) for number in heeded}
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

    def _told_to_stop(self, number: int, _frame: object) -> None:
        self._stop = signal.Signals(number).name
        self._stop_by = min(self._stop_by, time.monotonic() + LAST_TURN_S)

    def _woken(self, reading: int) -> Iterator[Event]:
        os.read(reading, 1_024)
        yield from ()

    def _end(self) -> None:
        """Deliver the waiting reports, then save, so that reports and snapshot agree."""
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
        until = time.monotonic() + LAST_WORDS_S
        self._hand_over()
        while parts.outlet.waiting and time.monotonic() < until:
            time.sleep(0.005)
            parts.outlet.flush()
        if parts.outlet.waiting:
            parts.journal.warning("unsent", why=f"not read within {LAST_WORDS_S} s")


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
