"""Output of a satellite front end along a journey: channels against their prediction, and a solution along the track."""

from __future__ import annotations

import numpy as np

from safeloc.models.satellite_selection import SelectionConfig
from safeloc.runtime.streams.steps import Cell

DILUTION_PERMILLE, FURTHER_MM, SPEED_FURTHER_UM_S = 1_500, 500, 5_000
"""Figures of a solution along the track, as in the simulated skies: errors of 1 m in each signal move it by 1.5 m at most."""
ERROR_MM, SPEED_ERROR_UM_S = 4_800, 180_000
"""Greatest errors of a solution's place and speed."""
_MULTIPATH_MM = 60_000
"""Excess length of a signal that comes by a detour."""


def signals(config: SelectionConfig, rng: np.random.Generator, seen: int, received: int, far: bool) -> dict[str, Cell]:
    """Return each channel's measured value less the predicted one; with `far`, the first signal comes by a detour."""
    step: dict[str, Cell] = {"selection.clock_mm": 0, "selection.clock_mm_s": 0}
    for number in range(1, config.channels + 1):
        name = f"selection.channel_{number}"
        away = int(rng.normal(0, config.range_noise_mm / 4)) + (_MULTIPATH_MM if far and number == 1 else 0)
        faster = int(rng.normal(0, config.speed_noise_mm_s / 4))
        step |= {
            f"{name}_error_mm": 0, f"{name}_speed_error_mm_s": 0, f"{name}_prediction_mm": 0,
            f"{name}_prediction_mm_s": 0, f"{name}_ephemeris_valid": True,
        }  # fmt: skip
        if received and number <= seen:
            step |= {
                f"{name}_satellite": number, f"{name}_range_off_mm": away, f"{name}_speed_off_mm_s": faster,
                f"{name}_error_mm": away, f"{name}_speed_error_mm_s": faster,
            }  # fmt: skip
        if received >= config.warm_up_cycles and number <= seen:
            spread = config.range_covariance_mm2 // 4, config.speed_covariance_mm2_s2 // 4
            step |= {f"{name}_range_covariance_mm2": spread[0], f"{name}_speed_covariance_mm2_s2": spread[1]}
    return step


def solution(
    config: SelectionConfig,
    rng: np.random.Generator,
    seen: int,
    received: int,
    far: bool,
    place_mm: int,
    speed_um_s: int,
    missing: str,
) -> dict[str, Cell]:
    """Return place and speed along the track from the usable signals; before the warm-up ends none, with `missing` as the reason."""
    solved = received >= config.warm_up_cycles
    step: dict[str, Cell] = {
        f"position.used_{number}": solved and number <= seen and not (far and number == 1)
        for number in range(1, config.channels + 1)
    }
    step |= {
        "position.fix_dilution_permille": DILUTION_PERMILLE, "position.fix_further_mm": FURTHER_MM,
        "position.fix_speed_um_s": 0, "position.fix_speed_dilution_permille": DILUTION_PERMILLE,
        "position.fix_speed_further_um_s": SPEED_FURTHER_UM_S, "position.fix_unknowns": 2,
        "position.fix_missing": "NOTHING" if solved else missing,
        "position.reference_speed_accuracy_um_s": 0, "position.odometry_error_mm": 0,
    }  # fmt: skip
    if not solved:
        return step
    place = place_mm + int(rng.uniform(-ERROR_MM, ERROR_MM))
    speed = speed_um_s + int(rng.uniform(-SPEED_ERROR_UM_S, SPEED_ERROR_UM_S))
    return step | {"position.fix_mm": place, "position.fix_speed_um_s": speed}
