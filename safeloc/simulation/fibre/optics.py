"""Simulates the light: from strain along the cable to the interrogator's measurement.

A pulse lights several cells at once. Their backscatter adds up with its phases, so some places are dark (fading). Strain shifts
the phase of everything beyond it. The measurement is the change of phase between two places a gauge apart, from one frame to
the next; it wraps if the strain changes too fast. Light from farther away is weaker, the receiver adds noise, and the laser's
frequency noise is common to all channels. An end without absorber reflects the pulse: this scatter looks like fibre beyond the
end, and folds into the time of the next pulse.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.config import Config, quantity
from safeloc.language.units import NM_PER_M
from safeloc.sensing.array_types import Floats, Singles
from safeloc.sensing.fibre.figures import Interrogator
from safeloc.sensing.fibre.time_of_flight import speed_mm_s
from safeloc.sensing.figures import MILLION
from safeloc.simulation.fibre.cable import Cable

Complex = NDArray[np.complex64]


class OpticsFigures(Config):
    """The interrogator's own noise and drift."""

    wave_nm: int = quantity(1_550, "nm", 500, 2_000, "[M, sure] telecommunication fibre")
    photoelastic_percent: int = quantity(78, "%", 50, 100, "[M, sure] the index falls with strain: 0.78 remains")
    snr_cdb: int = quantity(5_000, "cdB", 0, 10_000, "[M] of the mean scatter from the near end, a pulse")
    loss_cdb_km: int = quantity(20, "cdB/km", 0, 1_000, "[M, sure] 0.2 dB/km one way")
    laser_mrad: int = quantity(5, "mrad a frame", 0, 3_000, "[M] frequency noise over the gauge, in all channels alike")
    laser_drift_mrad_s: int = quantity(50, "mrad/s", -100_000, 100_000, "[M] frequency drift over the gauge")
    thermal_mrad_s: int = quantity(20, "mrad/s", 0, 10_000, "[M] a cell's own drift: fading wanders")
    ambient_mrad: int = quantity(10, "mrad a frame", 0, 3_000, "[M] wind, water and machines, with the coupling")


@dataclass(frozen=True)
class Drift:
    """Errors that the interrogator does not know, constant during a block: index in ppm, trigger in ps."""

    index_ppm: float = 0.0
    trigger_ps: float = 0.0


@dataclass(frozen=True, eq=False)
class Backscatter:
    """One block: phase rate [frames, channels] in rad a frame, and intensity [light channels] relative to the near end."""

    phase_rate: Singles
    intensity: Singles


