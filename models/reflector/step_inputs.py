"""Completes the inputs of a step in which echo slots or the map's next reflector are empty.

A signal front end sends only the echoes that it has, and a map only a reflector that exists. The machine reads the other
figures of a slot only if its range is present, and those of the next reflector only if its position is.
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.models.reflector.echo import INTENSITY_FLOOR_CDB
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.runtime.streams.steps import Cell

_EMPTY_SLOT: Mapping[str, Cell] = {
    "error_mm": 0,
    "model": NO_MODEL.label,
    "intensity_cdb": INTENSITY_FLOOR_CDB,
    "lateral_mm": 0,
}
_NO_NEXT: Mapping[str, Cell] = {
    "next_model": NO_MODEL.label,
    "next_view_from_mm": 0,
    "next_view_to_mm": 0,
    "next_clear_mm": 0,
}


def completed(config: ReflectorConfig, given: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return the inputs; missing ones mean an empty slot, no next reflector, no frame, and no contradiction.

    The inputs of a slot with a range stay as they are: the machine refuses a range without its error.
    """
    inputs: dict[str, Cell] = {"frame_present": False, "route_contradicted": False}
    for number in range(1, config.echo_slots + 1):
        if f"echo_{number}_range_mm" not in given:
            inputs |= {f"echo_{number}_{name}": value for name, value in _EMPTY_SLOT.items()}
    if "next_position_mm" not in given:
        inputs |= _NO_NEXT
    return {**inputs, **given}
