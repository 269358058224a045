"""The inputs of a run that matter for what it shows: all others are at rest, that is absent, false or nearest to zero."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.expr import NumVar
from safeloc.language.first_values import Any_
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.trace import Trace, present_inputs, shown
from safeloc.proof.provers.shorten import shortened


@dataclass(frozen=True)
class Row:
    """A step: its number, the transitions that fire, and the inputs that are not at rest, as text by name."""

    number: int
    fired: str
    inputs: Mapping[str, str]


def simplest(trace: Trace, prop: Property, seconds: float) -> Trace:
    """Return the run with steps left out and inputs put to rest as far as the property still fails, within seconds of effort."""
    goal = observe(trace.system, prop)
    return shortened(goal, open_first(trace), [step.inputs for step in trace.steps], seconds)


def open_first(trace: Trace) -> dict[str, Value]:
    """Return the first values of the variables for which the declaration leaves them open."""
    system = trace.system
    return {var.name: trace.initial[var.name] for var in system.state if isinstance(system.initial[var], Any_)}


def mattering_rows(trace: Trace) -> list[Row]:
    """Return each step with those of its inputs that are not at rest."""
    rest = _rest(trace.system)
    rows = []
    for number, step in enumerate(trace.steps, 1):
        optional = {one.value.name for one in trace.system.optionals}
        came = present_inputs(trace.system, step.inputs)
        moved = {name: value for name, value in came.items() if name in optional or value != rest[name]}
        text = {name: shown(trace.system.variable(name), value) for name, value in moved.items()}
        rows.append(Row(number, ", ".join(step.fired.values()), text))
    return rows


def _rest(system: TransitionSystem) -> dict[str, Value]:
    return {var.name: canonical(var) if isinstance(var, NumVar) else False for var in system.inputs}
