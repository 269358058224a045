"""The receiver's clock taken off: what all satellites of an epoch have in common is its bias or drift.

The median's breakdown point is below one half: fewer than half of the satellites, however wrong, move it no farther
than the extremes of the healthy ones. Half or more can take it anywhere: that is an assumption of the selection. Each
constellation has a median of its own, and so a breakdown point of its own; a single satellite of one is always its own
median, and has no share in a solution.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from statistics import median

from safeloc.errors import InputError


def common_part(differences: Mapping[str, float]) -> float:
    """Return the median of measured minus predicted over the satellites of one epoch. InputError when none or not finite."""
    if not differences:
        raise InputError("no satellite in this epoch: the receiver's clock cannot be taken off; declare no values.")
    wrong = [name for name, value in differences.items() if not math.isfinite(value)]
    if wrong:
        raise InputError(f"measured minus predicted of {', '.join(wrong)} is not finite; leave these out as faults.")
    return median(differences.values())


def without_clock(differences: Mapping[str, float]) -> dict[str, float]:
    """Return the same differences without the common part of their constellation, named by the first letter."""
    common = {system: common_part(of_constellation(differences, system)) for system in constellations(differences)}
    return {name: value - common[name[0]] for name, value in differences.items()}


def constellations(satellites: Iterable[str]) -> list[str]:
    """Return the constellations of these satellites: each keeps a time of its own, and so has a clock term of its own."""
    return sorted({name[0] for name in satellites})


def of_constellation(differences: Mapping[str, float], system: str) -> dict[str, float]:
    """Return the values of one constellation."""
    return {name: value for name, value in differences.items() if name[0] == system}
