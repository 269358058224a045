"""A station: one feed with its vehicles, its outlet and its snapshots, and what is done with them in each turn of the loop.

A report that withdraws a position is delivered only after a snapshot with the withdrawal is on disk. So a process that is
killed and restarted can never report a withdrawn position, unless a new reference has been accepted. If the lines can be
read again (a file, without watchdog) this is not needed: the same lines withdraw the position again.
"""

from __future__ import annotations

import selectors
import time
import traceback
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safeloc.runtime.embedding.snapshot import require_same
from safeloc.runtime.service.feeds import Arrived, Event, Feed, Left, Over, Told
from safeloc.runtime.service.fleet import Fleet
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.outlets import Outlet
from safeloc.runtime.service.replies import Allowance
from safeloc.runtime.service.saved_fields import SavedProcess, checked_fields
from safeloc.runtime.service.saving import Saver, next_turn
from safeloc.runtime.service.tracing import Tracer
from safeloc.runtime.service.vehicle import Output
from safeloc.runtime.service.watchdog import Watchdog

_WRITTEN_S = 0.02
"""Seconds until it is looked again whether a snapshot is written."""

_LAST_WORDS_S = 5.0
"""Most seconds that the process waits at its end for readers to take their reports."""


class Work(ABC):
    """The work of a loop: one station, or several that come and go.

    stop_by   time of the monotonic clock after which lines are no longer handled; they count as lost
    over      there is no more to read
    gather_s  least time from the beginning of a turn to that of the next, so that what comes meanwhile is handled at once;
              the loop makes it up to four times as long when it has much to do
    """

    stop_by = float("inf")
    over = False
    gather_s = 0.0

    @property
    @abstractmethod
    def machine(self) -> str:
        """The machine's name."""

    @abstractmethod
    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin to read; InputError if that is impossible."""

    @abstractmethod
    def take(self, events: Iterator[Event]) -> None:
        """Handle what the selector reported for one file descriptor."""

    @abstractmethod
    def turn(self) -> None:
        """Do what is to be done after the selector's events: look, watch, hand over, save."""

    @abstractmethod
    def patience_s(self) -> float | None:
        """Return the time until the next turn if the selector reports nothing; None: any time."""

    @abstractmethod
    def finish(self) -> None:
        """Handle the end of all lines."""

    @abstractmethod
    def end(self, *, failed: bool) -> None:
        """Deliver the waiting reports, then save a snapshot, so that both agree; neither after a failure."""

    @abstractmethod
    def sums(self) -> Mapping[str, int]:
        """Return the counts since the start, for the log."""

    @abstractmethod
    def gauges(self) -> Mapping[str, int]:
        """Return what there is of each kind now, for metrics."""


@dataclass(frozen=True)
class Parts:
    """The components of a station; saver, watchdog and tracer are optional.

    Without a watchdog, the position of a vehicle that ends no cycle for the longest gap is withdrawn.
    """

    feed: Feed
    outlet: Outlet
    fleet: Fleet
    journal: Journal
    saver: Saver | None = None
    save_every_s: float = 1.0
    watchdog: Watchdog | None = None
    tracer: Tracer | None = None


