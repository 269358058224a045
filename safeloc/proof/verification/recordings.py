"""Converts a recording of single records to steps of a machine, as a controller on board does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from safeloc.language.expr import NumVar
from safeloc.language.nodes import Value
from safeloc.language.units import Enumeration
from safeloc.runtime.border import Channel, Fault
from safeloc.runtime.embedding.readable_records import readable
from safeloc.runtime.embedding.target_inputs import TargetInputs
from safeloc.runtime.streams.cycles import Cycle, cycles
from safeloc.runtime.streams.record_files import read_raw
from safeloc.runtime.streams.records import Record, TruthRecord, Unusable
from safeloc.runtime.streams.steps import StepStream
from safeloc.target import Target


def recorded_steps(target: Target, path: Path, period_ms: int) -> tuple[StepStream, Sequence[Fault]]:
    """Return one step every `period_ms`, with its number as its line, and every fault found by the border.

    Names, ranges and silent machines are treated as by a Controller (docs/embedding.md). In addition a recording may
    contain values of ghosts. StreamError for a file that is no recording, InputError for a leap of time.
    """
    known_inputs, ghosts = TargetInputs(target), _ghosts(target, period_ms)
    records = [_known(known_inputs, ghosts, number, record) for number, record in enumerate(read_raw(path))]
    channels = [*known_inputs.channels, *ghosts.values()]
    made = list(cycles(records, period_ms, channels=channels, places=lambda name: _places(known_inputs, ghosts, name)))
    steps = [_step_of(known_inputs, ghosts, cycle) for cycle in made]
    faults = [fault for cycle, (_, untaken) in zip(made, steps, strict=True) for fault in (*cycle.faults, *untaken)]
    return StepStream(tuple(step for step, _ in steps), tuple(cycle.number for cycle in made)), faults


def recorded_times(target: Target, path: Path) -> Iterator[tuple[str, int]]:
    """Yield source and time of each measurement of a recording of single records, in the order of arrival.

    Records for which the target has no input, unreadable records and the truth are left out.
    """
    known_inputs = TargetInputs(target)
    for number, record in enumerate(read_raw(path)):
        known = readable(known_inputs, number, record)
        if not isinstance(known, (Fault, Unusable, TruthRecord)):
            yield known.channel, known.time_ms


Ghosts = Mapping[str, Channel]


def _ghosts(target: Target, period_ms: int) -> Ghosts:
    """Return the ghosts that a recording may contain besides the machine's inputs, by name."""
    numbers = [var for var in target.system.inputs if var in target.system.ghosts and isinstance(var, NumVar)]
    plain = [var for var in numbers if not isinstance(var.unit, Enumeration)]
    return {var.name: Channel(var.name, var.unit.name, var.low, var.high, period_ms) for var in plain}


def _places(known_inputs: TargetInputs, ghosts: Ghosts, name: str) -> Iterable[object]:
    """Return the inputs that a name stands for; a ghost has one name only."""
    return (name,) if name in ghosts else known_inputs.places(name)


def _known(known_inputs: TargetInputs, ghosts: Ghosts, number: int, record: Record | Unusable) -> Record | Unusable:
    """Return the record, or a fault if no machine has an input for it."""
    if record.channel in ghosts:
        return record
    found = readable(known_inputs, number, record)
    return Unusable(record.time_ms, found.channel, found.reason, found.detail) if isinstance(found, Fault) else found


def _step_of(known_inputs: TargetInputs, ghosts: Ghosts, cycle: Cycle) -> tuple[dict[str, Value], tuple[Fault, ...]]:
    """Return the step (inputs by full name, ghosts, and remarks), and the faults of values that no machine takes.

    A machine that may be silent, and got no value or too few, has the neutral values of a silent device.
    """
    on_board = {name: value for name, value in cycle.inputs.items() if name not in ghosts}
    taken, untaken = known_inputs.complete(known_inputs.placed(on_board))
    row, inputs = known_inputs.row(taken), known_inputs.system.inputs
    silent = [at for _, needed in known_inputs.silent.values() for at in needed if at not in taken]
    step = {inputs[at].name: row[at] for at in (*silent, *taken)}
    truth = {name: value for name, value in cycle.inputs.items() if name in ghosts and isinstance(value, int)}
    return {**step, **truth, **cycle.remarks}, untaken


def counted(faults: Sequence[Fault]) -> dict[str, str]:
    """Return how often each `channel: reason` occurred, the most frequent first."""
    found = Counter(f"{fault.channel}: {fault.reason.value}" for fault in faults)
    return {what: str(number) for what, number in found.most_common()}
