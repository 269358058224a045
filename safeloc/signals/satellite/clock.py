"""The receiver's clock taken off: what all satellites of an epoch have in common is its bias or drift.

The median's breakdown point is below one half: fewer than half of the satellites, however wrong, move it no farther
than the extremes of the healthy ones. Half or more can take it anywhere: that is an assumption of the selection.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from statistics import median

from safeloc.errors import InputError


def common_part(differences: Mapping[str, float]) -> float:
    """Median of measured minus predicted over the satellites of one epoch. InputError when none or not finite."""
    if not differences:
        raise InputError("no satellite in this epoch: the receiver's clock cannot be taken off; declare no values.")
    wrong = [name for name, value in differences.items() if not math.isfinite(value)]
    if wrong:
        raise InputError(f"measured minus predicted of {', '.join(wrong)} is not finite; leave these out as faults.")
    return median(differences.values())


def without_clock(differences: Mapping[str, float]) -> dict[str, float]:
    """The same differences without their common part."""
    common = common_part(differences)
    return {name: value - common for name, value in differences.items()}
