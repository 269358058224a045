"""One end of a train, cycle by cycle, as inputs of the fibre machine's step (models/fibre/)."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.sensing.fibre.features import Bounds, End

StepValues = dict[str, int]


def step_inputs(now: End | None, before: End | None, point_path_mm: Mapping[str, int]) -> StepValues:
    """Return inputs by name; what is not known is absent. `before`: the same end of the same track a cycle ago.

    amplitude_cdb         over normal
    run_mm                along the track since the cycle before: what is common to both, index and map, nearly cancels
    flight_position_mm    middle of the bounds along the track
    reflecting_point_mm   place of the one reflecting point that coincides; two at once are none
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
