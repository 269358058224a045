"""The process: one loop that reads what came, steps the vehicles, saves what must be saved, and hands reports over.

A report that withdraws a place leaves only after the withdrawal is on disk: a process that is killed and started
again can then never report a place that it had withdrawn, unless a reference brought it back. Where the lines can be
read again (a file, without watchdog) that is not needed: the same lines withdraw it again.
"""

from __future__ import annotations

import gc
import json
import os
import selectors
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from safeloc.embedding.snapshot import require_same
from safeloc.service.feeds import Arrived, Event, Feed, Left, Over
from safeloc.service.fleet import Fleet
from safeloc.service.journal import Journal
from safeloc.service.outlets import Outlet
from safeloc.service.saving import Saver
from safeloc.service.vehicle import Told
from safeloc.service.watchdog import Watchdog

TURN_S = 0.000_2
"""How long the thread that writes snapshots may keep the interpreter before the loop has its turn."""

LAST_WORDS_S = 5.0
"""How long a reader may take for what waits for it when the process ends."""


@dataclass(frozen=True)
class Parts:
    """What the loop is made of; no saver without snapshots, no watchdog unless asked for."""

    selector: selectors.BaseSelector
    feed: Feed
    outlet: Outlet
    fleet: Fleet
    journal: Journal
    saver: Saver | None = None
    save_every_s: float = 1.0
    watchdog: Watchdog | None = None


class Loop:
    """Runs until its feed is over or it is told to stop."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._over = False
        self._stop = ""
        self._saved_at = time.monotonic()
        self._changed = False
        self._replays = parts.feed.replays and parts.watchdog is None

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go on from a snapshot; InputError where it does not fit."""
        parts = self._parts
        require_same("way of reading lines", "steps" if parts.fleet.ways.inputs else "records", saved["lines"])
        unsure = parts.feed.go_on(saved["feed"])
        parts.fleet.restore(saved["vehicles"], unsure)
        parts.outlet.trim(saved["outlet"], self._replays and not unsure)
        if parts.watchdog is not None:
            for name in parts.fleet.vehicles:
                parts.watchdog.ended(name, time.monotonic())
        parts.journal.info("resumed", vehicles=len(saved["vehicles"]), unsure=unsure)

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
                while not self._over and not self._stop:
                    self._once()
                if self._over:
                    self._tell(parts.fleet.finish(), "")
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
        """Whether what waits withdraws a place that the snapshot on disk still has."""
        parts = self._parts
        return parts.fleet.withdrew and parts.saver is not None and not self._replays

    def _hand_over(self) -> None:
        parts = self._parts
        if parts.saver is not None and self._must_save:
            parts.saver.save(self._content())
            parts.fleet.withdrew = False
        parts.outlet.flush()

    def _patience_s(self) -> float | None:
        parts = self._parts
        limits = [parts.feed.again_s]
        if parts.watchdog is not None:
            limits.append(parts.watchdog.next_s(time.monotonic()))
        if parts.saver is not None and self._changed:
            limits.append(max(0.0, self._saved_at + parts.save_every_s - time.monotonic()))
        return min((limit for limit in limits if limit is not None), default=None)

    def _heed(self, events: Iterator[Event]) -> None:
        fleet, whole = self._parts.fleet, self._parts.feed.whole
        for event in events:
            match event:
                case Arrived(origin, line):
                    self._changed = True
                    self._tell(fleet.heed(origin, line, whole=whole), origin)
                case Left(origin, why):
                    fleet.gone(origin, why)
                case Over():
                    self._over = True

    def _watch(self) -> None:
        watchdog = self._parts.watchdog
        if watchdog is not None:
            for name in watchdog.overdue(time.monotonic()):
                self._tell(self._parts.fleet.silence(name, "the watchdog ended the cycle"), "", watched=True)

    def _tell(self, told: list[Told], origin: str, *, watched: bool = False) -> None:
        """To whoever speaks for the vehicle, or else to who sent the line."""
        parts = self._parts
        for one in told:
            vehicle = one.get("vehicle", "")
            parts.outlet.put(parts.fleet.origins.get(vehicle, origin), json.dumps(one).encode() + b"\n")
            if "event" in one:
                parts.journal.warning(**one)
            if parts.watchdog is not None and one.get("event") == "halted":
                parts.watchdog.forget(vehicle)
            elif parts.watchdog is not None and "mode" in one and not watched:
                parts.watchdog.ended(vehicle, time.monotonic())

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
        """SIGTERM and SIGINT end the loop after its turn; a pipe wakes it."""
        reading, writing = os.pipe()
        os.set_blocking(reading, False)
        os.set_blocking(writing, False)
        self._parts.selector.register(reading, selectors.EVENT_READ, lambda _mask: self._woken(reading))
        before = {number: signal.signal(number, self._told_to_stop) for number in (signal.SIGTERM, signal.SIGINT)}
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

    def _woken(self, reading: int) -> Iterator[Event]:
        os.read(reading, 1_024)
        yield from ()

    def _end(self) -> None:
        """What waits is handed over, then saved: nothing that was saved is unsaid, or the other way round."""
        parts = self._parts
        try:
            self._last_words()
        finally:
            try:
                if parts.saver is not None:
                    parts.saver.save(self._content())
                    parts.saver.end()
            finally:
                parts.feed.close()
                if not isinstance(parts.outlet, Feed):
                    parts.outlet.close()
                tally = parts.fleet.tally
                parts.journal.info(
                    "stopped", why=self._stop or "no more to read", wrong=parts.fleet.wrong, **vars(tally)
                )

    def _last_words(self) -> None:
        parts = self._parts
        until = time.monotonic() + LAST_WORDS_S
        self._hand_over()
        while parts.outlet.waiting and time.monotonic() < until:
            time.sleep(0.005)
            parts.outlet.flush()
        if parts.outlet.waiting:
            parts.journal.warning("unsent", why=f"not read within {LAST_WORDS_S} s")


def exit_code(fleet: Fleet) -> int:
    """The exit code of a run: 0, 1 where a report missed the truth beside it, 3 where no cycle ever ended."""
    if fleet.wrong:
        return 1
    return 0 if fleet.tally.cycles else 3
