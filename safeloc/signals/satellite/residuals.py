"""Measured minus predicted of one epoch, after the receiver's clock is taken off: the inputs of the selection."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.signals.satellite.clock import common_part, without_clock
from safeloc.signals.satellite.ephemeris import Ephemeris, usable
from safeloc.signals.satellite.epochs import Epoch
from safeloc.signals.satellite.figures import LIGHT_M_PER_S
from safeloc.signals.satellite.navigation import Navigation
from safeloc.signals.satellite.places import Place, Vector
from safeloc.signals.satellite.predicted import Predicted, predicted

MASK_RAD = math.radians(10)
"""Below this elevation the simple troposphere is wrong by metres: no prediction is made there."""


@dataclass(frozen=True, slots=True)
class Residuals:
    """Per satellite, in m and m/s. Without values: `expired` (no valid ephemeris), and those below the mask."""

    pseudorange_m: Mapping[str, float]
    rate_m_per_s: Mapping[str, float]
    predictions: Mapping[str, Predicted]
    expired: frozenset[str]


def residuals(epoch: Epoch, place: Place, velocity_m_per_s: Vector, navigation: Navigation) -> Residuals:
    """Residuals against the estimated state E*(t) alone (SAT-1). Satellites with half a measurement are left out.

    The clock is found twice: its first estimate corrects the time of reception. InputError without any satellite.
    """
    valid = _valid(epoch, navigation.ephemerides)
    whole = {name: one for name, one in epoch.satellites.items() if name in valid and one.whole()}

    def expected(clock_s: float) -> dict[str, Predicted]:
        at = epoch.time_s - clock_s
        every = {name: predicted(valid[name], at, place, velocity_m_per_s, navigation.ionosphere) for name in whole}
        return {name: one for name, one in every.items() if one.elevation_rad >= MASK_RAD}

    def against(seen: Mapping[str, Predicted]) -> dict[str, float]:
        return {name: whole[name].code() - one.pseudorange_m for name, one in seen.items()}

    seen = expected(common_part(against(expected(0.0))) / LIGHT_M_PER_S)
    codes = against(seen)
    rates = {name: whole[name].rate() - one.rate_m_per_s for name, one in seen.items()}
    return Residuals(without_clock(codes), without_clock(rates), seen, frozenset(epoch.satellites) - valid.keys())


def _valid(epoch: Epoch, ephemerides: Sequence[Ephemeris]) -> dict[str, Ephemeris]:
    found = {name: usable(ephemerides, name, epoch.time_s) for name in epoch.satellites}
    return {name: one for name, one in found.items() if one is not None}
