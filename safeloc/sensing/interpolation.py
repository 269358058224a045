"""Interpolates the place of an echo between cells, with bounds from noise and other echoes.

A Hann window spreads a point to the amplitudes H(x) = sin(pi x) / (pi x (1 - x^2)), x cells away. Two neighbours give its
place exactly: with a the ratio of the smaller amplitude to the peak's, the point lies (2a - 1) / (1 + a) cells from
the peak. If both amplitudes may have an error of n, the ratio lies between (a1 - n) / (a0 + n) and (a1 + n) / (a0 - n), and
the place between those of these ratios. This needs no assumption of weak noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safeloc.sensing.array_types import Floats
from safeloc.sensing.detection import Peaks
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import Power

FLOAT_CELLS = 1e-9
_SIDE_FACTOR = 2.0


@dataclass(frozen=True, eq=False)
class Places:
    """Places along one axis in cells from the peak's cell: best, lowest and highest. Shapes [peaks]."""

    best: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, eq=False)
class Points:
    """Peaks with places interpolated in range and angle, and the power there. Shapes [peaks]."""

    peaks: Peaks
    range: Places
    angle: Places
    power: Floats


def points(power: Power, found: Peaks, config: RadarConfig) -> Points:
    """Return the peaks in order of range, without those that may be side lobes of a stronger echo."""
    top = _top(power, found)
    leaked = leakage(found, np.sqrt(top))
    kept = np.flatnonzero(np.sqrt(top) > leaked)
    kept = kept[np.argsort((found.row + _range(power, found, np.zeros(len(found))).best)[kept], kind="stable")]
    found, top, leaked = found.only(kept), top[kept], leaked[kept]
    noise = np.sqrt(found.background * 10 ** (config.detection.noise_bound_cdb / 1_000)) + leaked
    return Points(found, _range(power, found, noise), _angle(power, found, noise), top)


def hann(x: Floats) -> Floats:
    """Return the amplitude of a point in a cell x cells away: 1 at 0, 1/2 at 1."""
    near = np.abs(np.abs(x) - 1) < 1e-9
    return np.where(near, 0.5, np.sinc(x) / np.where(near, 1.0, 1 - x * x))


def side_lobes(x: Floats) -> Floats:
    """Return an upper bound of a point's amplitude x >= 0 cells away; beyond the main lobe it falls with the cube."""
    far = np.maximum(x, 1.5)
    return np.where(x < 1.5, 1.0, 1 / (np.pi * far * (far * far - 1)))


def leakage(found: Peaks, amplitude: Floats) -> Floats:
    """Return the amplitude that all other peaks together may have in a peak's cell or the next one."""
    rows = np.abs(found.row[:, None] - found.row[None, :]) - 1.5
    columns = np.abs(found.column[:, None] - found.column[None, :]) - 1.5
    part = side_lobes(rows) * np.minimum(1.0, _SIDE_FACTOR * side_lobes(columns))
    np.fill_diagonal(part, 0.0)
    total: Floats = part @ amplitude
    return total


def _range(power: Power, found: Peaks, noise: Floats) -> Places:
    before, after = power[found.row - 1, found.column], power[found.row + 1, found.column]
    return _places(power[found.row, found.column], before, after, noise, power.shape[0])


def _angle(power: Power, found: Peaks, noise: Floats) -> Places:
    before, after = power[found.row, found.column - 1], power[found.row, found.column + 1]
    return _places(power[found.row, found.column], before, after, noise, 2 * power.shape[1] - 2)


def _places(peak: Floats, before: Floats, after: Floats, noise: Floats, samples: int) -> Places:
    """Interpolate between the neighbours of a peak, for a transform of this many samples: short windows deviate from the formula."""
    short = 4.0 / samples**2 + FLOAT_CELLS
    tall, beside = np.sqrt(peak), np.sqrt(np.maximum(before, after))
    near = _offset((beside - noise) / (tall + noise)) - short
    left = np.where(tall > noise, tall - noise, 1.0)
    far = np.where(tall > noise, _offset((beside + noise) / left), 2.0) + short
    near = np.maximum(near, -1.0)
    ahead = after >= before
    best = _offset(beside / tall)
    return Places(np.where(ahead, best, -best), np.where(ahead, near, -far), np.where(ahead, far, -near))


def _offset(ratio: Floats) -> Floats:
    positive = np.maximum(ratio, 0.0)
    offset: Floats = (2 * positive - 1) / (1 + positive)
    return offset


def _top(power: Power, found: Peaks) -> Floats:
    """Return the power at the interpolated place of the echo."""
    none = np.zeros(len(found))
    along, across = _range(power, found, none).best, _angle(power, found, none).best
    top: Floats = power[found.row, found.column] / (hann(along) * hann(across)) ** 2
    return top
