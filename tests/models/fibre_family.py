"""What the tests of the fibre, verification, axle-counter and emitter machines share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.trace import Trace
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.runtime.streams.steps import Cell, read_steps

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


def recordings_of(name: str) -> list[Recording]:
    """The recordings that ship with a machine: the cases that occur in them need no search."""
    return [Recording(stream.first, stream.steps) for stream in map(read_steps, load_target(name).streams)]


def unproved_of(machine: Machine, properties: Sequence[Property]) -> dict[str, str]:
    """Properties and lemmas of a shipped machine that are not proved without bound, with their verdict."""
    recordings = recordings_of(machine.name)
    found = prove(lower(machine), properties, Limits(seconds=30), jobs=1, recordings=recordings)
    return {one.id: word(one.result) for one in found if word(one.result) != "proved"}