class Receiver:
    """Converts strain to frames, block by block."""

    def __init__(
        self, interrogator: Interrogator, cable: Cable, rng: np.random.Generator, figures: OpticsFigures | None = None
    ) -> None:
        self._interrogator, self._cable, self._rng = interrogator, cable, rng
        self._figures = figures or OpticsFigures()
        self._thermal = rng.standard_normal(len(cable.track_m)) * self._figures.thermal_mrad_s / 1_000
        self._frames = 0
        self._last: Complex | None = None

    @property
    def rad_per_strain(self) -> float:
        """The phase, there and back, for a strain of 1e-9 over one cell of plain fibre."""
        figures = self._figures
        turns = 2 * self._interrogator.index_ppm / MILLION * self._cable.cell_m / (figures.wave_nm / NM_PER_M)
        return float(2 * np.pi * turns * figures.photoelastic_percent / 100 / NM_PER_M)

    def receive(self, strain: Floats, drift: Drift | None = None) -> Backscatter:
        """Return the frames of a block, from the strain of the fibre, [frames, cells] in 1e-9."""
        field, inter = self._fields(strain, drift or Drift()), self._interrogator
        near = field[:, : inter.channels]
        far = field[:, inter.gauge_channels : inter.gauge_channels + inter.channels] * np.conj(near)
        before = np.concatenate([far[:1] if self._last is None else self._last, far[:-1]])
        self._last = far[-1:].copy()
        rate = np.angle(far * np.conj(before)).astype(np.float32)
        self._frames += len(rate)
        intensity = (np.abs(field) ** 2).mean(axis=0)
        return Backscatter(self._disturbed(rate), intensity.astype(np.float32))

    def _fields(self, strain: Floats, drift: Drift) -> Complex:
        """Return the complex backscatter [frames, light channels] at the channels' times."""
        sensitive = (self.rad_per_strain * self._cable.material).astype(np.float32)
        phase: Singles = np.cumsum(strain.astype(np.float32) * sensitive, axis=1, dtype=np.float32)
        seconds = (self._frames + np.arange(len(strain))) / self._interrogator.frame_hz
        phase += (seconds[:, None] * self._thermal).astype(np.float32)
        cells = np.empty(phase.shape, dtype=np.complex64)
        cells.real, cells.imag = np.cos(phase), np.sin(phase)
        cells *= self._cable.scatterers
        starts = self._starts(drift)
        field = self._lit(cells, starts)
        if self._cable.ghost:
            field += self._cable.ghost * self._folded(cells, starts)
        return self._received(field, starts)

    def _starts(self, drift: Drift) -> NDArray[np.int64]:
        """Return the first lit cell of each channel, from the true origin of the light at the channel's time."""
        inter = self._interrogator
        trigger_mm = float(speed_mm_s(inter.index_ppm)) * drift.trigger_ps * 1e-12 / 2
        places = (np.arange(inter.light_channels) * float(inter.channel_mm) - trigger_mm) / (
            1 + drift.index_ppm / MILLION
        )
        return np.floor(places / 1_000 / self._cable.cell_m).astype(np.int64)

    def _lit(self, cells: Complex, starts: NDArray[np.int64]) -> Complex:
        """Return the sum of the cells that a pulse lights: a few cells from each start on, within the fibre."""
        lit = max(1, round(self._interrogator.pulse_mm / 1_000 / self._cable.cell_m))
        field = np.zeros((len(cells), len(starts)), dtype=np.complex64)
        for number in range(lit):
            there = starts + number
            inside = (there >= 0) & (there < cells.shape[1])
            field[:, inside] += cells[:, there[inside]]
        return field / np.float32(math.sqrt(lit))

    def _folded(self, cells: Complex, starts: NDArray[np.int64]) -> Complex:
        """Return scatter on the way back from the end, one pulse later: at `2L - z` it arrives with that of the next pulse at z."""
        inter = self._interrogator
        period_mm = float(speed_mm_s(inter.index_ppm)) / (2 * inter.pulse_hz)
        period = round(period_mm / 1_000 / self._cable.cell_m)
        return self._lit(cells, 2 * cells.shape[1] - 1 - period - starts)

    def _received(self, field: Complex, starts: NDArray[np.int64]) -> Complex:
        """Add loss on the way, and the receiver's noise averaged over the pulses of a frame."""
        figures, shape = self._figures, field.shape
        loss_cdb = 2 * figures.loss_cdb_km * np.maximum(starts, 0) * self._cable.cell_m / 1_000
        noise = 10 ** (-figures.snr_cdb / 2_000) / math.sqrt(2 * self._interrogator.pulses_per_frame)
        made = field * (10 ** (-loss_cdb / 2_000)).astype(np.float32)
        made.real += noise * self._rng.standard_normal(shape, dtype=np.float32)
        made.imag += noise * self._rng.standard_normal(shape, dtype=np.float32)
        return made

    def _disturbed(self, rate: Singles) -> Singles:
        """Add ambient noise with the coupling of each channel, and laser noise common to all channels."""
        figures, frames = self._figures, len(rate)
        starts = self._starts(Drift())[: rate.shape[1]]
        feels = (self._cable.coupling * self._cable.material)[np.clip(starts, 0, len(self._cable.coupling) - 1)]
        common = self._rng.normal(figures.laser_drift_mrad_s / self._interrogator.frame_hz, figures.laser_mrad, frames)
        rate += self._rng.standard_normal(rate.shape, dtype=np.float32) * (feels * figures.ambient_mrad / 1_000).astype(
            np.float32
        )
        rate += (common / 1_000).astype(np.float32)[:, None]
        return rate
