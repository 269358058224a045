"""Creep of a wheel: how much faster or slower its rim turns than the vehicle runs.

A wheel that transmits a force creeps. By Johnson and Vermeulen the share of the adhesion that it uses is 1 - (1 - creep / most)^3 up to the
creep `most`, which grows with adhesion, so that a small force costs the same creep on a wet rail as on a dry one. A wheel that is to
transmit more than the adhesion slips or slides: its creep goes towards what its protection permits, or to 1 where it locks, and back
when the rail holds again.
"""

from __future__ import annotations

import math

import numpy as np

from safeloc.simulation.physics.gauss_markov import Floats

GRAVITY_MM_S2 = 9_810.0
_DRY = 0.33
"""Adhesion of the dry rail, for which the creep at the limit is given."""
_SETTLES_S = 0.3
"""Time in which a wheel comes to its creep [M]."""
_USED = np.linspace(0.0, 1.0, 1_025)
_CREEP = np.array([1.0 - (1.0 - one) ** (1 / 3) for one in _USED.tolist()])


def creep_of(wanted: Floats, adhesion: Floats, at_limit: Floats, sliding: Floats, period_ms: int) -> Floats:
    """Return the creep of wheels in each cycle, array [cycle, vehicle]: above 0 the rim is faster than the vehicle.

    wanted    force that the wheel is to transmit as a share of its load: above 0 it drives, below 0 it brakes
    adhesion  of the rail under it
    at_limit  of each vehicle: creep at which the adhesion of a dry rail is used up
    sliding   of each vehicle: creep to which a wheel comes that is to transmit more than the adhesion
    """
    size = np.abs(wanted)
    used = np.minimum(size / np.maximum(adhesion, 1e-6), 1.0)
    holds = at_limit * np.minimum(adhesion / _DRY, 1.0) * np.interp(used, _USED, _CREEP)
    goal = np.where(size > adhesion, np.maximum(sliding, holds), holds)
    goal = np.asarray(np.where(wanted < 0, -np.minimum(goal, 1.0), goal), dtype=np.float64)
    gain = 1.0 - math.exp(-period_ms / 1_000 / _SETTLES_S)
    found, now = np.empty_like(goal), np.zeros(goal.shape[1])
    for cycle, one in enumerate(goal):
        now = now + (one - now) * gain
        found[cycle] = now
    return found
