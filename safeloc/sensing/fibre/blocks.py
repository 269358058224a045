"""Admits blocks of frames unchanged or refuses them with a reason; nothing is repaired.

A refused block contains no information: for the machines the fibre was silent in it, and all tracked trains are lost.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from enum import Enum

import numpy as np

from safeloc.language.units import MS_PER_S
from safeloc.runtime.border import Deliveries, Raw, Reason
from safeloc.sensing.array_types import Singles
from safeloc.sensing.fibre.figures import FibreConfig

_TIME_SLACK_MS = 2


class Refusal(Enum):
    """Reasons to refuse a block that only blocks can have; others are the border's (`Reason`)."""

    WRONG_SHAPE = "not frames x channels of this interrogator"
    WRONG_INTENSITY = "intensity is not finite, not >= 0, or not one number a light channel"
    GAP = "frames are missing between this block and the one before"
    FROZEN = "the same block as before under a new number"
    SILENT = "no noise at all: the interrogator does not measure"
    DARK = "too little light comes back from too many channels"
    DISTURBED = "the whole fibre is shaken at once"
    LEARNING = "the fibre's quiet is not known yet"


@dataclass(frozen=True, eq=False)
class FibreBlock:
    """Frames as delivered.

    phase_rate   [frames, channels], change of phase over each channel's gauge in rad a frame, 32-bit or 64-bit floats
    intensity    [light channels], mean power of the returned light; None if the interrogator does not measure it
    time_ms      time of the last frame
    sequence     number of the block
    """

    phase_rate: object
    intensity: object
    time_ms: int
    sequence: int


@dataclass(frozen=True)
class NoFibre:
    """A missing or refused block, with the reason."""

    reason: Reason | Refusal
    detail: str = ""


@dataclass(frozen=True, eq=False)
class Content:
    """The arrays of an admitted block."""

    phase_rate: Singles
    intensity: Singles | None


def admitted(config: FibreConfig, block: FibreBlock) -> Content | NoFibre:
    """Return the block's arrays, or the reason why they cannot be used. Finiteness is checked later, on the energies."""
    rate = block.phase_rate
    if not isinstance(rate, np.ndarray) or rate.dtype not in (np.float32, np.float64):
        return NoFibre(Reason.WRONG_TYPE, str(getattr(rate, "dtype", type(rate).__name__)))
    shape = (config.band.block_frames, config.interrogator.channels)
    if rate.shape != shape:
        return NoFibre(Refusal.WRONG_SHAPE, f"{rate.shape}, not {shape}")
    intensity = _intensity(block.intensity, config.interrogator.light_channels)
    if isinstance(intensity, NoFibre):
        return intensity
    with np.errstate(over="ignore"):
        return Content(rate.astype(np.float32, copy=False), intensity)


def _intensity(given: object, channels: int) -> Singles | NoFibre | None:
    if given is None:
        return None
    if not isinstance(given, np.ndarray) or given.dtype not in (np.float32, np.float64):
        return NoFibre(Reason.WRONG_TYPE, "intensity")
    if given.shape != (channels,):
        return NoFibre(Refusal.WRONG_INTENSITY, f"{given.shape}, not {(channels,)}")
    if not np.isfinite(given).all() or given.min() < 0:
        return NoFibre(Refusal.WRONG_INTENSITY, "not finite, or negative")
    return given.astype(np.float32, copy=False)


def unusable(config: FibreConfig, energy: Singles) -> NoFibre | None:
    """Detect frames that are not finite, and a silent interrogator, from the energies [windows, channels].

    Every frame has a weight in the energies of its window, and NaN and infinity persist in sums.
    """
    if not np.isfinite(energy).all():
        return NoFibre(Reason.NOT_FINITE, f"{int((~np.isfinite(energy)).any(axis=0).sum())} channels")
    silent = 100 * float((energy.max(axis=0) == 0).mean())
    if silent > config.detection.lost_percent:
        return NoFibre(Refusal.SILENT, f"{silent:.0f} % of the channels")
    return None


class Order:
    """Checks order and age of blocks, that they join without a gap, and that consecutive blocks differ."""

    def __init__(self, config: FibreConfig, max_age_ms: int) -> None:
        self._max_age_ms = max_age_ms
        self._duration_ms = MS_PER_S * config.band.block_frames / config.interrogator.frame_hz
        self._deliveries = Deliveries()
        self._joins: tuple[int, int] | None = None
        self._digest: bytes | None = None

    def judge(self, block: FibreBlock, now_ms: int) -> NoFibre | None:
        """Return None if the block is in time and new, else the reason."""
        fault = self._deliveries.fault("block", Raw(None, block.time_ms, block.sequence), now_ms, self._max_age_ms)
        return None if fault is None else NoFibre(fault.reason, fault.detail)

    def joins(self, block: FibreBlock) -> NoFibre | None:
        """Return None if the block continues the last one checked here, or is the first, else the reason."""
        before, self._joins = self._joins, (block.sequence, block.time_ms)
        if before is None:
            return None
        late_ms = block.time_ms - before[1] - self._duration_ms
        if block.sequence == before[0] + 1 and abs(late_ms) <= _TIME_SLACK_MS:
            return None
        return NoFibre(Refusal.GAP, f"number {before[0]} to {block.sequence}, {late_ms:+.0f} ms")

    def broken(self) -> None:
        """Mark a break: the next block does not continue an earlier one."""
        self._joins = None

    def changes(self, energy: Singles) -> NoFibre | None:
        """Return None if the energies differ from those of the last block, else the reason."""
        before, self._digest = self._digest, hashlib.blake2b(energy.tobytes()).digest()
        return NoFibre(Refusal.FROZEN) if before == self._digest else None
