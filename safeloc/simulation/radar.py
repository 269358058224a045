"""Simulates the images that an FMCW radar makes of reflectors and clutter, from its principle of operation.

Every point returns the chirp. Mixed with the transmitted chirp it becomes a tone with the phase 4 pi / c times frequency times
range, in each sample of the chirp and each antenna. The sum of tones and receiver noise is clipped at the converter's full
scale; two Fourier transforms with Hann windows then make the image. Mean noise power is 1 in every cell.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safeloc.config import Config, quantity
from safeloc.sensing.array_types import Floats
from safeloc.sensing.figures import LIGHT_MM_S, MILLION, RadarConfig
from safeloc.sensing.range_law import REFERENCE_MM

_NEAREST_MM = 500

Complex = NDArray[np.complex128]


class Weather(Config):
    """Weather between the radar and the reflectors."""

    rain_mm_h: int = quantity(0, "mm/h", 0, 200, "[M] 10 heavy, 50 violent")
    film_cdb: int = quantity(0, "cdB", 0, 6_000, "[M] water, snow or dirt on the antenna's cover, both ways together")


@dataclass(frozen=True, eq=False)
class Points:
    """Points that reflect power: slant range in mm, sine of the angle to the left, radar cross-section in m2. Shapes
    [points].

    on_ground  whether the signal may also travel by the ground

    A point with range NaN lies behind the antenna and is not seen.
    """

    range_mm: Floats
    sine: Floats
    section_m2: Floats
    on_ground: NDArray[np.bool_]

    def together(self, other: Points) -> Points:
        """Return the points of both."""
        return Points(*(np.concatenate(both) for both in zip(self.columns, other.columns, strict=True)))

    def only(self, kept: NDArray[np.bool_]) -> Points:
        """Return only these points."""
        return Points(*(column[kept] for column in self.columns))

    @property
    def columns(self) -> tuple[Any, ...]:
        """The arrays in order."""
        return self.range_mm, self.sine, self.section_m2, self.on_ground


def points(range_mm: Floats, sine: Floats, section_m2: Floats | float, *, on_ground: bool = False) -> Points:
    """Return points of one kind."""
    return Points(range_mm, sine, np.broadcast_to(section_m2, range_mm.shape), np.full(range_mm.shape, on_ground))


@dataclass(frozen=True)
class Interference:
    """Another radar, whose chirp crosses ours in `samples` samples, `over_noise_db` above noise in each."""

    samples: int = 40
    over_noise_db: float = 50.0
    sine: float = 0.1


@dataclass(frozen=True)
class Bias:
    """The errors of a sensor as shares of the declared bounds, from -1 to 1: scale, offset and angle."""

    scale: float = 0.0
    offset: float = 0.0
    angle: float = 0.0


def image(
    seen: Points,
    config: RadarConfig,
    rng: np.random.Generator,
    *,
    speed_mm_s: float = 0.0,
    weather: Weather | None = None,
    bias: Bias | None = None,
    interference: Interference | None = None,
    noise_db: float = 0.0,
) -> Floats:
    """Return the image, power [range cell, angle cell] over mean noise, of points that approach with `speed_mm_s` x cosine.

    noise_db  additional noise from all directions, over the receiver's own
    """
    weather = weather or Weather()
    seen = _in_view(seen, config)
    ways = _by_the_ground(_biased(seen, config, bias or Bias()), _amplitudes(seen, config, weather, rng), config, rng)
    signal = _tones(*ways, speed_mm_s, config)
    signal += _noise(signal.shape, rng) * 10 ** (noise_db / 20)
    if interference is not None:
        signal += _burst(signal.shape, interference, rng)
    return _transformed(_converted(signal, config), config)


def _in_view(seen: Points, config: RadarConfig) -> Points:
    """Return the points ahead, beyond the antenna's cover and within the last range cell (a filter removes others)."""
    last = float(config.sensor.cell_mm) * (config.sensor.samples - 1)
    return seen.only((seen.range_mm > _NEAREST_MM) & (seen.range_mm < last))


def _biased(seen: Points, config: RadarConfig, bias: Bias) -> Points:
    sensor = config.sensor
    range_mm = seen.range_mm * (1 + bias.scale * sensor.scale_error_ppm / MILLION)
    sine = np.clip(seen.sine + bias.angle * sensor.angle_error_urad / MILLION, -1.0, 1.0)
    return replace(seen, range_mm=range_mm + bias.offset * sensor.offset_error_mm, sine=sine)


