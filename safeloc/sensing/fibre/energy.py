"""Computes the energy of vibration in a band for each window, and each channel's quiet level.

A window of frames is projected onto the tones of the band under a Hann window, each of unit length: white noise of unit
variance has mean energy 1. Strong slow strain (an axle's weight, temperature) lies outside the tones' main lobes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import EngineError
from safeloc.language.units import MS_PER_S
from safeloc.sensing.array_types import Singles
from safeloc.sensing.fibre.figures import FibreConfig, tones_hz

try:
    from scipy.signal import windows
except ModuleNotFoundError as error:
    raise EngineError("fibre signals are read with scipy: pip install 'safeloc[signals]'.") from error

_LEARNING_PARTS = 5


@dataclass(frozen=True, eq=False)
class Energies:
    """Mean energy in the band, and at the emitters' tone (None without emitters). Shapes [windows, channels]."""

    band: Singles
    tone: Singles | None


class Analyser:
    """Computes the energies of blocks, as one matrix product."""

    def __init__(self, config: FibreConfig) -> None:
        self._windows, self._frames = config.band.windows_per_block, config.band.window_frames
        rows = [_rows(config, tone) for tone in tones_hz(config)]
        self._band_rows = 2 * len(rows)
        if config.emission.emitters:
            rows.append(_rows(config, config.emission.tone_hz))
        self._rows = np.concatenate(rows).astype(np.float32)

    def energies(self, phase_rate: Singles) -> Energies:
        """Return the energies of a block, [frames, channels]."""
        parts = phase_rate.reshape(self._windows, self._frames, phase_rate.shape[1])
        with np.errstate(over="ignore", invalid="ignore"):
            projected = np.matmul(self._rows, parts)
            np.multiply(projected, projected, out=projected)
            band: Singles = projected[:, : self._band_rows].mean(axis=1)
            if len(self._rows) == self._band_rows:
                return Energies(band, None)
            return Energies(band, projected[:, self._band_rows :].mean(axis=1))


def _rows(config: FibreConfig, tone_hz: float) -> NDArray[np.float64]:
    """Return cosine and sine of a tone under the window, each of unit length."""
    frames = np.arange(config.band.window_frames)
    turn = 2 * np.pi * tone_hz * frames / config.interrogator.frame_hz
    window = windows.hann(config.band.window_frames + 2)[1:-1]
    rows = np.stack([window * np.cos(turn), window * np.sin(turn)])
    return np.asarray(rows / np.sqrt((rows**2).sum(axis=1, keepdims=True)))


class Smoother:
    """Averages energies over the last windows, across blocks."""

    def __init__(self, windows_averaged: int) -> None:
        self._count = windows_averaged
        self._before: Singles | None = None

    def reset(self) -> None:
        """Forget earlier windows."""
        self._before = None

    def smooth(self, energy: Singles) -> Singles:
        """Return for every window [windows, channels] the mean with the windows before it."""
        if self._count == 1:
            return energy
        lead = np.repeat(energy[:1], self._count - 1, axis=0) if self._before is None else self._before
        joined = np.concatenate([lead, energy])
        self._before = joined[len(joined) - self._count + 1 :]
        made = joined[: len(energy)].copy()
        for number in range(1, self._count):
            made += joined[number : number + len(energy)]
        made /= np.float32(self._count)
        return made


class Quiet:
    """The quiet level of each channel: that of the quietest part of its first seconds, then a slow mean of its quiet windows."""

    def __init__(self, config: FibreConfig) -> None:
        self._needed = max(_LEARNING_PARTS, round(config.detection.floor_s * MS_PER_S / config.window_ms))
        self._share = np.float32(1 / self._needed)
        self._first: list[Singles] = []
        self._level: Singles | None = None

    @property
    def level(self) -> Singles | None:
        """The mean quiet energy, [channels]; None until it is learnt."""
        return self._level

    def learn(self, energy: Singles) -> None:
        """Learn the level from energies [windows, channels] of the first seconds."""
        self._first.extend(energy)
        if len(self._first) >= self._needed:
            parts = np.array_split(np.stack(self._first), _LEARNING_PARTS)
            self._level = np.min([part.mean(axis=0) for part in parts], axis=0).astype(np.float32)
            self._first = []

    def follow(self, energy: Singles, shaken: NDArray[np.bool_]) -> None:
        """Adapt the level with energies where nothing shakes the fibre; both [windows, channels]."""
        assert self._level is not None
        quiet = ~shaken
        count = quiet.sum(axis=0)
        mean = np.where(quiet, energy, 0).sum(axis=0) / np.maximum(count, 1)
        share = np.minimum(count * self._share, 1)
        self._level = (self._level + share * (mean - self._level)).astype(np.float32)
