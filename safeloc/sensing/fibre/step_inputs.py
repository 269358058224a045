"""Converts one end of a train to the inputs of the fibre machine's step (models/fibre/)."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.sensing.fibre.features import Bounds, End

StepValues = dict[str, int]


def step_inputs(now: End | None, before: End | None, point_path_mm: Mapping[str, int]) -> StepValues:
    """Return inputs by name; unknown ones are absent. `before` is the same end of the same track one cycle earlier.

    amplitude_cdb         amplitude over its normal level
    run_mm                run along the track since the previous cycle: errors of index and map nearly cancel
    flight_position_mm    middle of the bounds along the track
    reflecting_point_mm   place of the only coincident reflecting point; absent if there are two
    """
    if now is None:
        return {}
    made = {"flight_position_mm": _middle(now.path_mm)}
    if before is not None:
        made["run_mm"] = _middle(now.path_mm) - _middle(before.path_mm)
    if now.amplitude_cdb is not None:
        made["amplitude_cdb"] = now.amplitude_cdb
    if len(now.points) == 1:
        made["reflecting_point_mm"] = point_path_mm[now.points[0]]
    return made


def _middle(bounds: Bounds) -> int:
    return (bounds.low + bounds.high) // 2
