"""Meanings of the inputs of a machine, from the records that set them: sign, reference point, and what absence says."""

from __future__ import annotations

import re
from collections.abc import Mapping

from safeloc.language.system import without_ghosts
from safeloc.runtime.streams.records import DistanceRecord, MarkerRecord, PulseRecord
from safeloc.target import Target

_ENDS = "(front|rear)"
_MEANT: Mapping[str, str | None] = {
    rf"{_ENDS}_marker": MarkerRecord.model_fields["marker"].description,
    rf"{_ENDS}_marker_position_mm": MarkerRecord.model_fields["position_mm"].description,
    rf"{_ENDS}_marker_accuracy_mm": MarkerRecord.model_fields["accuracy_mm"].description,
    rf"{_ENDS}_marker_since_mm": MarkerRecord.model_fields["since_mm"].description,
    rf"{_ENDS}_(?!marker_)\w+_mm": DistanceRecord.model_fields["distance_mm"].description,
    rf"{_ENDS}_\w+_pulses": PulseRecord.model_fields["pulses"].description,
}
"""Patterns of the names of inputs that records set, with the description of the record's field."""


def meanings_of_inputs(target: Target) -> dict[str, str]:
    """Return what the inputs that records of a kind set mean, by the inputs' names; of other inputs nothing is known here."""
    in_records = {other: name for name, other in target.input_of_record.items()}
    found = {var.name: _meant(in_records.get(var.name, var.name)) for var in without_ghosts(target.system).inputs}
    return {name: text for name, text in found.items() if text}


def _meant(name: str) -> str:
    """Return what the input of this name in records means; of a composition the part after the machine's name counts."""
    short = name.rpartition(".")[2]
    return next((text or "" for pattern, text in _MEANT.items() if re.fullmatch(pattern, short)), "")
