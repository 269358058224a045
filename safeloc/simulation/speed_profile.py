"""Computes a run from halt to halt with the highest speed that vehicle and line allow.

The speed profile consists of short pieces of constant acceleration, with the vehicle's full acceleration and brake at speed
limits. The vehicle halts exactly (to the nanometre), as stop points need. Jerk is not limited.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.errors import InputError
from safeloc.language.units import NM_PER_MM
from safeloc.sensing.array_types import Floats
from safeloc.simulation.motion import Motion, VehicleConfig, adhesion_mm_s2

_PIECE_MM = 500.0
_MOST_PIECES = 40_000


@dataclass(frozen=True)
class Limit:
    """A speed limit between two places of the way, in mm from its start."""

    from_mm: int
    to_mm: int
    max_speed_mm_s: int


@dataclass(frozen=True)
class Halt:
    """A place where the vehicle stands for some time; it runs backwards to a halt that lies behind."""

    at_mm: int
    stand_s: float
    top_mm_s: int


def drive(vehicle: VehicleConfig, halts: Sequence[Halt], limits: Sequence[Limit], period_ms: int) -> Motion:
    """Drive from standstill at 0 to the last halt; return the true motion. A limit applies until the rear has left it.

    InputError for a limit or a top speed of 0 or less, since the vehicle would never move.
    """
    places, speeds = [np.zeros(0)], [np.zeros(0)]
    here = 0
    for halt in halts:
        if halt.at_mm != here:
            place, speed = _leg(vehicle, here, halt, limits, period_ms / 1_000)
            places.append(place)
            speeds.append(speed)
        rest = np.full(max(1, round(halt.stand_s * 1_000 / period_ms)), float(halt.at_mm))
        places.append(rest)
        speeds.append(np.zeros(len(rest)))
        here = halt.at_mm
    position = np.rint(np.concatenate(places) * NM_PER_MM).astype(np.int64)
    return Motion(period_ms, position, np.concatenate(speeds), 0)


def _leg(
    vehicle: VehicleConfig, start_mm: int, halt: Halt, limits: Sequence[Limit], period_s: float
) -> tuple[Floats, Floats]:
    """Return places (mm) and speeds (mm/s) at the end of every cycle of the run to a halt."""
    distance, sign = abs(halt.at_mm - start_mm), (1 if halt.at_mm > start_mm else -1)
    nodes = np.linspace(0.0, distance, min(_MOST_PIECES, max(2, math.ceil(distance / _PIECE_MM))) + 1)
    caps = _caps(vehicle, start_mm + sign * nodes, min(halt.top_mm_s, vehicle.max_speed_mm_s), limits)
    if caps.min() <= 0:
        raise InputError(f"{halt}: a speed limit of 0 on the way to it makes it unreachable.")
    squares = _within(caps**2, distance / (len(nodes) - 1), *_rates(vehicle))
    speeds = np.sqrt(squares)
    lengths = np.diff(nodes)
    times = np.concatenate([[0.0], np.cumsum(2 * lengths / (speeds[:-1] + speeds[1:]))])
    asked = np.arange(1, math.ceil(times[-1] / period_s)) * period_s
    piece = np.searchsorted(times, asked, side="right") - 1
    spent, rate = asked - times[piece], (np.diff(squares) / (2 * lengths))[piece]
    run = nodes[piece] + speeds[piece] * spent + rate * spent**2 / 2
    return start_mm + sign * run, sign * (speeds[piece] + rate * spent)


def _caps(vehicle: VehicleConfig, places: Floats, top_mm_s: int, limits: Sequence[Limit]) -> Floats:
    """Return the highest speed at every place. A limit is extended by half a piece at both ends, so that none is skipped."""
    caps, margin = np.full(len(places), float(top_mm_s)), abs(places[1] - places[0]) / 2
    for limit in limits:
        inside = (places >= limit.from_mm - margin) & (places <= limit.to_mm + vehicle.length_mm + margin)
        caps[inside] = np.minimum(caps[inside], limit.max_speed_mm_s)
    return caps


def _rates(vehicle: VehicleConfig) -> tuple[float, float]:
    """Return acceleration and brake (mm/s2), limited by adhesion at the highest speed."""
    rails = adhesion_mm_s2(vehicle, vehicle.max_speed_mm_s)
    return min(vehicle.acceleration_mm_s2, rails), min(vehicle.brake_mm_s2, rails)


def _within(squares: Floats, piece_mm: float, acceleration: float, brake: float) -> Floats:
    """Return squared speeds at the nodes, from standstill to standstill, within acceleration and brake."""
    found = squares.copy()
    found[0] = found[-1] = 0.0
    for node in range(1, len(found)):
        found[node] = min(found[node], found[node - 1] + 2 * acceleration * piece_mm)
    for node in range(len(found) - 2, -1, -1):
        found[node] = min(found[node], found[node + 1] + 2 * brake * piece_mm)
    return found
