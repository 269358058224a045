"""Counts the missed or misread reflectors that make one route look like another (RFL-D6)."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass

NEVER = 10**9


@dataclass(frozen=True)
class Sighting:
    """A sighting on a route: the model of a reflector or, `certain`, the identity of a balise, with its position.

    wider_mm  how much farther than the gate it may lie from where it is expected, since it is placed less accurately
    """

    what: str
    position_mm: int
    identity: str
    certain: bool = False
    wider_mm: int = 0


def faults_towards(
    truth: Sequence[Sighting], believed: Sequence[Sighting], gate_mm: int | None, same_start: bool
) -> int | None:
    """Return the fewest missed or misread sightings that make the true route look like the believed one; None: never.

    gate_mm     places farther apart than this, and what a sighting adds to it, are never confused; None: places are not compared
    same_start  positions count from a common place; otherwise any sighting may be the first of the other route
    """
    least = _faults(truth, believed, gate_mm, same_start)
    return None if least >= NEVER else least


def _faults(truth: Sequence[Sighting], believed: Sequence[Sighting], gate_mm: int | None, same_start: bool) -> int:
    if gate_mm is None or same_start:
        return _aligned(*_without_common_ends(truth, believed), gate_mm, 0)
    if not believed:
        return len(truth)
    shifts = {one.position_mm - believed[0].position_mm for one in truth}
    places = sorted(one.position_mm for one in truth)
    fitting = [shift for shift in shifts if _all_near(places, believed, gate_mm, shift)]
    return min((_aligned(truth, believed, gate_mm, shift) for shift in fitting), default=NEVER)


def _all_near(places: list[int], believed: Sequence[Sighting], gate_mm: int, shift_mm: int) -> bool:
    """Return whether every believed sighting has a true one within the gate; if not, no alignment is possible."""
    for one in believed:
        gate = gate_mm + one.wider_mm
        first = bisect_left(places, one.position_mm + shift_mm - gate)
        if first == len(places) or places[first] > one.position_mm + shift_mm + gate:
            return False
    return True


def _without_common_ends(
    truth: Sequence[Sighting], believed: Sequence[Sighting]
) -> tuple[Sequence[Sighting], Sequence[Sighting]]:
    """Remove equal sightings at both ends of the routes; they do not change the cost."""
    start = 0
    while start < min(len(truth), len(believed)) and truth[start] == believed[start]:
        start += 1
    end = 0
    while end < min(len(truth), len(believed)) - start and truth[-1 - end] == believed[-1 - end]:
        end += 1
    return truth[start : len(truth) - end], believed[start : len(believed) - end]


def _aligned(truth: Sequence[Sighting], believed: Sequence[Sighting], gate_mm: int | None, shift_mm: int) -> int:
    """Return the fewest faults with which the believed route's sightings are among the true route's, in order.

    True sightings without a partner were missed. Every believed sighting needs a partner, because an expected reflector
    that is not found ends the procedure (RFL-D3).
    """
    costs = [0] + [NEVER] * len(believed)
    for seen in truth:
        extended = [costs[0] + 1]
        for index, expected in enumerate(believed):
            taken = costs[index] + _reading(seen, expected, gate_mm, shift_mm)
            extended.append(min(taken, costs[index + 1] + 1, NEVER))
        costs = extended
    return costs[-1]


def _reading(seen: Sighting, expected: Sighting, gate_mm: int | None, shift_mm: int) -> int:
    """Return the faults needed to take a sighting for the expected one: 0 equal, 1 model misread, NEVER impossible."""
    if gate_mm is not None and abs(seen.position_mm - shift_mm - expected.position_mm) > gate_mm + expected.wider_mm:
        return NEVER
    if seen.what == expected.what:
        return 0
    return NEVER if seen.certain or expected.certain else 1


def common_suffix(first: Sequence[Sighting], second: Sequence[Sighting]) -> int:
    """Count the equal sightings at the end."""
    count = 0
    while count < min(len(first), len(second)) and first[-1 - count].what == second[-1 - count].what:
        count += 1
    return count
