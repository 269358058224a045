"""Output of the satellite front ends of many vehicles: channels against their prediction, and a solution along the track."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.models.localizer.simulation.columns import Column
from safeloc.models.satellite.variables import MISSING
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.simulation.many_runs import Array

DILUTION_PERMILLE, FURTHER_MM, SPEED_FURTHER_UM_S = 1_500, 500, 5_000
"""Figures of a solution along the track, as in the simulated skies: errors of 1 m in each signal move it by 1.5 m at most."""
ERROR_MM, SPEED_ERROR_UM_S = 4_800, 180_000
"""Greatest errors of a solution's place and speed."""
_ALMANAC_S, _ELEVATION_MRAD = 86_400, 500
"""An almanac of the day before, and the elevation of every satellite, which it has right."""
_MULTIPATH_MM = 60_000
"""Excess length of a signal that comes by a detour."""
_LABELS = tuple(one.label for one in MISSING)
NO_EPOCH, TWO_PORTIONS = _LABELS.index("NO_EPOCH"), _LABELS.index("TWO_PORTIONS")


@dataclass(frozen=True, eq=False)
class Sky:
    """The conditions that the receivers meet: arrays [cycle, vehicle], or ones that spread to it.

    seen      satellites in view of each vehicle
    received  cycles in a row with signals
    far       the first signal comes by a detour
    missing   why there is no solution before the warm-up ends, as a number of `MISSING`
    """

    seen: NDArray[np.int64]
    received: NDArray[np.int64]
    far: NDArray[np.bool_]
    missing: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Noise:
    """Errors of receivers as shares: of each signal's range and speed, of the solution's place and speed; [..., cycle, vehicle]."""

    signals: NDArray[np.float32]
    solution: NDArray[np.float64]


def noise(
    config: SelectionConfig,
    sky: Sky,
    of_signals: Sequence[np.random.Generator],
    of_solutions: Sequence[np.random.Generator],
) -> Noise:
    """Draw the errors of receivers, for the signals in view and the cycles with signals; elsewhere they are 0."""
    cycles, vehicles = sky.received.shape
    signals = np.zeros((vehicles, 2 * config.channels, cycles), dtype=np.float32)
    solution = np.zeros((vehicles, 2, cycles))
    for vehicle, (rng, other) in enumerate(zip(of_signals, of_solutions, strict=True)):
        heard = np.flatnonzero(sky.received[:, vehicle])
        if len(heard):
            used = 2 * min(config.channels, int(sky.seen[vehicle]))
            signals[vehicle][:used, heard] = rng.standard_normal((used, len(heard)), dtype=np.float32)
            solution[vehicle][:, heard] = other.random((2, len(heard)))
    return Noise(signals.transpose(1, 2, 0), solution.transpose(1, 2, 0))


def signals(config: SelectionConfig, sky: Sky, drawn: Noise) -> dict[str, Column]:
    """Return each channel's measured value less the predicted one; where `far`, the first signal comes by a detour."""
    columns = {"selection.clock_mm": Column(0), "selection.clock_mm_s": Column(0)}
    columns["selection.almanac_age_s"] = Column(_ALMANAC_S)
    for number in range(1, config.channels + 1):
        columns |= {
            f"selection.channel_{number}_{name}": one for name, one in _channel(config, sky, drawn, number).items()
        }
    return columns


def _channel(config: SelectionConfig, sky: Sky, drawn: Noise, number: int) -> dict[str, Column]:
    """Return the inputs of one channel; one that no vehicle has a satellite in is constant."""
    away: Array | int = 0
    faster: Array | int = 0
    heard = spread = np.zeros((1, 1), dtype=np.bool_)
    if number <= sky.seen.max(initial=0) and sky.received.any():
        off, more = drawn.signals[2 * number - 2], drawn.signals[2 * number - 1]
        heard = (sky.received > 0) & (number <= sky.seen)
        spread = (sky.received >= config.warm_up_cycles) & (number <= sky.seen)
        away = (config.range_noise_mm / 4 * off).astype(np.int64) + (_MULTIPATH_MM * sky.far if number == 1 else 0)
        faster = (config.speed_noise_mm_s / 4 * more).astype(np.int64)
    return {
        "error_mm": Column(np.where(heard, away, 0)),
        "speed_error_mm_s": Column(np.where(heard, faster, 0)),
        "prediction_mm": Column(0),
        "prediction_mm_s": Column(0),
        "elevation_mrad": Column(_ELEVATION_MRAD),
        "almanac_mrad": Column(_ELEVATION_MRAD, heard),
        "ephemeris_valid": Column(True),
        "satellite": Column(number, heard),
        "range_off_mm": Column(away, heard),
        "speed_off_mm_s": Column(faster, heard),
        "range_covariance_mm2": Column(config.range_covariance_mm2 // 4, spread),
        "speed_covariance_mm2_s2": Column(config.speed_covariance_mm2_s2 // 4, spread),
    }


def solution(
    config: SelectionConfig, sky: Sky, drawn: Noise, place_mm: NDArray[np.int64], speed_um_s: NDArray[np.int64]
) -> dict[str, Column]:
    """Return place and speed along the track from the usable signals; before the warm-up ends none, with the reason."""
    solved = sky.received >= config.warm_up_cycles
    clear = {1: ~sky.far}
    columns = {
        f"position.used_{number}": Column(solved & (number <= sky.seen) & clear.get(number, True))
        for number in range(1, config.channels + 1)
    }
    off_mm, faster_um_s = (
        (-most + 2 * most * share).astype(np.int64)
        for most, share in zip((float(ERROR_MM), float(SPEED_ERROR_UM_S)), drawn.solution, strict=True)
    )
    return columns | {
        "position.fix_dilution_permille": Column(DILUTION_PERMILLE),
        "position.fix_further_mm": Column(FURTHER_MM),
        "position.fix_speed_um_s": Column(np.where(solved, speed_um_s + faster_um_s, 0)),
        "position.fix_speed_dilution_permille": Column(DILUTION_PERMILLE),
        "position.fix_speed_further_um_s": Column(SPEED_FURTHER_UM_S),
        "position.fix_unknowns": Column(2),
        "position.fix_missing": Column(np.where(solved, 0, sky.missing)),
        "position.reference_speed_accuracy_um_s": Column(0),
        "position.odometry_error_mm": Column(0),
        "position.fix_mm": Column(place_mm + off_mm, solved),
    }
