"""A vehicle whose lines are the inputs of whole steps: each is a cycle."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from safeloc.runtime.service.counting import AGREEING_LINES
from safeloc.runtime.service.kept import Kept, KeptSteps, kept_as
from safeloc.runtime.service.messages import TRUTH, Ended, Said, Step
from safeloc.runtime.service.vehicle import Told, Vehicle


class StepsVehicle(Vehicle):
    """With cycle numbers a lost line is a gap, and every cycle of it a step without inputs. Without them a line that says
    something wrong is such a step. What cannot be read at all may have been any number of steps, their line ends being
    damaged: as every loss of unknown length, it ends in beginning anew.

    A stream may leave out what is as it was in the step before (`begin_stream`). After a step that was lost, what is
    left out is not known, and steps are not used until they say it again.
    """

    _numbered = False
    _bare = 0
    _kept: tuple[str, ...] = ()
    _before: Mapping[str, Any] = MappingProxyType({})

    def begin_stream(self, kept: tuple[str, ...]) -> None:
        """Begin a stream in which steps leave out unchanged inputs of these names."""
        self._kept, self._before = kept, {}

    def finish(self) -> list[Told]:
        """Nothing waits for an end, but a loss of unknown length for its consequence."""
        if self._lost_until_heard and not self._numbered and self.controller is not None and not self.stopped:
            self._go_on()
        return self._told()

    def _take(self, line: int, message: Said | Ended | Step) -> None:
        assert isinstance(message, Step)
        cycle = message.cycle
        if not self._counted_as_before(line, cycle):
            return
        period_ms = self._pace.period_ms
        if self.controller is None:
            self.controller = self._make(0 if cycle is None else (cycle - 1) * period_ms)
        if cycle is None:
            self._go_on()
        elif not self._reached(line, cycle * period_ms):
            return
        self._numbered = cycle is not None
        whole = None if self.stopped else self._filled(line, message)
        if whole is not None:
            self._lost = self._lost_until_heard = ""
            step = self._guarded(lambda one: one.step_inputs(whole.inputs, truth_mm=whole.truth_mm))
            self._tell(step, {})

    def _counted_as_before(self, line: int, cycle: int | None) -> bool:
        """Check that the step has a cycle number if earlier ones had; after several steps without one, accept the
        change."""
        if cycle is not None or not self._numbered:
            self._bare = 0
            return True
        self._bare += 1
        if self._bare < AGREEING_LINES:
            self._refuse(line, "no cycle number, though steps before had one")
            return False
        self._bare = 0
        self._doubt("its steps have no cycle number any more")
        return True

    def _filled(self, line: int, message: Step) -> Step | None:
        """Fill in the inputs that the step leaves out; None, and a discarded step, if the step before is not known."""
        if not self._kept:
            return message
        said = {**message.inputs, **({} if message.truth_mm is None else {TRUTH: message.truth_mm})}
        unknown = [name for name in self._kept if name not in said and name not in self._before]
        if unknown:
            self._lost = f"{unknown[0]} is left out as kept, and the step before does not say what it is"
            self._refuse(line, self._lost)
            self._close()
            return None
        self._before = {**{name: self._before[name] for name in self._kept if name not in said}, **said}
        inputs = {name: value for name, value in self._before.items() if name != TRUTH}
        return message._replace(inputs=inputs, truth_mm=self._before.get(TRUTH))

    def _go_on(self) -> None:
        """The next step, if the last line is known to have been the one before."""
        assert self.controller is not None
        if self._lost_until_heard:
            self._before = {}
            self._anew(self._lost_until_heard)

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
        """A step that says something wrong; with cycle numbers, the gap will show."""
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

    def _checked(self, content: Mapping[str, Any]) -> Kept:
        kept = kept_as(KeptSteps, content)
        self._numbered, self._bare = kept.numbered, kept.bare
        self.begin_stream(kept.kept)
        self._before = kept.before
        return kept
