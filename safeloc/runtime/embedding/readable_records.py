"""The first check of a record: its channel and values, before time and order."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.errors import InputError
from safeloc.language.expr import NumVar, Var
from safeloc.language.interpret import admitted
from safeloc.language.nodes import Value
from safeloc.language.renamed import renamed
from safeloc.runtime.border import Fault, Reason
from safeloc.runtime.embedding.row_layout import Told
from safeloc.runtime.embedding.target_inputs import Hearing
from safeloc.runtime.streams.records import Record, TruthRecord, Unusable


def judged(heard: Hearing, number: int, record: Record | Unusable) -> Record | Unusable | Fault:
    """Return the record, or the fault that makes it unreadable.

    A record of an unknown channel is a Fault and leaves no trace in memory, so that no sender can make a controller grow. A
    record with a value that has no input (such as an accuracy) is refused completely: the rest of it could have another
    meaning.
    """
    if isinstance(record, TruthRecord):
        return record
    if isinstance(record, Unusable):
        known = record.channel in heard.channel_names or record.channel == "truth"
        return record if known else Fault(record.channel, Reason.UNKNOWN, record.detail, number)
    for name, value in record.inputs().items():
        named = heard.named.get(name)
        if named is None:
            return Fault(record.channel, Reason.UNKNOWN, f"no input {name}{renamed([name], heard.named)}", number)
        for entry in named:  # ranges of plain numbers are the cycle builder's matter
            refused = _refused(entry.var, value)
            if refused is not None:
                return Unusable(record.time_ms, record.channel, *refused)
    return record


def _refused(var: Var, value: object) -> tuple[Reason, str] | None:
    try:
        admitted(var, value)
    except InputError as error:
        return reason_for(var, value), str(error)
    return None


def reason_for(var: Var, value: object) -> Reason:
    """Return the reason why a variable cannot take the value: out of range, or of another type."""
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return Reason.NOT_FINITE
    is_number = isinstance(value, int) and not isinstance(value, bool)
    return Reason.OUT_OF_RANGE if is_number and isinstance(var, NumVar) else Reason.WRONG_TYPE


def stated(heard: Hearing, inputs: Mapping[str, object]) -> tuple[Told, list[Fault]]:
    """Return inputs by their places, and a fault for each value that its input cannot hold. Names are known ones."""
    told: dict[int, Value] = {}
    faults: list[Fault] = []
    entries = heard.entries
    for name, value in inputs.items():
        var, at, _, kind, low, high, members = entries[name]
        if type(value) is kind and low <= value <= high:  # type: ignore[operator] # an int or a bool
            told[at] = value  # type: ignore[assignment]
        elif type(value) is str and value in members:
            told[at] = members[value]
        elif value is not None:
            try:
                told[at] = admitted(var, value)
            except InputError as error:
                faults.append(Fault(name, reason_for(var, value), str(error)))
    return told, faults
