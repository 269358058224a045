"""One vehicle of the process: turns its lines into cycles of its controller, and accounts for every lost line.

An unreadable line, a gap in the numbers or a disconnected peer means that data may be lost between two received lines. The
cycles in which the two lines fall are discarded; cycles in between count as empty.

An unexpected exception in a machine withdraws the position of this vehicle only: see `fail`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any

from safeloc.errors import InputError
from safeloc.runtime.embedding import Controller, Report
from safeloc.runtime.service.clock_lag import AGREEING_CYCLES, LATEST_MS, OUT_OF_STEP_CYCLES, Pace, Rhythm, Streak
from safeloc.runtime.service.counting import Agreement, LineCount
from safeloc.runtime.service.kept import Kept
from safeloc.runtime.service.messages import Ended, Header, Message, Refused, Said, Step, shortened

Told = dict[str, Any]
MakeController = Callable[[int], Controller]
"""Beginning of its first cycle, in ms -> controller."""


class Vehicle(ABC):
    """Turns lines into reports and events. The two subclasses define the meaning of a line.

    whole      its first line is the first one that was sent; otherwise the cycle of that line may be incomplete
    withdrew   a reported position was withdrawn: set here, cleared by the fleet
    stopped    the reason why the vehicle has stopped; "" while it runs
    """

    def __init__(self, name: str, make: MakeController, pace: Pace, *, whole: bool) -> None:
        self.name, self.withdrew, self.stopped = name, False, ""
        self.wrong = 0
        self.controller: Controller | None = None
        self._make, self._pace = make, pace
        self._count = LineCount(None, "" if whole else "its first lines may be missing")
        self._streak = Streak(pace)
        self._rhythm = Rhythm()
        self._lost = self._lost_until_heard = ""
        self._out: list[Told] = []

    # ------------------------------------------------------------------ for the fleet

    def heed(self, line: int, message: Message) -> list[Told]:
        """Handle one line of this vehicle."""
        match message:
            case Said() | Ended() | Step():
                if self.stopped:
                    self._refuse(line, f"halted: {self.stopped}")
                else:
                    self._counted(line, message)
            case Refused(reason=reason):
                self._refuse(line, reason)
                self._missed(f"line {line}: {reason}")
            case Header():
                pass
        return self._told()

    def missed(self, why: str) -> list[Told]:
        """Something that may have been this vehicle's cannot be read, nor how many lines it was."""
        self._doubt(why)
        return self._told()

    def be_unsure(self, why: str) -> None:
        """Note that lines may have been lost, unless the number of its next line shows that none was."""
        self._count.unsure = self._count.unsure or why

    def silence(self, why: str) -> list[Told]:
        """End the open cycle. Its input may be incomplete, and is not used then."""
        if self.controller is not None and not self.stopped:
            if self._anything_open():
                self._lost = self._lost or why
            self._close()
        return self._told()

    def withdraw(self, why: str) -> list[Told]:
        """Withdraw its position, if it reports one, by a restart."""
        if self.place is not None and not self.stopped:
            self._lost = self._lost or why
            self._anew(why)
        return self._told()

    def fail(self, why: str, line: int | None) -> list[Told]:
        """Handle an unexpected exception: replace the machine, since its state is not trusted, and restart, or stop if that
        is impossible. The line counts as unreadable."""
        told, had = self._told(), self.place is not None
        told.append(
            {"vehicle": self.name, "event": "failed", "reason": why, **({} if line is None else {"line": line})}
        )
        self.withdrew = self.withdrew or had
        try:
            self._renew(why)
        except Exception as error:  # no machine can be had any more, whatever the reason
            self._stop(f"{why}; then {type(error).__name__}: {error}")
        return [*told, *self._told()]

    @property
    def place(self) -> tuple[int, int] | None:
        """The interval that it reports, in mm; None while it reports none."""
        interval = None if self.controller is None else self.controller.report.interval
        return None if interval is None else (interval.low_mm, interval.high_mm)

    @property
    def forgettable(self) -> bool:
        """True if the vehicle can be removed: it reports no position, and neither would a new one; only its count is
        lost."""
        controller = self.controller
        return controller is None or (not self.stopped and self.place is None and controller.may_begin_anew)

    def finish(self) -> list[Told]:
        """Nothing more will come: the open cycle is over, if anything came in it."""
        if self.controller is not None and not self.stopped and (self._anything_open() or self._lost):
            self._close()
        return self._told()

    def freeze(self) -> Callable[[], dict[str, Any]]:
        """Return a function that makes the vehicle as plain data, in whichever thread it is called."""
        controller = None if self.controller is None else self.controller.freeze()
        own = {
            "lost": [self._lost, self._lost_until_heard],
            "count": [self._count.last, self._count.unsure],
            "recount": [self._count.agreed.last, self._count.agreed.lines],
            "streak": [self._streak.first_ms, self._streak.last_ms],
            "rhythm": [self._rhythm.last_ms, self._rhythm.stride_ms],
            "stopped": self.stopped,
            **self._own(),
        }
        return lambda: {"controller": None if controller is None else controller().decode(), **own}

    def restore(self, content: Mapping[str, Any]) -> None:
        """Go on where `freeze` was called; SnapshotError where the controller is of something else, or a field is none."""
        kept = self._checked(content)
        if kept.controller is not None:
            self.controller = self._make(0)
            self.controller.restore(kept.controller.encode())
        self._lost, self._lost_until_heard = kept.lost
        self._count = LineCount(*kept.count, Agreement(*kept.recount))
        self._streak, self._rhythm = Streak(self._pace, *kept.streak), Rhythm(*kept.rhythm)
        self.stopped = kept.stopped

    # ------------------------------------------------------------------ for both kinds

    def _counted(self, line: int, message: Said | Ended | Step) -> None:
        time_ms = self._time_ms(message)
        if time_ms is not None and time_ms > LATEST_MS:
            self._refuse(line, f"its time is {time_ms} ms, more than any clock shows")
            self._doubt(f"line {line}: its time")
            return
        counted = self._count.take(message.envelope.number)
        if counted.lost:
            self._doubt(counted.lost)
        if counted.refused:
            self._refuse(line, counted.refused)
        else:
            self._take(line, message)

    def _time_ms(self, message: Said | Ended | Step) -> int | None:
        match message:
            case Said(record=record):
                return record.time_ms
            case Ended(time_ms=time_ms):
                return time_ms
            case Step(cycle=cycle):
                return None if cycle is None else cycle * self._pace.period_ms

    @abstractmethod
    def _take(self, line: int, message: Said | Ended | Step) -> None:
        """A line that counts."""

    @abstractmethod
    def _close(self) -> None:
        """The open cycle is over."""

    @abstractmethod
    def _anything_open(self) -> bool:
        """Return whether the open cycle has input that waits for its end."""

    @abstractmethod
    def _own(self) -> Mapping[str, Any]:
        """Return the own memory of this kind of vehicle, as plain data."""

    @abstractmethod
    def _checked(self, content: Mapping[str, Any]) -> Kept:
        """Check a snapshot of this kind of vehicle and restore its own part; SnapshotError if it is wrong."""

    @abstractmethod
    def _forget_open(self) -> None:
        """Discard the input of the open cycle."""

    def _missed(self, why: str) -> None:
        self._doubt(why)

    def _doubt(self, why: str) -> None:
        """Something was lost between its last line and its next one."""
        self._lost = self._lost or why
        self._lost_until_heard = why

    def _heard(self) -> None:
        """The line that comes next after a loss is in the cycle that is open now."""
        if self._lost_until_heard:
            self._lost, self._lost_until_heard = self._lost or self._lost_until_heard, ""

    def _in_step(self, line: int, time_ms: int) -> bool:
        """Return whether the line's time follows the vehicle's clock; a clock that was set is accepted after several
        lines."""
        controller, pace = self.controller, self._pace
        assert controller is not None
        ahead = time_ms - controller.next_end_ms
        if -pace.period_ms < ahead <= pace.at_once_ms(self._rhythm.stride_ms):
            self._streak.end()
            self._rhythm.heard(time_ms)
            return True
        within = 0 < ahead <= pace.longest_gap_ms
        if ahead > 0:
            self._streak.end_before(controller.next_end_ms)
        if self._streak.goes_on(time_ms, AGREEING_CYCLES if within else OUT_OF_STEP_CYCLES):
            self._rhythm = Rhythm(time_ms, time_ms - (self._streak.first_ms or 0) if within else 0)
            self._streak.end()
            if not within:
                self._anew(f"its clock was set by {ahead} ms", pace.beginning(time_ms))
            return not self.stopped
        if ahead > 0:
            self._refuse(line, self._too_early(ahead, within))
            self._lost_until_heard = f"line {line}: ahead of its time"
        return ahead <= 0

    def _too_early(self, ahead: int, within: bool) -> str:
        if within:
            return f"{ahead} ms ahead; believed once lines of {AGREEING_CYCLES} cycles agree"
        return f"{ahead} ms ahead; a gap may have at most {self._pace.longest_gap_ms} ms"

    def _anew(self, reason: str, start_ms: int | None = None) -> None:
        """Restart, by default with the open cycle."""
        assert self.controller is not None
        if self._anything_open():
            self._close()
        if self.stopped:
            return
        start_ms = self.controller.next_end_ms - self._pace.period_ms if start_ms is None else start_ms
        self._tell(self._guarded(lambda controller: controller.begin_anew(reason, start_ms)), {})
        self._doubt(reason)

    def _renew(self, why: str) -> None:
        """Another machine in the place of this one, in the cycle that is open."""
        self._forget_open()
        self._doubt(why)
        if self.controller is not None and not self.stopped:
            start_ms = self.controller.next_end_ms - self._pace.period_ms
            self.controller = self._make(start_ms)
            self._tell(self._guarded(lambda controller: controller.begin_anew(why)), {})

    def _stop(self, why: str) -> None:
        self.stopped = shortened(why)
        self._out.append({"vehicle": self.name, "event": "halted", "reason": self.stopped})

    def _guarded(self, step: Callable[[Controller], Report]) -> Report | None:
        """Run a step and send its report; stop the vehicle if the machine cannot continue."""
        controller = self.controller
        assert controller is not None
        had = controller.report.interval is not None
        try:
            report = step(controller)
        except InputError as error:
            self._stop(str(error))
            self.withdrew = self.withdrew or had
            return None
        self.withdrew = self.withdrew or (had and report.interval is None)
        self.wrong += report.standing == "WRONG"
        return report

    def _tell(self, report: Report | None, lines: Mapping[int, int]) -> None:
        """`lines`: place of a record in its step -> the line it came in."""
        if report is None:
            return
        data = {"vehicle": self.name, **report.as_data()}
        for rejection in data.get("rejections", ()):
            if "number" in rejection:
                rejection["line"] = lines[rejection.pop("number")]
        self._out.append(data)

    def _refuse(self, line: int, reason: str) -> None:
        self._out.append({"vehicle": self.name, "event": "refused", "line": line, "reason": shortened(reason)})

    def _told(self) -> list[Told]:
        told, self._out = self._out, []
        return told
