"""A run as columns: inputs, transitions, state and outputs of every step, each with its unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.expr import BoolVar, Expr, Num
from safeloc.language.nodes import Value
from safeloc.language.trace import Trace, present_inputs
from safeloc.language.units import COUNT, ONE, Enumeration

Cell = int | bool | str | None
GROUPS = ("input", "fired", "state", "output")
_COUNTED = (ONE, COUNT)
"""Units of numbers and identities, which no heading names."""


@dataclass(frozen=True)
class Column:
    """The values of one variable over the steps; None where it is absent.

    group  one of GROUPS
    kind   `number`, `truth` or `label`: labels are modes, members of enumerations and transitions
    unit   "" for truth values, labels, and numbers that count or name something
    """

    group: str
    name: str
    kind: str
    unit: str
    values: Sequence[Cell]

    @property
    def heading(self) -> str:
        """The group and the name, with the unit behind it if the name does not carry it: `state.height_mm`, `state.height [mm]`."""
        carries = not self.unit or self.name.endswith(f"_{self.unit.replace('/', '_')}")
        return f"{self.group}.{self.name}{'' if carries else f' [{self.unit}]'}"


@dataclass(frozen=True)
class RunColumns:
    """A run: its columns, all as long as it has steps, and the time from one step to the next, if that is known.

    truth_mm  the recorded true position after each step; None where there is none
    """

    machine: str
    columns: tuple[Column, ...]
    steps: int
    period_ms: int | None
    truth_mm: Sequence[int | None]


def run_columns(trace: Trace, *, period_ms: int | None = None, truth_mm: Sequence[int | None] = ()) -> RunColumns:
    """Return the columns of a run. `truth_mm` is empty, or has a value for each step."""
    system, absent = trace.system, stand_ins(trace.system)
    inputs = [present_inputs(system, step.inputs) for step in trace.steps]
    outputs = [without_absent(step.outputs, absent) for step in trace.steps]
    flags = {option.present.name for option in system.optionals}
    columns = (
        *(_of("input", var.name, var, inputs) for var in system.inputs if var.name not in flags),
        *(_fired(name.name, trace) for name in system.fired),
        *(_of("state", var.name, var, [step.state for step in trace.steps]) for var in system.state),
        *(_of("output", name, term, outputs) for name, term in system.outputs.items()),
    )
    truth = list(truth_mm) if any(value is not None for value in truth_mm) else []
    return RunColumns(system.name, columns, len(trace.steps), period_ms, truth)


def _of(group: str, name: str, term: Expr, rows: Sequence[Mapping[str, Value | None]]) -> Column:
    unit = term.unit if isinstance(term, Num) else None
    values = [row.get(name) for row in rows]
    if isinstance(unit, Enumeration):
        return Column(group, name, "label", "", [None if value is None else unit.members[value] for value in values])
    if unit is None or isinstance(term, BoolVar):
        return Column(group, name, "truth", "", values)
    return Column(group, name, "number", "" if unit in _COUNTED else unit.name, values)


def _fired(name: str, trace: Trace) -> Column:
    return Column("fired", name, "label", "", [step.fired[name] for step in trace.steps])
