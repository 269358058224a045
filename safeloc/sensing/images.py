"""Admits radar images unchanged or refuses them with a reason; nothing is repaired.

A refused image contains no information on reflectors: for the machines it is a missing frame, and its reason is reported.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from safeloc.runtime.border import Deliveries, Raw, Reason
from safeloc.sensing.figures import Sensor

Power = NDArray[np.float64]
_DOUBTFUL_CDB = 1e-6
"""The logarithm of a float has a smaller error than this."""


class Refusal(Enum):
    """Reasons to refuse an image that only images can have; others are the border's (`Reason`)."""

    WRONG_SHAPE = "not range cells x angle cells of this sensor"
    NEGATIVE = "negative power"
    FROZEN = "the same picture as before under a new number"
    DEAD = "less noise than the receiver's own"
    JAMMED = "noise everywhere: interference"
    OVERLOADED = "an echo beyond the converter's range: lines of its harmonics look like echoes"
    CROWDED = "more peaks than a track has"


@dataclass(frozen=True, eq=False)
class RadarImage:
    """One frame as delivered: `power` [range cell, angle cell] over mean noise, time and sequence number.

    `time_ms` is the middle of the chirp.
    """

    power: object
    time_ms: int
    sequence: int


@dataclass(frozen=True)
class NoFrame:
    """A missing or refused image, with the reason."""

    reason: Reason | Refusal
    detail: str = ""


def admitted(sensor: Sensor, image: RadarImage) -> Power | NoFrame:
    """Return the image's power, or the reason why it cannot be used (`Order` checks its place in the stream)."""
    power = image.power
    if not isinstance(power, np.ndarray) or power.dtype != np.float64:
        return NoFrame(Reason.WRONG_TYPE, type(power).__name__)
    if power.shape != sensor.shape:
        return NoFrame(Refusal.WRONG_SHAPE, f"{power.shape}, not {sensor.shape}")
    if not np.isfinite(power).all():
        return NoFrame(Reason.NOT_FINITE, f"{int((~np.isfinite(power)).sum())} cells")
    if power.min() < 0:
        return NoFrame(Refusal.NEGATIVE, f"{int((power < 0).sum())} cells")
    return _receiver(sensor, power) or power


def _receiver(sensor: Sensor, power: Power) -> NoFrame | None:
    """Check the receiver itself by its noise floor."""
    floor = floor_cdb(power)
    if floor is None or floor < sensor.floor_low_cdb:
        return NoFrame(Refusal.DEAD, f"{floor} cdB")
    if floor > sensor.floor_high_cdb:
        return NoFrame(Refusal.JAMMED, f"{floor} cdB")
    strongest = float(power.max())
    if strongest > 10 ** (sensor.overload_cdb / 1_000):
        return NoFrame(Refusal.OVERLOADED, f"{in_cdb(strongest)} cdB")
    return None


def floor_cdb(power: Power) -> int | None:
    """Return the noise of the whole image in hundredths of dB, from its median; None if half the image is zero."""
    median = float(np.median(power))
    return in_cdb(median / math.log(2)) if median > 0 else None


def in_cdb(power: float) -> int:
    """Return positive power in hundredths of dB, rounded down, so never too high.

    The logarithm in floats may reach a whole number that the power does not; then exact powers decide.
    """
    level = 1_000 * math.log10(power)
    nearest = round(level)
    if abs(level - nearest) > _DOUBTFUL_CDB:
        return math.floor(level)
    return nearest if Fraction(power) ** 1_000 >= Fraction(10) ** nearest else nearest - 1


class Order:
    """Checks the order and age of images, as the border does, and that consecutive images differ."""

    def __init__(self, max_age_ms: int) -> None:
        self._max_age_ms = max_age_ms
        self._deliveries = Deliveries()
        self._last: bytes | None = None

    def judge(self, image: RadarImage, now_ms: int) -> NoFrame | None:
        """Return None if the image is new, in time and different from the last one; else the reason. Buffers may be reused."""
        raw = Raw(None, image.time_ms, image.sequence)
        fault = self._deliveries.fault("frame", raw, now_ms, self._max_age_ms)
        if fault is not None:
            return NoFrame(fault.reason, fault.detail)
        before, self._last = self._last, _digest(image.power)
        if before is not None and before == self._last:
            return NoFrame(Refusal.FROZEN, f"number {image.sequence}")
        return None


def _digest(power: object) -> bytes | None:
    return hashlib.blake2b(power.tobytes()).digest() if isinstance(power, np.ndarray) else None
