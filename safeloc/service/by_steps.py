"""A vehicle whose lines are the inputs of whole steps: each is a cycle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safeloc.service.messages import Ended, Said, Step
from safeloc.service.vehicle import Told, Vehicle


class StepsVehicle(Vehicle):
    """With cycle numbers a lost line is a gap, and every cycle of it a step without inputs. Without them a line that
    cannot be read is such a step, and a loss of unknown length ends in beginning anew."""

    _numbered = False

    def finish(self) -> list[Told]:
        """Nothing waits for an end."""
        return self._told()

    def _take(self, line: int, message: Said | Ended | Step) -> None:
        assert isinstance(message, Step)
        cycle = message.cycle
        if cycle is None and self._numbered:
            self._refuse(line, "no cycle number, though steps before had one")
            return
        self._numbered = cycle is not None
        period_ms = self._pace.period_ms
        if self.controller is None:
            self.controller = self._make(0 if cycle is None else (cycle - 1) * period_ms)
        if cycle is None:
            self._go_on()
        elif not self._reached(line, cycle * period_ms):
            return
        if not self.stopped:
            self._lost = self._lost_until_heard = ""
            step = self._guarded(lambda one: one.step_inputs(message.inputs, truth_mm=message.truth_mm))
            self._tell(step, {})

    def _go_on(self) -> None:
        """The next step, if the last line is known to have been the one before."""
        assert self.controller is not None
        if self._lost_until_heard:
            self._anew(self._lost_until_heard, self.controller.next_end_ms - self._pace.period_ms)

    def _reached(self, line: int, end_ms: int) -> bool:
        """Whether the step that ends then is the next one, the cycles between having been charged."""
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
        """A step that cannot be read; with cycle numbers, the gap will show."""
        if self.controller is not None and not self._numbered and not self.stopped:
            self._lost = why
            self._close()

    def _close(self) -> None:
        lost, self._lost = self._lost, ""
        self._tell(self._guarded(lambda one: one.step_inputs({}, lost=lost)), {})

    def _anything_open(self) -> bool:
        return False

    def _own(self) -> Mapping[str, Any]:
        return {"numbered": self._numbered}

    def _restore_own(self, kept: Mapping[str, Any]) -> None:
        self._numbered = kept["numbered"]
