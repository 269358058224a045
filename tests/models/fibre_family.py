"""What the tests of the fibre, verification, axle-counter and emitter machines share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import Trace
from safeloc.runtime.streams.steps import Cell

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
