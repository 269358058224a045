"""An area in the process: its detection sends the lines, as a vehicle does; reports of vehicles fill in what it cannot know."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from safeloc.railway.trackside.seen import Seen
from safeloc.railway.trackside.trains import SavedTrains, Trains
from safeloc.runtime.embedding import Report
from safeloc.runtime.service.by_steps import StepsVehicle
from safeloc.runtime.service.clock_lag import Pace
from safeloc.runtime.service.messages import Step
from safeloc.runtime.service.saved_fields import SavedSteps, SavedVehicle
from safeloc.runtime.service.vehicle import MakeController, Output

_OF_TRAINS = "area.train_"


class SavedArea(SavedSteps):
    """The fields of an area: those of a vehicle that sends steps, and its trains."""

    trains: SavedTrains


class AreaVehicle(StepsVehicle):
    """An area, cycle by cycle of its detection.

    Its first state claims nothing (no section is clear), so it may begin anew at any time; what is lost is where trains are.
    """

    _fields = SavedArea
    _undisturbed = False

    def __init__(self, name: str, make: MakeController, pace: Pace, trains: Trains, *, from_start: bool) -> None:
        super().__init__(name, make, pace, from_start=from_start)
        self._trains = trains
        self._refused: dict[str, str] = {}

    def hear(self, vehicle: str, seen: Seen | str) -> list[Output]:
        """Take the report of a vehicle, or why it is none. A refusal is told when its reason changes."""
        if self.controller is None or self.stopped:
            return []
        why = seen if isinstance(seen, str) else self._trains.hear(vehicle, seen, self.controller.next_end_ms)
        if why == self._refused.get(vehicle, ""):
            return []
        self._refused[vehicle] = why
        if not why:
            return []
        return [{"vehicle": self.name, "event": "report refused", "train": vehicle, "reason": why}]

    def withdraw(self, why: str) -> list[Output]:
        """Begin anew, with no section clear, if one is."""
        if not self.stopped and self.controller is not None and _any_clear(self.controller.report):
            self._lost = self._lost or why
            self._anew(why)
        return self._outputs()

    def _filled(self, line: int, message: Step) -> Step | None:
        filled = super()._filled(line, message)
        if filled is None or self.controller is None:
            return None
        told = [name for name in filled.inputs if name.startswith(_OF_TRAINS)]
        if told:
            self._lost = f"{told[0]} comes from the reports of vehicles, not from detection"
            self._refuse(line, self._lost)
            self._close()
            return None
        given = filled.inputs
        self._undisturbed, clear = given.get("area.counters_healthy") is True, given.get("area.counters_clear") is True
        inputs = self._trains.inputs(self.controller.next_end_ms, clear=clear or not self._undisturbed)
        return filled._replace(inputs={**given, **inputs})

    def _close(self) -> None:
        self._undisturbed = False
        self._trains.skip()
        super()._close()

    def _restarted(self, reason: str, start_ms: int | None = None) -> Report | None:
        assert self.controller is not None
        self.controller = self._make(
            self.controller.next_end_ms - self._pace.period_ms if start_ms is None else start_ms
        )
        self._undisturbed, self.withdrew = False, True
        self._trains.begin_anew()
        return replace(self.controller.report, anew=reason)

    def _tell(self, report: Report | None, lines: Mapping[int, int]) -> None:
        if report is None:
            return
        values, slots = report.values, range(1, len(report.values) + 1)
        present = [bool(values[name]) for slot in slots if (name := f"{_OF_TRAINS}{slot}_in_area") in values]
        undisturbed = self._undisturbed and not report.rejections
        changed = self._trains.stepped(report.time_ms, present, undisturbed=undisturbed)
        self.withdrew = self.withdrew or changed  # so that the next owner knows who has which slot
        super()._tell(report, lines)
        self._out[-1]["trains"] = {str(slot): vehicle for slot, vehicle in sorted(self._trains.slots.items())}

    def _own(self) -> Mapping[str, Any]:
        return {**super()._own(), "trains": self._trains.freeze()}

    def _checked(self, content: Mapping[str, Any]) -> SavedVehicle:
        kept = super()._checked(content)
        assert isinstance(kept, SavedArea)
        self._trains.restore(kept.trains)
        return kept


def _any_clear(report: Report) -> bool:
    return any(bool(value) for name, value in report.values.items() if name.endswith(".clear"))