def _amplitudes(seen: Points, config: RadarConfig, weather: Weather, rng: np.random.Generator) -> Complex:
    """Return the amplitudes at the peaks of the echoes in the image, by the range law and rain on the way."""
    power = 10 ** (config.reference_cdb / 1_000) * seen.section_m2 * (REFERENCE_MM / seen.range_mm) ** 4
    lost_cdb = weather.film_cdb + 2 * rain_cdb_per_km(weather.rain_mm_h) * seen.range_mm / MILLION
    phase = np.exp(2j * np.pi * rng.random(len(power)))
    made: Complex = np.sqrt(power * 10 ** (-lost_cdb / 1_000)) * phase
    return made


def rain_cdb_per_km(rain_mm_h: float) -> float:
    """Return the one-way attenuation at 77 GHz in hundredths of dB a kilometre: about 1.1 R^0.73 dB [M, fairly sure: ITU-R
    P.838]."""
    return float(110 * rain_mm_h**0.73)


def _by_the_ground(
    seen: Points, amplitude: Complex, config: RadarConfig, rng: np.random.Generator
) -> tuple[Points, Complex]:
    """Add echoes by the ground, on the way out or back (two with half the detour) or on both, with a random phase."""
    low = seen.only(seen.on_ground)
    part = config.sensor.ground_reflection_percent / 100 * np.exp(2j * np.pi * rng.random(len(low.sine)))
    detour = 2 * config.sensor.ground_height_mm2 / low.range_mm
    once, twice = replace(low, range_mm=low.range_mm + detour / 2), replace(low, range_mm=low.range_mm + detour)
    straight = amplitude[seen.on_ground]
    return seen.together(once).together(twice), np.concatenate([amplitude, 2 * part * straight, part**2 * straight])


def _tones(seen: Points, amplitude: Complex, speed_mm_s: float, config: RadarConfig) -> Complex:
    """Return the tones [sample, antenna]. The frequency rises from half the bandwidth below the carrier to half above it."""
    sensor = config.sensor
    time = (np.arange(sensor.samples) / sensor.samples - 0.5) * sensor.chirp_us / MILLION
    hertz = sensor.carrier_mhz * 1e6 + time * sensor.bandwidth_mhz * 1e6 / (sensor.chirp_us / MILLION)
    light = LIGHT_MM_S / (1 + sensor.air_ppm / MILLION)
    closing = speed_mm_s * np.sqrt(1 - seen.sine**2)
    turns = 2 / light * hertz[:, None] * (seen.range_mm[None, :] - closing[None, :] * time[:, None])
    along = np.exp(2j * np.pi * (turns % 1.0))
    across = np.exp(1j * np.pi * np.arange(sensor.antennas)[None, :] * seen.sine[:, None])
    gain = _gain(sensor.samples) * _gain(sensor.antennas)
    tones: Complex = (along * (amplitude / gain)) @ across
    return tones


def _hann(samples: int) -> Floats:
    return np.asarray(0.5 - 0.5 * np.cos(2 * np.pi * np.arange(samples) / samples), dtype=np.float64)


def _gain(samples: int) -> float:
    """Return the gain of a tone over noise."""
    window = _hann(samples)
    return float(window.sum() / np.sqrt((window**2).sum()))


def _noise(shape: tuple[int, ...], rng: np.random.Generator) -> Complex:
    noise: Complex = (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)
    return noise


def _burst(shape: tuple[int, ...], interference: Interference, rng: np.random.Generator) -> Complex:
    """Return a chirp that sweeps through the receiver's band while it crosses ours."""
    samples, antennas = shape
    begin = int(rng.integers(0, samples - interference.samples))
    run = np.arange(interference.samples) - interference.samples / 2
    sweep = np.exp(1j * np.pi * run**2 / interference.samples) * 10 ** (interference.over_noise_db / 20)
    made = np.zeros(shape, dtype=np.complex128)
    made[begin : begin + interference.samples] = sweep[:, None] * np.exp(
        1j * np.pi * np.arange(antennas) * interference.sine
    )
    return made


def _converted(signal: Complex, config: RadarConfig) -> Complex:
    """Clip both components at the converter's full scale."""
    sensor = config.sensor
    end = 10 ** (sensor.full_scale_cdb / 2_000) / _gain(sensor.samples) / _gain(sensor.antennas)
    cut: Complex = np.clip(signal.real, -end, end) + 1j * np.clip(signal.imag, -end, end)
    return cut


def _transformed(signal: Complex, config: RadarConfig) -> Floats:
    sensor = config.sensor
    rows, columns = _hann(sensor.samples), _hann(sensor.antennas)
    spectrum = np.fft.fft2(signal * rows[:, None] * columns[None, :])
    scaled = spectrum / np.sqrt((rows**2).sum() * (columns**2).sum())
    side = sensor.side_cells
    return np.ascontiguousarray(np.abs(np.roll(scaled, side, axis=1)[:, : 2 * side + 1]) ** 2)
