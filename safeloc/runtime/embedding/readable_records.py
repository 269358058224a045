"""The first check of a record: channel and values. Time and order are checked later, by the cycle builder."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.errors import InputError
from safeloc.language.expr import NumVar, Var
from safeloc.language.interpret import admitted
from safeloc.language.nodes import Value
from safeloc.language.renamed import renamed
from safeloc.runtime.border import Fault, Reason
from safeloc.runtime.embedding.row_layout import Placed
from safeloc.runtime.embedding.target_inputs import TargetInputs
from safeloc.runtime.streams.records import Record, TruthRecord, Unusable


def readable(target: TargetInputs, number: int, record: Record | Unusable) -> Record | Unusable | Fault:
    """Return the record, or the fault that makes it unreadable.

    A record of an unknown channel is a Fault and is not remembered, so that no sender can fill the memory. A record with a
    value for which the machine has no input (such as an accuracy) is refused as a whole: without that value the rest could
    have another meaning.
    """
    if isinstance(record, TruthRecord):
        return record
    if isinstance(record, Unusable):
        known = record.channel in target.channel_names or record.channel == "truth"
        return record if known else Fault(record.channel, Reason.UNKNOWN, record.detail, number)
    for name, value in record.inputs().items():
        named = target.named.get(name)
        if named is None:
            return Fault(record.channel, Reason.UNKNOWN, f"no input {name}{renamed([name], target.named)}", number)
        for entry in named:  # the cycle builder checks the ranges of plain numbers
            refused = _refused(entry.var, value)
            if refused is not None:
                return Unusable(record.time_ms, record.channel, *refused)
    return record


def _refused(var: Var, value: object) -> tuple[Reason, str] | None:
    try:
        admitted(var, value)
    except InputError as error:
        return _reason_for(var, value), str(error)
    return None


def _reason_for(var: Var, value: object) -> Reason:
    """Return the reason why a variable cannot take a value: not finite, out of range, or of a wrong type."""
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return Reason.NOT_FINITE
    is_number = isinstance(value, int) and not isinstance(value, bool)
    return Reason.OUT_OF_RANGE if is_number and isinstance(var, NumVar) else Reason.WRONG_TYPE


def checked_inputs(target: TargetInputs, inputs: Mapping[str, object]) -> tuple[Placed, list[Fault]]:
    """Return the values of known inputs by place, and a fault for each value that its input cannot take."""
    placed: dict[int, Value] = {}
    faults: list[Fault] = []
    entries = target.entries
    for name, value in inputs.items():
        var, at, _, kind, low, high, members = entries[name]
        if type(value) is kind and low <= value <= high:  # type: ignore[operator] # an int or a bool
            placed[at] = value  # type: ignore[assignment]
        elif type(value) is str and value in members:
            placed[at] = members[value]
        elif value is not None:
            try:
                placed[at] = admitted(var, value)
            except InputError as error:
                faults.append(Fault(name, _reason_for(var, value), str(error)))
    return placed, faults
