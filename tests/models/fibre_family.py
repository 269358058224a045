"""What the tests of the fibre, verification, axle-counter and emitter machines share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.interpret import run
from safeloc.machine import Machine
from safeloc.provers.limits import Limits
from safeloc.provers.portfolio import prove
from safeloc.spec import Property
from safeloc.streams.steps import Cell
from safeloc.system import TransitionSystem, lower
from safeloc.trace import Trace
from safeloc.verdict import word

REMARK = "truth_mm"


def replayed(system: TransitionSystem, steps: Sequence[Mapping[str, Cell]]) -> Trace:
    """A simulated stream without its remark."""
    return run(system, [{name: value for name, value in step.items() if name != REMARK} for step in steps])


def labels(trace: Trace, output: str) -> list[str]:
    """An output that is a member of an enumeration, after every step."""
    unit = trace.system.outputs[output].unit  # type: ignore[union-attr]
    return [str(unit.members[one.outputs[output]]) for one in trace.steps]  # type: ignore[union-attr]


def mode_labels(machine: Machine, trace: Trace) -> list[str]:
    """The mode after every step."""
    return [machine.modes[one.state["mode"]].label for one in trace.steps]


def unproved_of(machine: Machine, properties: Sequence[Property]) -> dict[str, str]:
    """Properties and lemmas that are not proved without bound, with their verdict."""
    found = prove(lower(machine), properties, Limits(seconds=30), jobs=1)
    return {one.id: word(one.result) for one in found if word(one.result) != "proved"}
