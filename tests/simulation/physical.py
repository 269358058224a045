"""Wheel pulses and Doppler radar from how they work, each with the error law that follows from its figures.

Wheel   the wheel is thicker or thinner than assumed: an error in proportion to distance; pulses are counted whole, and
        converted to whole mm: a one-off error that does not add up.
Radar   speed with an error in proportion, and noise of its own in every cycle; silent below a speed, and now and then.

The figures of the error are exact for the wheel (whole nanometres); the radar's noise is cut where the law ends.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from safeloc.config import Config, quantity
from safeloc.errors import InputError
from safeloc.language.units import NM_PER_MM
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import Distances

MILLION = 1_000_000


class WheelConfig(Config):
    """A pulse generator on an axle."""

    diameter_error_ppm: int = quantity(
        5_000, "ppm", -200_000, 200_000, "[S, low authority] tacho 0.5 %; worn 850 to 780 mm: 8.2 %"
    )
    pulse_um: int = quantity(13_400, "um of rail", 100, 1_000_000, "[S] 100 pulses a turn: 13.4 mm")


class RadarConfig(Config):
    """A Doppler radar that looks at the track bed."""

    scale_error_ppm: int = quantity(5_000, "ppm", -100_000, 100_000, "[S, low authority] 0.1 to 0.5 %")
    noise_mm_s: int = quantity(131, "mm/s", 5, 10_000, "[S] Reissland 2023: peak 0.47 km/h up to 130 km/h")
    cut_off_mm_s: int = quantity(1_000, "mm/s", 0, 10_000, "[M] no valid output below 2 to 5 km/h")
    dropout_ppm: int = quantity(10_000, "ppm of cycles", 0, 1_000_000, "[M] snow or a film of water")


def wheel_law(wheel: WheelConfig) -> ErrorLaw:
    """Return the law the wheel keeps: one pulse and one mm, on either side and stretched by the diameter; and the diameter."""
    most = wheel.pulse_um * 1_000 + NM_PER_MM
    stretched = -(-most * (MILLION + abs(wheel.diameter_error_ppm)) // MILLION) + 1
    constant_mm = -(-2 * stretched // NM_PER_MM)
    return ErrorLaw(kind="wheel", constant_mm=constant_mm, rate_ppm=abs(wheel.diameter_error_ppm))


def wheel(name: str, motion: Motion, config: WheelConfig) -> Distances:
    """Simulate the wheel. A positive diameter error: thicker than assumed, so it measures too little."""
    run = motion.position_nm - motion.start_nm
    scale = MILLION + config.diameter_error_ppm
    surface = run // scale * MILLION + run % scale * MILLION // scale
    pulse_nm = config.pulse_um * 1_000
    measured = surface // pulse_nm * pulse_nm // NM_PER_MM
    step = np.diff(measured, prepend=np.int64(0))
    wander = run - measured * scale
    return Distances(name, step, np.ones(len(step), dtype=np.bool_), wander)


def radar_law(radar: RadarConfig) -> ErrorLaw:
    """Return the law the radar keeps: noise as a floor, scale in proportion, and no one-off part."""
    return ErrorLaw(kind="radar", constant_mm=0, rate_ppm=abs(radar.scale_error_ppm), floor_mm_s=radar.noise_mm_s)


def radar(name: str, motion: Motion, config: RadarConfig, rng: np.random.Generator) -> Distances:
    """Simulate the radar. A positive scale error: it measures too little."""
    true = motion.distance_nm
    scale = 1 + config.scale_error_ppm / MILLION
    noise = np.clip(rng.normal(0, 0.4, len(true)), -1, 1) * _noise_nm(config, motion.period_ms)
    measured = np.rint((true / scale + noise) / NM_PER_MM).astype(np.int64)
    present = _heard(motion, config, rng)
    return Distances(name, np.where(present, measured, 0), present, np.zeros(len(true), dtype=np.int64))


def _noise_nm(config: RadarConfig, period_ms: int) -> float:
    """Return the amplitude of noise that the error law's floor allows after rounding to whole mm, both scaled."""
    left = config.noise_mm_s * period_ms * 1_000 / (1 + abs(config.scale_error_ppm) / MILLION) - NM_PER_MM / 2 - 10
    if left < 0:
        raise InputError(
            f"noise of {config.noise_mm_s} mm/s is below the rounding of {period_ms} ms cycles to whole mm."
        )
    return left


def _heard(motion: Motion, config: RadarConfig, rng: np.random.Generator) -> NDArray[np.bool_]:
    fast = np.abs(motion.speed_mm_s) >= config.cut_off_mm_s
    return fast & (rng.random(len(fast)) >= config.dropout_ppm / MILLION)
