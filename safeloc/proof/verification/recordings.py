"""Converts a recording of single records to steps of a machine, as a controller on board does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.language.expr import NumVar
from safeloc.language.nodes import Value
from safeloc.language.renamed import hint
from safeloc.language.units import Enumeration
from safeloc.runtime.border import Channel, Fault, Reason
from safeloc.runtime.embedding.readable_records import readable
from safeloc.runtime.embedding.row_layout import Placed
from safeloc.runtime.embedding.target_inputs import TargetInputs
from safeloc.runtime.streams.cycles import Cycle, cycles
from safeloc.runtime.streams.record_files import read_raw
from safeloc.runtime.streams.records import Record, TruthRecord, Unusable
from safeloc.runtime.streams.steps import StepStream
from safeloc.target import Target


def recorded_steps(target: Target, path: Path, period_ms: int) -> tuple[StepStream, Sequence[Fault]]:
    """Return one step every `period_ms`, with its number as its line, and every fault found by the border.

    Names, ranges and silent machines are treated as by a Controller (docs/embedding.md). In addition a recording may
    contain values of ghosts. StreamError for a file that is no recording, for one without a record for this machine, and for a cycle
    without a value that the machine needs; InputError for a leap of time.
    """
    known_inputs, ghosts = TargetInputs(target), _ghosts(target, period_ms)
    records = [_known(known_inputs, ghosts, number, record) for number, record in enumerate(read_raw(path))]
    channels = [*known_inputs.channels, *ghosts.values()]
    made = list(cycles(records, period_ms, channels=channels, places=lambda name: _places(known_inputs, ghosts, name)))
    _require_some(path, known_inputs, made)
    steps = [_step_of(path, known_inputs, ghosts, cycle) for cycle in made]
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


def _require_some(path: Path, known_inputs: TargetInputs, made: Sequence[Cycle]) -> None:
    """Refuse a recording of which every record is for another machine: nothing of it would be replayed."""
    faults = [fault for cycle in made for fault in cycle.faults]
    if faults and all(one.reason is Reason.UNKNOWN for one in faults) and not any(cycle.inputs for cycle in made):
        first = faults[0].channel
        raise StreamError(
            f"{path}: none of its {len(faults)} records is for {known_inputs.name}; the first is of {first!r}, and "
            f"{known_inputs.name} takes {', '.join(known_inputs.routes)}.{hint(first, known_inputs.routes)}"
        )


def _require_complete(path: Path, known_inputs: TargetInputs, cycle: Cycle, taken: Placed) -> None:
    """Refuse a cycle without a value that the machine needs; a record of it that was refused is told with the reason."""
    lacking = known_inputs.missing(taken)
    if not lacking:
        return
    at = known_inputs.entries[lacking[0]].at
    refused = [
        f" Record {fault.number + 1} was refused: {': '.join(filter(None, [fault.reason.value, fault.detail.rstrip('.')]))}."
        for fault in cycle.rejected
        if fault.number is not None and any(entry.at == at for entry in known_inputs.routes.get(fault.channel, ()))
    ]
    raise StreamError(
        f"{path}: in the cycle that ends at {cycle.end_ms} ms, input {lacking[0]!r} has no value; {known_inputs.name} needs one in each "
        f"cycle.{''.join(refused[:1])}"
    )


def _step_of(
    path: Path, known_inputs: TargetInputs, ghosts: Ghosts, cycle: Cycle
) -> tuple[dict[str, Value], tuple[Fault, ...]]:
    """Return the step (inputs by full name, ghosts, and remarks), and the faults of values that no machine takes.

    A machine that may be silent, and got no value or too few, has the neutral values of a silent device.
    """
    on_board = {name: value for name, value in cycle.inputs.items() if name not in ghosts}
    taken, untaken = known_inputs.complete(known_inputs.placed(on_board))
    _require_complete(path, known_inputs, cycle, taken)
    row, inputs = known_inputs.row(taken), known_inputs.system.inputs
    silent = [at for _, needed in known_inputs.silent.values() for at in needed if at not in taken]
    step = {inputs[at].name: row[at] for at in (*silent, *taken)}
    truth = {name: value for name, value in cycle.inputs.items() if name in ghosts and isinstance(value, int)}
    return {**step, **truth, **cycle.remarks}, untaken


def counted(faults: Sequence[Fault]) -> dict[str, str]:
    """Return how often each `channel: reason` occurred, the most frequent first."""
    found = Counter(f"{fault.channel}: {fault.reason.value}" for fault in faults)
    return {what: str(number) for what, number in found.most_common()}
