"""One vehicle of the process: it turns lines into cycles of its controller, and accounts for every lost line.

After an unreadable line, a gap in the numbers or a disconnection, data may be lost between two received lines. The cycles of
these two lines are run without inputs, and so are all cycles between them.

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
from safeloc.runtime.service.messages import CycleEnd, Header, Message, RecordLine, Refused, Step, shortened
from safeloc.runtime.service.saved_fields import SavedVehicle

Output = dict[str, Any]
MakeController = Callable[[int], Controller]
"""Start of the first cycle in ms -> controller."""


class Vehicle(ABC):
    """A vehicle that turns lines into reports and events. Two subclasses define the meaning of a line.

    from_start its first line is the first one that was sent; otherwise the cycle of that line may be incomplete
    withdrew   a reported position was withdrawn: set here, cleared by the fleet
    stopped    the reason why the vehicle has stopped; "" while it runs
    """

    def __init__(self, name: str, make: MakeController, pace: Pace, *, from_start: bool) -> None:
        self.name, self.withdrew, self.stopped = name, False, ""
        self.wrong = 0
        self.controller: Controller | None = None
        self._make, self._pace = make, pace
        self._count = LineCount(None, "" if from_start else "its first lines may be missing")
        self._streak = Streak(pace)
        self._rhythm = Rhythm()
        self._lost = self._lost_before_next = ""
        self._out: list[Output] = []

    # ------------------------------------------------------------------ for the fleet

    def handle(self, line: int, message: Message) -> list[Output]:
        """Handle one line of this vehicle."""
        match message:
            case RecordLine() | CycleEnd() | Step():
                if self.stopped:
                    self._refuse(line, f"halted: {self.stopped}")
                else:
                    self._counted(line, message)
            case Refused(reason=reason):
                self._refuse(line, reason)
                self._missed(f"line {line}: {reason}")
            case Header():
                pass
        return self._outputs()

    def missed(self, why: str) -> list[Output]:
        """Note that an unknown number of this vehicle's lines may have been lost."""
        self._doubt(why)
        return self._outputs()

    def be_unsure(self, why: str) -> None:
        """Note that lines may have been lost; the number of its next line decides it."""
        self._count.unsure = self._count.unsure or why

    def silence(self, why: str) -> list[Output]:
        """End the open cycle. If it has input, this may be incomplete and is not used."""
        if self.controller is not None and not self.stopped:
            if self._anything_open():
                self._lost = self._lost or why
            self._close()
        return self._outputs()

    def withdraw(self, why: str) -> list[Output]:
        """Withdraw its position by a restart, if it reports one."""
        if self.place is not None and not self.stopped:
            self._lost = self._lost or why
            self._anew(why)
        return self._outputs()

    def fail(self, why: str, line: int | None) -> list[Output]:
        """Handle an unexpected exception: replace the machine, since its state is not trusted, and restart, or stop if that
        is impossible. The line counts as unreadable."""
        outputs, had = self._outputs(), self.place is not None
        outputs.append(
            {"vehicle": self.name, "event": "failed", "reason": why, **({} if line is None else {"line": line})}
        )
        self.withdrew = self.withdrew or had
        try:
            self._renew(why)
        except Exception as error:  # of any kind: no machine can be made
            self._stop(f"{why}; then {type(error).__name__}: {error}")
        return [*outputs, *self._outputs()]

    @property
    def place(self) -> tuple[int, int] | None:
        """Return the interval that it reports, in mm; None while it reports none."""
        interval = None if self.controller is None else self.controller.report.interval
        return None if interval is None else (interval.low_mm, interval.high_mm)

    @property
    def forgettable(self) -> bool:
        """Return whether the vehicle can be removed: it reports no position, and neither would a new one."""
        controller = self.controller
        return controller is None or (not self.stopped and self.place is None and controller.may_begin_anew)

    def finish(self) -> list[Output]:
        """Handle the end of all lines: end the open cycle, if it has input or lost some."""
        if self.controller is not None and not self.stopped and (self._anything_open() or self._lost):
            self._close()
        return self._outputs()

    def freeze(self) -> Callable[[], dict[str, Any]]:
        """Return a function that returns the vehicle as plain data; it may be called in another thread."""
        controller = None if self.controller is None else self.controller.freeze()
        own = {
            "lost": [self._lost, self._lost_before_next],
            "count": [self._count.last, self._count.unsure],
            "recount": [self._count.agreed.last, self._count.agreed.lines],
            "streak": [self._streak.first_ms, self._streak.last_ms],
            "rhythm": [self._rhythm.last_ms, self._rhythm.stride_ms],
            "stopped": self.stopped,
            **self._own(),
        }
        return lambda: {"controller": None if controller is None else controller().decode(), **own}

    def restore(self, content: Mapping[str, Any]) -> None:
        """Continue from the data that `freeze` gave; SnapshotError if they are invalid or of another machine."""
        saved = self._checked(content)
        if saved.controller is not None:
            self.controller = self._make(0)
            self.controller.restore(saved.controller.encode())
        self._lost, self._lost_before_next = saved.lost
        self._count = LineCount(*saved.count, Agreement(*saved.recount))
        self._streak, self._rhythm = Streak(self._pace, *saved.streak), Rhythm(*saved.rhythm)
        self.stopped = saved.stopped

    # ------------------------------------------------------------------ for both kinds

    def _counted(self, line: int, message: RecordLine | CycleEnd | Step) -> None:
        time_ms = self._time_ms(message)
        if time_ms is not None and time_ms > LATEST_MS:
            self._refuse(line, f"its time is {time_ms} ms, more than any clock can show")
            self._doubt(f"line {line}: its time")
            return
        counted = self._count.take(message.envelope.number)
        if counted.lost:
            self._doubt(counted.lost)
        if counted.refused:
            self._refuse(line, counted.refused)
        else:
            self._take(line, message)

    def _time_ms(self, message: RecordLine | CycleEnd | Step) -> int | None:
        match message:
            case RecordLine(record=record):
                return record.time_ms
            case CycleEnd(time_ms=time_ms):
                return time_ms
            case Step(cycle=cycle):
                return None if cycle is None else cycle * self._pace.period_ms

    @abstractmethod
    def _take(self, line: int, message: RecordLine | CycleEnd | Step) -> None:
        """Handle a line whose number is in order."""

    @abstractmethod
    def _close(self) -> None:
        """End the open cycle."""

    @abstractmethod
    def _anything_open(self) -> bool:
        """Return whether the open cycle has input."""

    @abstractmethod
    def _own(self) -> Mapping[str, Any]:
        """Return the memory of this subclass as plain data."""

    @abstractmethod
    def _checked(self, content: Mapping[str, Any]) -> SavedVehicle:
        """Check the data of a snapshot and restore the memory of this subclass; SnapshotError if they are invalid."""

    @abstractmethod
    def _forget_open(self) -> None:
        """Discard the input of the open cycle."""

    def _missed(self, why: str) -> None:
        self._doubt(why)

    def _doubt(self, why: str) -> None:
        """Note that lines were lost between the last line and the next one."""
        self._lost = self._lost or why
        self._lost_before_next = why

    def _note_line(self) -> None:
        """Note a line in the open cycle: if it is the first one after a loss, this cycle is incomplete too."""
        if self._lost_before_next:
            self._lost, self._lost_before_next = self._lost or self._lost_before_next, ""

    def _in_step(self, line: int, time_ms: int) -> bool:
        """Return whether the line's time fits the vehicle's clock; a changed clock is accepted after several lines."""
        controller, pace = self.controller, self._pace
        assert controller is not None
        ahead = time_ms - controller.next_end_ms
        if -pace.period_ms < ahead <= pace.at_once_ms(self._rhythm.stride_ms):
            self._streak.first_ms = None
            self._rhythm.note(time_ms)
            return True
        within = 0 < ahead <= pace.longest_gap_ms
        if ahead > 0:
            self._streak.end_before(controller.next_end_ms)
        if self._streak.goes_on(time_ms, AGREEING_CYCLES if within else OUT_OF_STEP_CYCLES):
            self._rhythm = Rhythm(time_ms, time_ms - (self._streak.first_ms or 0) if within else 0)
            self._streak.end()
            if not within:
                self._anew(f"its clock was changed by {ahead} ms", pace.beginning(time_ms))
            return not self.stopped
        if ahead > 0:
            self._refuse(line, self._too_early(ahead, within))
            self._lost_before_next = f"line {line}: ahead of its time"
        return ahead <= 0

    def _too_early(self, ahead: int, within: bool) -> str:
        if within:
            return f"{ahead} ms ahead; accepted as soon as lines of {AGREEING_CYCLES} cycles agree"
        return f"{ahead} ms ahead; a gap may have at most {self._pace.longest_gap_ms} ms"

    def _anew(self, reason: str, start_ms: int | None = None) -> None:
        """Restart the machine, by default with the open cycle."""
        assert self.controller is not None
        if self._anything_open():
            self._close()
        if self.stopped:
            return
        start_ms = self.controller.next_end_ms - self._pace.period_ms if start_ms is None else start_ms
        self._tell(self._restarted(reason, start_ms), {})
        self._doubt(reason)

    def _restarted(self, reason: str, start_ms: int | None = None) -> Report | None:
        """Restart the machine from its first state, at a time or with the open cycle; stop the vehicle if it cannot."""
        return self._guarded(lambda controller: controller.begin_anew(reason, start_ms))

    def _renew(self, why: str) -> None:
        """Replace the machine by a new one, in the open cycle."""
        self._forget_open()
        self._doubt(why)
        if self.controller is not None and not self.stopped:
            start_ms = self.controller.next_end_ms - self._pace.period_ms
            self.controller = self._make(start_ms)
            self._tell(self._restarted(why), {})

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
        """Send a report; `lines`: place of a record in its step -> number of its line."""
        if report is None:
            return
        data = {"vehicle": self.name, **report.as_data()}
        for rejection in data.get("rejections", ()):
            if "number" in rejection:
                rejection["line"] = lines[rejection.pop("number")]
        self._out.append(data)

    def _refuse(self, line: int, reason: str) -> None:
        self._out.append({"vehicle": self.name, "event": "refused", "line": line, "reason": shortened(reason)})

    def _outputs(self) -> list[Output]:
        outputs, self._out = self._out, []
        return outputs
