"""Computes measured minus predicted values of one epoch without the receiver's clock, for the selection."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from safeloc.sensing.satellite.clock import common_part, constellations, of_constellation, without_clock
from safeloc.sensing.satellite.epochs import Epoch
from safeloc.sensing.satellite.figures import LIGHT_M_PER_S
from safeloc.sensing.satellite.places import Place, Vector
from safeloc.sensing.satellite.predicted import Predicted, Signal

MASK_RAD = math.radians(10)
"""No prediction below this elevation, since the simple troposphere has errors of metres there."""
_LINEAR_S = 0.01
"""A clock error up to this is corrected by the rate alone; accelerations of 1 m/s2 leave 0.05 mm."""


@dataclass(frozen=True, slots=True)
class Residuals:
    """Residuals by satellite, in m and m/s. Without values: `expired` (no valid ephemeris) and `low` (below the mask).

    clock_s  estimate of how far the receiver's time is ahead of true time
    """

    pseudorange_m: Mapping[str, float]
    rate_m_per_s: Mapping[str, float]
    predictions: Mapping[str, Predicted]
    expired: frozenset[str]
    low: frozenset[str]
    clock_s: float


class Sky(Protocol):
    """Predictions of signals: from ephemerides (`Navigation`), or from states that came with the ranges (`CorrectedSky`)."""

    def signals(self, epoch: Epoch) -> Mapping[str, Signal]:
        """Return how the signal of each satellite of an epoch is predicted, as far as it can be."""
        ...


Kept: TypeAlias = dict[tuple[str, float, Place, Vector], Predicted]
"""Predictions of one cycle by satellite, time of reception, place and velocity: each is made once, however often the sky is looked at."""


def residuals(epoch: Epoch, place: Place, velocity_m_per_s: Vector, sky: Sky, kept: Kept | None = None) -> Residuals:
    """Return residuals from the estimated state E*(t) at the receiver's time (SAT-1).

    The clock of each constellation is estimated separately. A value that was not measured has no residual.

    kept   predictions that another look at the same sky made, and where to keep those of this one
    """
    signals = sky.signals(epoch)
    satellites = _Satellites(epoch, signals, place, velocity_m_per_s, {} if kept is None else kept)
    every, clock_s = satellites.expected(0.0), 0.0
    codes = satellites.codes(_above_mask(every), clock_s)
    if codes:
        clock_s = common_part(of_constellation(codes, _largest(codes))) / LIGHT_M_PER_S
        if abs(clock_s) > _LINEAR_S:
            every = satellites.expected(clock_s)
            codes = satellites.codes(_above_mask(every), 0.0)
        else:
            codes = satellites.codes(_above_mask(every), clock_s)
    seen = _above_mask(every)
    expired, low = frozenset(epoch.satellites) - signals.keys(), every.keys() - seen.keys()
    rates = without_clock(satellites.rates(seen))
    return Residuals(without_clock(codes), rates, seen, expired, frozenset(low), clock_s)


def _above_mask(every: Mapping[str, Predicted]) -> dict[str, Predicted]:
    return {name: one for name, one in every.items() if one.elevation_rad >= MASK_RAD}


@dataclass(frozen=True, slots=True)
class _Satellites:
    """One epoch's satellites whose signals can be predicted, and the state for which they are."""

    epoch: Epoch
    signals: Mapping[str, Signal]
    place: Place
    velocity_m_per_s: Vector
    kept: Kept

    def expected(self, clock_s: float) -> dict[str, Predicted]:
        """Return the predictions for the receiver's time minus this clock error, with the vehicle moved accordingly."""
        place = self.place if clock_s == 0 else self._moved(-clock_s)
        at = self.epoch.time_s - clock_s
        return {name: self._signal(name, at, place) for name in self.epoch.satellites if name in self.signals}

    def _signal(self, name: str, time_s: float, place: Place) -> Predicted:
        key = (name, time_s, place, self.velocity_m_per_s)
        if key not in self.kept:
            self.kept[key] = self.signals[name](time_s, place, self.velocity_m_per_s)
        return self.kept[key]

    def _moved(self, seconds: float) -> Place:
        x, y, z = self.place.earth_fixed_m()
        u, v, w = self.velocity_m_per_s
        return Place.of_earth_fixed((x + seconds * u, y + seconds * v, z + seconds * w))

    def codes(self, seen: Mapping[str, Predicted], clock_s: float) -> dict[str, float]:
        """Return measured minus predicted pseudoranges, corrected for this clock error by the rate."""
        measured = self.epoch.satellites
        given = ((name, one, measured[name].pseudorange_m) for name, one in seen.items())
        return {
            name: code - one.pseudorange_m + one.rate_m_per_s * clock_s for name, one, code in given if code is not None
        }

    def rates(self, seen: Mapping[str, Predicted]) -> dict[str, float]:
        """Return measured minus predicted range rates."""
        measured = self.epoch.satellites
        given = ((name, one, measured[name].rate_m_per_s) for name, one in seen.items())
        return {name: rate - one.rate_m_per_s for name, one, rate in given if rate is not None}


def _largest(values: Mapping[str, float]) -> str:
    """Return the constellation with the most satellites; the first by name if there are several."""
    return max(constellations(values), key=lambda system: len(of_constellation(values, system)))
