"""Removes the receiver's clock: the bias or drift common to all satellites of an epoch, taken as the median.

If fewer than half of the satellites are wrong, the median stays within the extremes of the healthy ones, however wrong the
others are. Half or more could move it anywhere; the selection assumes that this does not happen. This applies to each
constellation with its own median. The only satellite of a constellation is its own median, and has no share in a solution.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from statistics import median

from safeloc.errors import InputError


def common_part(differences: Mapping[str, float]) -> float:
    """Return the median of measured minus predicted over the satellites of one epoch. InputError without satellites, or for a value that is not finite."""
    if not differences:
        raise InputError("no satellite in this epoch: the receiver's clock cannot be removed; declare no values.")
    wrong = [name for name, value in differences.items() if not math.isfinite(value)]
    if wrong:
        raise InputError(f"measured minus predicted of {', '.join(wrong)} is not finite; remove these as faults.")
    return median(differences.values())


def without_clock(differences: Mapping[str, float]) -> dict[str, float]:
    """Return the differences minus the common part of their constellation (the first letter of a name)."""
    common = {system: common_part(of_constellation(differences, system)) for system in constellations(differences)}
    return {name: value - common[name[0]] for name, value in differences.items()}


def constellations(satellites: Iterable[str]) -> list[str]:
    """Return the constellations of these satellites. Each has its own time scale, and so its own clock term."""
    return sorted({name[0] for name in satellites})


def of_constellation(differences: Mapping[str, float], system: str) -> dict[str, float]:
    """Return the values of one constellation."""
    return {name: value for name, value in differences.items() if name[0] == system}
