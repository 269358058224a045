"""A recording of single records as the steps of a machine, by way of the border."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from safeloc.border import Channel, Fault
from safeloc.catalogue import Target
from safeloc.nodes import NumVar
from safeloc.streams.cycles import Cycle, cycles
from safeloc.streams.record_files import read_raw
from safeloc.streams.steps import StepStream
from safeloc.units import Enumeration


def recorded_steps(target: Target, path: Path, period_ms: int) -> tuple[StepStream, Sequence[Fault]]:
    """One step every `period_ms`, its number for its line, and every fault that the border found.

    StreamError for what is no recording, InputError for a leap of time.
    """
    made = list(cycles(read_raw(path), period_ms, channels=_ranges(target, period_ms)))
    steps = tuple(_step(target, cycle) for cycle in made)
    return StepStream(steps, tuple(cycle.number for cycle in made)), [fault for cycle in made for fault in cycle.faults]


def _ranges(target: Target, period_ms: int) -> list[Channel]:
    ranged = [var for var in target.system.inputs if isinstance(var, NumVar) and not isinstance(var.unit, Enumeration)]
    return [Channel(var.name, var.unit.name, var.low, var.high, period_ms) for var in ranged]


def _step(target: Target, cycle: Cycle) -> dict[str, int | str]:
    """What the machine reads, and the truth; a recording may hold channels of other machines as well."""
    known = {var.name for var in target.system.inputs}
    return {name: value for name, value in cycle.inputs.items() if name in known} | dict(cycle.remarks)


def counted(faults: Sequence[Fault]) -> dict[str, str]:
    """`channel: reason` -> how often, the most frequent first."""
    found = Counter(f"{fault.channel}: {fault.reason.value}" for fault in faults)
    return {what: str(number) for what, number in found.most_common()}
