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

    Names, ranges and silence are those of a Controller (docs/embedding.md); beside that a recording may hold ghosts of
    the machine, as values. StreamError for what is no recording, InputError for a leap of time.
    """
    hearing, ghosts = TargetInputs(target), _ghosts(target, period_ms)
    said = [_known(hearing, ghosts, number, record) for number, record in enumerate(read_raw(path))]
    channels = [*hearing.channels, *ghosts.values()]
    made = list(cycles(said, period_ms, channels=channels, places=lambda name: _places(hearing, ghosts, name)))
    heard = [_heard(hearing, ghosts, cycle) for cycle in made]
    faults = [fault for cycle, (_, unheard) in zip(made, heard, strict=True) for fault in (*cycle.faults, *unheard)]
    return StepStream(tuple(step for step, _ in heard), tuple(cycle.number for cycle in made)), faults


def recorded_times(target: Target, path: Path) -> Iterator[tuple[str, int]]:
    """Yield source and time of each measurement of a recording of single records, in the order of arrival.

    What no machine of the target hears, what cannot be read, and the truth are of no source.
    """
    hearing = TargetInputs(target)
    for number, record in enumerate(read_raw(path)):
        known = readable(hearing, number, record)
        if not isinstance(known, (Fault, Unusable, TruthRecord)):
            yield known.channel, known.time_ms


Ghosts = Mapping[str, Channel]


def _ghosts(target: Target, period_ms: int) -> Ghosts:
    """Return the ghosts that a recording may contain besides the machine's inputs, by name."""
    numbers = [var for var in target.system.inputs if var in target.system.ghosts and isinstance(var, NumVar)]
    plain = [var for var in numbers if not isinstance(var.unit, Enumeration)]
    return {var.name: Channel(var.name, var.unit.name, var.low, var.high, period_ms) for var in plain}


def _places(hearing: TargetInputs, ghosts: Ghosts, name: str) -> Iterable[object]:
    """The inputs that a name means; a ghost has one name only."""
    return (name,) if name in ghosts else hearing.places(name)


def _known(hearing: TargetInputs, ghosts: Ghosts, number: int, record: Record | Unusable) -> Record | Unusable:
    """Return the record, or a fault if no machine has an input for it."""
    if record.channel in ghosts:
        return record
    found = readable(hearing, number, record)
    return Unusable(record.time_ms, found.channel, found.reason, found.detail) if isinstance(found, Fault) else found


def _heard(hearing: TargetInputs, ghosts: Ghosts, cycle: Cycle) -> tuple[dict[str, Value], tuple[Fault, ...]]:
    """The step: what the machines hear by the full names of their inputs, the ghosts, and the truth; and what they do not.

    A machine that may be told nothing, and was told nothing or not enough, has the neutral values of a silent device.
    """
    own = {name: value for name, value in cycle.inputs.items() if name not in ghosts}
    told, unheard = hearing.complete(hearing.placed(own))
    row, inputs = hearing.row(told), hearing.system.inputs
    silent = [at for _, needed in hearing.silent.values() for at in needed if at not in told]
    step = {inputs[at].name: row[at] for at in (*silent, *told)}
    said = {name: value for name, value in cycle.inputs.items() if name in ghosts and isinstance(value, int)}
    return {**step, **said, **cycle.remarks}, unheard


def counted(faults: Sequence[Fault]) -> dict[str, str]:
    """`channel: reason` -> how often, the most frequent first."""
    found = Counter(f"{fault.channel}: {fault.reason.value}" for fault in faults)
    return {what: str(number) for what, number in found.most_common()}