class Station(Work):
    """One feed with its vehicles, its outlet and its snapshots."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._save_at = self._next_save()
        self._changed = False
        self._marks: deque[tuple[int, int]] = deque()
        self._replays = parts.feed.replays and parts.watchdog is None
        gap_s = parts.fleet.settings.longest_gap_ms / 1_000
        self._clock = parts.watchdog or Watchdog(gap_s, gap_s)
        self._allowance = Allowance() if isinstance(parts.outlet, Feed) else None
        parts.fleet.on_failure = self._vehicle_failed
        if parts.tracer is not None:
            parts.fleet.on_line = parts.tracer.line

    @property
    def machine(self) -> str:
        """The machine's name."""
        return self._parts.fleet.name

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

    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin to read; InputError if that is impossible."""
        self._parts.feed.open(selector)
        if self._parts.saver is not None:
            self._parts.fleet.make_ready_to_save()

    def sums(self) -> Mapping[str, int]:
        """Return the counts since the start, for the log."""
        fleet = self._parts.fleet
        repeated = {} if self._parts.feed.repeated is None else {"repeated": self._parts.feed.repeated}
        return {"wrong": fleet.wrong, **vars(fleet.tally), **repeated}

    def gauges(self) -> Mapping[str, int]:
        """Return what there is of each kind now, for metrics."""
        return {"vehicles": len(self._parts.fleet.vehicles), "localized": self._parts.fleet.localized}

    # ------------------------------------------------------------------ one turn

    def take(self, events: Iterator[Event]) -> None:
        """Handle what the selector reported, and deliver its reports, so that no peer waits for lines of the next ones."""
        self._handle(events)
        if not self._must_save:
            self._parts.outlet.flush()

    def turn(self) -> None:
        """Look for what the selector does not report, watch for silence, hand over, and save in time."""
        parts = self._parts
        self._tell_kept()
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
            self._save_now(parts.saver)
            parts.fleet.withdrew = parts.fleet.by_clock = False
        parts.outlet.flush()

    def patience_s(self) -> float | None:
        """Return the time until the next turn if the selector reports nothing; None: any time."""
        parts = self._parts
        limits = [parts.feed.again_s, self._clock.next_s(time.monotonic())]
        if parts.saver is not None and self._changed:
            limits.append(max(0.0, self._save_at - time.monotonic()))
        if self._marks:
            limits.append(_WRITTEN_S)
        return min((limit for limit in limits if limit is not None), default=None)

    def _handle(self, events: Iterator[Event]) -> None:
        fleet, from_start = self._parts.fleet, self._parts.feed.from_start
        for event in events:
            match event:
                case Arrived():
                    origin, line, vehicle = event
                    self._changed = True
                    if self._allowance is not None:
                        self._allowance.line_came(origin, len(line.text))
                    outputs = fleet.handle(origin, line, from_start=from_start, only=vehicle)
                    if outputs:
                        self._tell(outputs, origin)
                case Left(origin, why):
                    fleet.gone(origin, why)
                    if self._allowance is not None:
                        self._allowance.left(origin)
                case Told(about, payload):
                    self._tell(fleet.told(about, payload), "")
                case Over():
                    self.over = True
            if time.monotonic() > self.stop_by:
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
                if parts.tracer is not None:
                    parts.tracer.reported(vehicle, one["cycle"], one["time_ms"])

    def _put(self, origin: str, one: Output) -> None:
        outlet = self._parts.outlet
        data = outlet.text(one)
        if self._allowance is not None and one.get("event") == "refused":
            allowed = self._allowance.refusal(origin, one, len(data))
            if allowed is None:
                return
            data = data if allowed is one else outlet.text(allowed)
        outlet.put(origin, data, event="event" in one)

    def _vehicle_failed(self, vehicle: str, error: Exception) -> None:
        self._parts.journal.error("vehicle failed", vehicle=vehicle, trace=trace(error))

    # ------------------------------------------------------------------ snapshots

    def _content(self) -> Callable[[], Mapping[str, Any]]:
        """Return a function that returns the content of a snapshot as of now."""
        parts = self._parts
        vehicles, feed, outlet = parts.fleet.freeze(), parts.feed.position(), parts.outlet.position()
        lines = "steps" if parts.fleet.settings.inputs else "records"

        def content() -> Mapping[str, Any]:
            parts.outlet.sync()
            return {"lines": lines, "feed": feed, "outlet": outlet, "vehicles": vehicles()}

        self._changed, self._save_at = False, self._next_save()
        return content

    def _next_save(self) -> float:
        return next_turn(time.monotonic(), self._parts.save_every_s, self._parts.feed.save_turn)

    def _save_in_time(self) -> None:
        saver = self._parts.saver
        if saver is None or not self._changed or time.monotonic() < self._save_at:
            return
        if saver.failed is not None:
            self._parts.journal.error("not saved", why=str(saver.failed))
        if saver.busy or (self._replays and self._parts.outlet.waiting):
            return
        mark = self._parts.feed.mark()
        asked = saver.ask(self._content())
        if mark:
            self._marks.append((asked, mark))

    def _save_now(self, saver: Saver) -> None:
        mark = self._parts.feed.mark()
        saver.save(self._content())
        self._marks.clear()
        self._parts.feed.kept(mark)

    def _tell_kept(self) -> None:
        """Tell the feed what is on disk by now."""
        while self._marks and self._parts.saver is not None and self._marks[0][0] <= self._parts.saver.written:
            self._parts.feed.kept(self._marks.popleft()[1])

    def memory(self) -> Mapping[str, Any]:
        """Return what a snapshot of now would hold, without saving it."""
        return self._content()()

    # ------------------------------------------------------------------ the end

    def finish(self) -> None:
        """Handle the end of all lines."""
        self._tell(self._parts.fleet.finish(), "")

    def end(self, *, failed: bool) -> None:
        """Deliver the waiting reports, then save a snapshot, so that both agree; neither after a failure."""
        parts = self._parts
        try:
            if not failed:
                self._last_words()
        finally:
            try:
                if parts.saver is not None:
                    if not failed:
                        self._save_now(parts.saver)
                    parts.saver.end()
            finally:
                parts.feed.close()
                if not isinstance(parts.outlet, Feed):
                    parts.outlet.close()

    def _last_words(self) -> None:
        parts = self._parts
        until = time.monotonic() + _LAST_WORDS_S
        self._hand_over()
        while parts.outlet.waiting and time.monotonic() < until:
            time.sleep(0.005)
            parts.outlet.flush()
        if parts.outlet.waiting:
            parts.journal.warning("unsent", why=f"not read within {_LAST_WORDS_S} s")


def trace(error: BaseException) -> str:
    """Return the lines of code that led to the error, the innermost first."""
    frames = traceback.extract_tb(error.__traceback__)
    return " < ".join(f"{Path(frame.filename).name}:{frame.lineno} {frame.name}" for frame in reversed(frames))
