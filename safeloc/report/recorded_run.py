"""A replayed run for the pictures: signals by name, step by step, and the violated statements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.nodes import Expr, Num, Value
from safeloc.language.trace import Step, Trace, present_inputs
from safeloc.language.units import NM_PER_MM, Enumeration

Series = Sequence[float | None]


@dataclass(frozen=True)
class Broken:
    """A statement that the run violates, and the first step (from 1) in which it does."""

    name: str
    step: int


@dataclass(frozen=True)
class RecordedRun:
    """A run with the recorded truth of each step in mm (None: unknown).

    name  name of the recording, without the suffix of its file
    """

    name: str
    trace: Trace
    truth_mm: tuple[int | None, ...]
    broken: tuple[Broken, ...] = ()

    @cached_property
    def given(self) -> list[Mapping[str, Value]]:
        """The inputs of each step, without absent ones."""
        return [present_inputs(self.trace.system, step.inputs) for step in self.trace.steps]

    @cached_property
    def rows(self) -> list[Mapping[str, Value]]:
        """Inputs, state and outputs after each step, without absent ones. An output takes precedence over a state variable of
        the same name, and that over an input."""
        pairs = zip(self.given, self.trace.steps, strict=True)
        return [{**given, **step.state, **self._outputs(step)} for given, step in pairs]

    def _outputs(self, step: Step) -> dict[str, Value]:
        outputs = without_absent(step.outputs, stand_ins(self.trace.system))
        return {name: value for name, value in outputs.items() if value is not None}

    def series(self, name: str) -> list[float | None]:
        """Return the values of a signal; None where it is absent."""
        return [None if name not in row else float(row[name]) for row in self.rows]

    def flags(self, name: str) -> list[bool]:
        """Return the values of a boolean; False where it is absent."""
        return [bool(row.get(name, False)) for row in self.rows]

    def words(self, name: str) -> list[str]:
        """Return the values of a signal in words: labels of an enumeration, else numbers; "" where it is absent."""
        return [self.word(name, row[name]) if name in row else "" for row in self.rows]

    def word(self, name: str, value: Value) -> str:
        """Return one value of a signal in words."""
        members = self.members(name)
        return members[value] if members else str(value)

    def members(self, name: str) -> tuple[str, ...]:
        """Return all members of an enumeration, in order; none for a signal that is no enumeration."""
        term = self._term(name)
        return term.unit.members if isinstance(term, Num) and isinstance(term.unit, Enumeration) else ()

    def _term(self, name: str) -> Expr:
        outputs = self.trace.system.outputs
        return outputs[name] if name in outputs else self.trace.system.variable(name)

    def truth(self, ghost: str) -> list[float | None]:
        """Return the true position of each step in mm: as recorded, else from the ghost of this name (in nm); None if unknown."""
        if any(value is not None for value in self.truth_mm):
            return [None if value is None else float(value) for value in self.truth_mm]
        return [None if value is None else value / NM_PER_MM for value in self.series(ghost)]
