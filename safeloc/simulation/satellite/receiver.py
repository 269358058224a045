"""Simulates receiver and atmosphere: clock, noise, and the residual errors of the broadcast models, within a stated bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.config import Config, quantity
from safeloc.sensing.array_types import Floats
from safeloc.sensing.satellite.atmosphere import troposphere_m
from safeloc.sensing.satellite.figures import LIGHT_M_PER_S
from safeloc.sensing.satellite.navigation import Navigation
from safeloc.sensing.satellite.places import Place


class ReceiverConfig(Config):
    """Figures of a receiver with a single frequency.

    Noise grows towards the horizon with 1 / sin of the elevation, down to 17 degrees. The sum of all healthy errors is clipped at
    its bound, which is the bound that the machine assumes of a healthy signal.
    """

    code_noise_mm: int = quantity(400, "mm at the zenith", 0, 100_000, "[D] geodetic receiver: 1.6 m over all errors")
    slow_code_mm: int = quantity(500, "mm", 0, 100_000, "[M] echoes near the antenna, over a minute")
    rate_noise_mm_s: int = quantity(30, "mm/s at the zenith", 0, 100_000, "[D] 0.012 still, 0.19 m/s driving")
    clock_offset_ns: int = quantity(50_000, "ns", -1_000_000, 1_000_000, "[M] steered within a tenth of a millisecond")
    clock_drift_ppb: int = quantity(200, "ppb", -100_000, 100_000, "[M] crystal oscillator, temperature controlled")
    clock_walk_ppb: int = quantity(1, "ppb in a second", 0, 1_000, "[M] its wander")
    system_time_ns: int = quantity(30, "ns", 0, 100_000, "[M] a constellation's time against that of the first")
    ionosphere_percent: int = quantity(30, "%", 0, 100, "[S] IS-GPS-200: the model takes away half and more")
    troposphere_percent: int = quantity(3, "%", 0, 100, "[M] a tenth of a metre at the zenith")
    code_bound_mm: int = quantity(4_000, "mm", 1, 1_000_000, "[D] 2.5 x 1.6 m, as the selection has it")
    rate_bound_mm_s: int = quantity(300, "mm/s", 1, 1_000_000, "[D] geodetic receiver, as the selection has it")
    orbit_mm: int = quantity(500, "mm", 0, 100_000, "[M] error of broadcast orbits and clocks along the sight")


@dataclass(frozen=True)
class Clock:
    """The offset (s) and drift (s/s) of the receiver's clock at every epoch."""

    offset_s: Floats
    drift: Floats


def clock(config: ReceiverConfig, times_s: Floats, rng: np.random.Generator) -> Clock:
    """Return a clock whose drift is a random walk; the offset is the exact sum of the drift."""
    gaps = np.diff(times_s, prepend=times_s[0])
    walk = np.cumsum(rng.normal(0, 1, len(times_s)) * config.clock_walk_ppb * 1e-9 * np.sqrt(gaps))
    drift = config.clock_drift_ppb * 1e-9 + walk
    return Clock(config.clock_offset_ns * 1e-9 + np.cumsum(drift * gaps), drift)


def system_times_m(config: ReceiverConfig, names: Sequence[str], rng: np.random.Generator) -> Floats:
    """Return each pseudorange's offset from its constellation's own time (m); it is 0 for the first constellation."""
    letters = sorted({name[0] for name in names})
    times = {letter: config.system_time_ns * 1e-9 * float(rng.uniform(-1, 1)) for letter in letters[1:]}
    return np.array([LIGHT_M_PER_S * times.get(name[0], 0.0) for name in names])


def air_m(navigation: Navigation, place: Place, elevation: Floats, azimuth: Floats, time_s: float) -> Floats:
    """Return the delay by the models for each satellite of one epoch, 0 below the horizon."""
    ions = navigation.ionosphere
    return np.array(
        [
            troposphere_m(place.height_m, up) + (ions.delay_m(place, up, around, time_s) if ions else 0.0)
            if up > 0
            else 0.0
            for up, around in zip(elevation, azimuth, strict=True)
        ]
    )


@dataclass(frozen=True)
class Healthy:
    """Errors of healthy signals, arrays [epoch, satellite], m and m/s."""

    code_m: Floats
    rate_m_per_s: Floats


def healthy(config: ReceiverConfig, times_s: Floats, elevation: Floats, rng: np.random.Generator) -> Healthy:
    """Return noise, slow echoes, and the residual errors of orbits and atmosphere."""
    low = 1 / np.maximum(np.sin(elevation), 0.3)
    satellites = elevation.shape[1]
    slow = _slow(times_s, satellites, 60.0, rng) * config.slow_code_mm * low
    white = _cut(rng.normal(0, 1, elevation.shape)) * config.code_noise_mm * low
    orbit = _cut(rng.normal(0, 1, (satellites,))) * config.orbit_mm
    ions = _cut(rng.normal(0, 1 / 3, (satellites,))) * config.ionosphere_percent / 100 * 3_000 * low
    wet = _cut(rng.normal(0, 1 / 3, (satellites,))) * config.troposphere_percent / 100 * 2_400 * low
    rate = _cut(rng.normal(0, 1, elevation.shape)) * config.rate_noise_mm_s * low
    code = _within(slow + white + orbit + ions + wet, config.code_bound_mm)
    return Healthy(code / 1_000, _within(rate, config.rate_bound_mm_s) / 1_000)


def _slow(times_s: Floats, satellites: int, over_s: float, rng: np.random.Generator) -> Floats:
    """Return errors correlated over `over_s`, with standard deviation 1, clipped at 3."""
    made = [rng.normal(0, 1, (satellites,))]
    for gap in np.diff(times_s):
        kept = np.exp(-gap / over_s)
        made.append(kept * made[-1] + np.sqrt(1 - kept**2) * rng.normal(0, 1, (satellites,)))
    return _cut(np.array(made))


def _cut(values: Floats) -> Floats:
    return _within(values, 3)


def _within(values: Floats, bound: float) -> Floats:
    return np.asarray(np.clip(values, -bound, bound))


def code_of(way_m: Floats, one: Clock) -> Floats:
    """Return pseudoranges from distances, by the offset of the receiver's clock."""
    return np.asarray(way_m + LIGHT_M_PER_S * one.offset_s[:, None])


def rate_of(rate_m_per_s: Floats, one: Clock) -> Floats:
    """Return measured range rates from true ones, by the drift of the receiver's clock."""
    return np.asarray(rate_m_per_s + LIGHT_M_PER_S * one.drift[:, None])
