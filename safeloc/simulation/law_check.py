"""Checks that a simulated unit obeys its error law, in exact whole nanometres against the true motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safeloc.language.units import NM_PER_MM
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import Distances, ErrorFigures


@dataclass(frozen=True)
class Breach:
    """The first cycle (from 0) in which a unit breaks its law, with its error and the allowed error in nm."""

    unit: str
    cycle: int
    off_nm: int
    allowed_nm: int


def first_breach(motion: Motion, law: ErrorFigures, unit: Distances) -> Breach | None:
    """Return the first cycle in which the wander leaves its band or the drift exceeds floor and rate; None if there is none.

    In a cycle without a measurement the drift is not checked; the wander must not change.
    """
    half = law.constant_mm * NM_PER_MM // 2
    moved = np.diff(unit.wander_nm, prepend=np.int64(0))
    drift = np.abs(motion.distance_nm - unit.distance_mm * NM_PER_MM - moved)
    knee = law.knee_mm_s * motion.period_ms // 1000
    growth = np.maximum(np.abs(unit.distance_mm) - knee, 0) * law.rate_ppm + law.floor_mm_s * motion.period_ms * 1000
    off = np.where(unit.present, drift, np.abs(moved))
    allowed = np.where(unit.present, growth, 0)
    strays = np.abs(unit.wander_nm) > half
    breaches = np.flatnonzero(strays | (off > allowed))
    if not len(breaches):
        return None
    cycle = int(breaches[0])
    if strays[cycle]:
        return Breach(unit.name, cycle, abs(int(unit.wander_nm[cycle])), half)
    return Breach(unit.name, cycle, int(off[cycle]), int(allowed[cycle]))
