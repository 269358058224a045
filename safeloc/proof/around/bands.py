"""Proved bounds of signals in each cycle of a tube, to be drawn around what was recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from safeloc.language.absence import stand_in_of, value_while_present
from safeloc.language.expr import Expr, Num
from safeloc.language.interpret import evaluate
from safeloc.language.ranges import Bounds
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import Trace, present_inputs
from safeloc.language.units import Enumeration
from safeloc.language.written_claims import signals
from safeloc.proof.around.course import Course


@dataclass(eq=False)
class Bands:
    """Bounds by signal and cycle, over all courses that were seen; None where the signal is absent or never computed."""

    system: TransitionSystem
    names: Sequence[str]
    bounds: dict[str, dict[int, Bounds]] = field(default_factory=dict)

    def see(self, course: Course) -> None:
        """Widen the bands by a course of a window."""
        known = signals(self.system)
        for name in self.names:
            term = known[name]
            if not isinstance(term, Num) or isinstance(term.unit, Enumeration):
                continue
            for cycle in range(course.begin + 1, course.end + 1):
                found = self._in(course, name, term, cycle)
                if found is not None:
                    of_name = self.bounds.setdefault(name, {})
                    low, high = of_name.get(cycle, found)
                    of_name[cycle] = min(low, found[0]), max(high, found[1])

    def _in(self, course: Course, name: str, term: Num, cycle: int) -> Bounds | None:
        inputs = course.inputs[cycle - course.begin - 1]
        given: Expr | None = next((one for var, one in inputs.items() if var.name == name), None)
        if name not in self.system.outputs and given is not None:
            present = next((one for var, one in inputs.items() if var.name == f"{name}.present"), None)
            if present is not None and not _evaluated_or_true(present):
                return None
            return course.intervals(given) if isinstance(given, Num) else None
        number = stand_in_of(term)
        whole = course.at(term, cycle)
        assert isinstance(whole, Num)
        if number is not None and course.intervals(whole) == (number, number):
            return None
        value = course.at(value_while_present(term), cycle) if number is not None else whole
        assert isinstance(value, Num)
        return course.intervals(value)

    def series(self, name: str, cycles: int) -> tuple[list[float | None], list[float | None]]:
        """Return the lower and the upper bounds after 0, 1, 2 ... cycles."""
        of_name = self.bounds.get(name, {})
        both = [of_name.get(cycle) for cycle in range(cycles + 1)]
        return [None if one is None else float(one[0]) for one in both], [
            None if one is None else float(one[1]) for one in both
        ]


def _evaluated_or_true(term: Expr) -> bool:
    """Return whether a truth value may hold: its value if it is a constant."""
    try:
        return bool(evaluate([term], {})[0])
    except KeyError:
        return True


def recorded_series(trace: Trace, system: TransitionSystem, name: str) -> list[float | None]:
    """Return what was recorded of a signal after 0, 1, 2 ... cycles; None where it is absent."""
    number = stand_in_of(system.outputs[name]) if name in system.outputs else None
    found: list[float | None] = [None]
    for one in trace.steps:
        values = {**present_inputs(trace.system, one.inputs), **one.state, **one.outputs}
        value = values.get(name)
        found.append(None if value is None or value == number else float(value))
    return found
