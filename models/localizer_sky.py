"""What a satellite front end hands over along a journey: channels against their prediction, and a solution along the track."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from safeloc.models.satellite_selection import SelectionConfig
from safeloc.streams.steps import Cell

PROTECTION_MM, SPEED_PROTECTION_UM_S, SHARE = 8_000, 300_000, 0.6
"""Bounds of a solution, and how much of them its error uses up."""
UNKNOWNS, LEAST = 2, 3
"""Place and clock; one more satellite shows a fault."""
ELEVATION, UM_PER_MM = pi / 6, 1_000


@dataclass(frozen=True)
class Off:
    """What a channel's signal is off the prediction, noise apart."""

    range_mm: int = 0
    speed_mm_s: int = 0


def directions(channels: int) -> list[tuple[float, float]]:
    """Of each channel's satellite, along the track and across it: all round, 30 degrees high, none right ahead."""
    turns = [2 * pi * (number + 0.5) / channels for number in range(channels)]
    return [(cos(ELEVATION) * cos(turn), cos(ELEVATION) * sin(turn)) for turn in turns]


def signals(
    config: SelectionConfig, rng: np.random.Generator, seen: int, heard: int, off: Sequence[Off]
) -> dict[str, Cell]:
    """What each channel measured, less what was predicted."""
    step: dict[str, Cell] = {"selection.clock_mm": 0, "selection.clock_mm_s": 0}
    for number, one in enumerate(off, 1):
        name = f"selection.channel_{number}"
        away = int(rng.normal(0, config.range_noise_mm / 4)) + one.range_mm
        faster = int(rng.normal(0, config.speed_noise_mm_s / 4)) + one.speed_mm_s
        step |= {
            f"{name}_error_mm": 0, f"{name}_speed_error_mm_s": 0, f"{name}_prediction_mm": 0,
            f"{name}_prediction_mm_s": 0, f"{name}_ephemeris_valid": True,
        }  # fmt: skip
        if heard and number <= seen:
            step |= {
                f"{name}_satellite": number, f"{name}_range_off_mm": away, f"{name}_speed_off_mm_s": faster,
                f"{name}_error_mm": away, f"{name}_speed_error_mm_s": faster,
            }  # fmt: skip
        if heard >= config.warm_up_cycles and number <= seen:
            spread = config.range_covariance_mm2 // 4, config.speed_covariance_mm2_s2 // 4
            step |= {f"{name}_range_covariance_mm2": spread[0], f"{name}_speed_covariance_mm2_s2": spread[1]}
    return step


def solution(
    config: SelectionConfig,
    rng: np.random.Generator,
    seen: int,
    heard: int,
    off: Sequence[Off],
    place_mm: int,
    speed_um_s: int,
) -> dict[str, Cell]:
    """Place and speed along the track from the usable ones, drawn by what those are off; none before they are warm."""
    used = [
        heard >= config.warm_up_cycles and number <= seen and _near(config, one) for number, one in enumerate(off, 1)
    ]
    step: dict[str, Cell] = {f"position.used_{number}": one for number, one in enumerate(used, 1)}
    solved = sum(used) >= LEAST
    step |= {
        "position.fix_protection_mm": PROTECTION_MM, "position.fix_speed_um_s": 0, "position.fix_unknowns": UNKNOWNS,
        "position.fix_speed_protection_um_s": SPEED_PROTECTION_UM_S,
        "position.fix_missing": "NOTHING" if solved else "FEW_LEFT" if any(used) else "NO_EPOCH",
        "position.reference_speed_accuracy_um_s": 0, "position.odometry_error_mm": 0,
    }  # fmt: skip
    if not solved:
        return step
    drawn = drawn_along(used, [one.range_mm for one in off])
    faster = drawn_along(used, [one.speed_mm_s for one in off]) * UM_PER_MM
    place = place_mm + drawn + int(rng.uniform(-SHARE, SHARE) * PROTECTION_MM)
    speed = speed_um_s + faster + int(rng.uniform(-SHARE, SHARE) * SPEED_PROTECTION_UM_S)
    return step | {"position.fix_mm": place, "position.fix_speed_um_s": speed}


def _near(config: SelectionConfig, off: Off) -> bool:
    """The selection does not exclude it."""
    return abs(off.range_mm) < config.range_threshold_mm and abs(off.speed_mm_s) < config.speed_threshold_mm_s


def drawn_along(used: Sequence[bool], off: Sequence[int]) -> int:
    """By how much least squares, over place along the track and clock, put the place further for what signals are off."""
    rows = [(along, one) for (along, _), one, taken in zip(directions(len(off)), off, used, strict=True) if taken]
    middle = sum(along for along, _ in rows) / len(rows)
    spread = sum((along - middle) ** 2 for along, _ in rows)
    return round(-sum((along - middle) * one for along, one in rows) / spread)
