"""A vehicle whose lines are the inputs of complete steps: each line is a cycle."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from safeloc.runtime.service.counting import AGREEING_LINES
from safeloc.runtime.service.messages import TRUTH, CycleEnd, RecordLine, Step
from safeloc.runtime.service.saved_fields import SavedSteps, SavedVehicle, checked_fields
from safeloc.runtime.service.vehicle import Output, Vehicle


class StepsVehicle(Vehicle):
    """A vehicle whose lines are steps, with or without cycle numbers.

    With cycle numbers, a lost line is a gap, and each cycle of the gap becomes a step without inputs. Without them, a line with
    a wrong value becomes such a step. An unreadable line may have been any number of steps, if line ends were damaged: as
    after any loss of unknown length, the vehicle restarts.

    A stream may leave out values that are as in the step before (`begin_stream`). After a lost step these values are not
    known, and steps are not used until the stream contains them again.
    """

    _fields: type[SavedSteps] = SavedSteps
    _numbered = False
    _bare = 0
    _kept: tuple[str, ...] = ()
    _before: Mapping[str, Any] = MappingProxyType({})

    def begin_stream(self, kept: tuple[str, ...]) -> None:
        """Begin a stream whose steps leave out unchanged inputs of these names."""
        self._kept, self._before = kept, {}

    def finish(self) -> list[Output]:
        """Handle the end of all lines: no step is incomplete, but a loss of unknown length still causes a restart."""
        if self._lost_before_next and not self._numbered and self.controller is not None and not self.stopped:
            self._restart_after_loss()
        return self._outputs()

    def _take(self, line: int, message: RecordLine | CycleEnd | Step) -> None:
        assert isinstance(message, Step)
        cycle = message.cycle
        if not self._counted_as_before(line, cycle):
            return
        period_ms = self._pace.period_ms
        if self.controller is None:
            self.controller = self._make(0 if cycle is None else (cycle - 1) * period_ms)
        if cycle is None:
            self._restart_after_loss()
        elif not self._reached(line, cycle * period_ms):
            return
        self._numbered = cycle is not None
        filled = None if self.stopped else self._filled(line, message)
        if filled is not None:
            self._lost = self._lost_before_next = ""
            step = self._guarded(lambda one: one.step_inputs(filled.inputs, truth_mm=filled.truth_mm))
            self._tell(step, {})

    def _counted_as_before(self, line: int, cycle: int | None) -> bool:
        """Check that the step has a cycle number if earlier ones had; after several steps without one, accept the
        change."""
        if cycle is not None or not self._numbered:
            self._bare = 0
            return True
        self._bare += 1
        if self._bare < AGREEING_LINES:
            self._refuse(line, "no cycle number, but earlier steps had one")
            return False
        self._bare = 0
        self._doubt("its steps have no cycle number any more")
        return True

    def _filled(self, line: int, message: Step) -> Step | None:
        """Fill in the inputs that the step leaves out; None, and a discarded step, if the step before is not known."""
        if not self._kept:
            return message
        given = {**message.inputs, **({} if message.truth_mm is None else {TRUTH: message.truth_mm})}
        unknown = [name for name in self._kept if name not in given and name not in self._before]
        if unknown:
            self._lost = f"{unknown[0]} is left out as kept, but the step before has no value of it"
            self._refuse(line, self._lost)
            self._close()
            return None
        self._before = {**{name: self._before[name] for name in self._kept if name not in given}, **given}
        inputs = {name: value for name, value in self._before.items() if name != TRUTH}
        return message._replace(inputs=inputs, truth_mm=self._before.get(TRUTH))

    def _restart_after_loss(self) -> None:
        """Restart if lines may be missing between the last step and the next one."""
        assert self.controller is not None
        if self._lost_before_next:
            self._before = {}
            self._anew(self._lost_before_next)

    def _reached(self, line: int, end_ms: int) -> bool:
        """Run the missing cycles without inputs; return whether the step that ends at that time is then the next one."""
        assert self.controller is not None
        if not self._in_step(line, end_ms):
            return False
        if end_ms < self.controller.next_end_ms:
            self._refuse(line, f"cycle {end_ms // self._pace.period_ms} is over")
            return False
        while not self.stopped and self.controller.next_end_ms < end_ms:
            self._close()
        return not self.stopped

    def _missed(self, why: str) -> None:
        """Count a line with a wrong value as a step without inputs; with cycle numbers, it will show as a gap instead."""
        if self.controller is not None and not self._numbered and not self.stopped:
            self._lost = why
            self._close()

    def _close(self) -> None:
        lost, self._lost, self._before = self._lost, "", {}
        self._tell(self._guarded(lambda one: one.step_inputs({}, lost=lost)), {})

    def _anything_open(self) -> bool:
        return False

    def _forget_open(self) -> None:
        self._before = {}

    def _own(self) -> Mapping[str, Any]:
        return {"numbered": self._numbered, "bare": self._bare, "kept": list(self._kept), "before": dict(self._before)}

    def _checked(self, content: Mapping[str, Any]) -> SavedVehicle:
        kept = checked_fields(self._fields, content)
        self._numbered, self._bare = kept.numbered, kept.bare
        self.begin_stream(kept.kept)
        self._before = kept.before
        return kept
