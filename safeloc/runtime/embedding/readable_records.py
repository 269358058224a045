"""Which records can be read at all: the first judgement, before time and order are looked at."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.errors import InputError
from safeloc.language.expr import NumVar, Var
from safeloc.language.interpret import admitted
from safeloc.language.nodes import Value
from safeloc.runtime.border import Fault, Reason
from safeloc.runtime.embedding.row_layout import Told
from safeloc.runtime.embedding.target_inputs import Hearing
from safeloc.runtime.streams.records import Record, TruthRecord, Unusable


def judged(heard: Hearing, number: int, record: Record | Unusable) -> Record | Unusable | Fault:
    """The record, or why it cannot be read.

    A channel that the machine does not have is a Fault at once: nothing of it is remembered, so that no sender can
    make a controller grow. A record that says something the machine has no input for (such as an accuracy) is refused
    whole: what is left of it could mean something else.
    """
    if isinstance(record, TruthRecord):
        return record
    if isinstance(record, Unusable):
        known = record.channel in heard.channel_names or record.channel == "truth"
        return record if known else Fault(record.channel, Reason.UNKNOWN, record.detail, number)
    for name, value in record.inputs().items():
        named = heard.named.get(name)
        if named is None:
            return Fault(record.channel, Reason.UNKNOWN, f"no input {name}", number)
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
    """Why a variable does not hold the value: the number is out of range, or it is no such thing."""
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return Reason.NOT_FINITE
    is_number = isinstance(value, int) and not isinstance(value, bool)
    return Reason.OUT_OF_RANGE if is_number and isinstance(var, NumVar) else Reason.WRONG_TYPE


def stated(heard: Hearing, inputs: Mapping[str, object]) -> tuple[Told, list[Fault]]:
    """Inputs by their places, and a fault for each value that its input cannot hold. Names are known ones."""
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
