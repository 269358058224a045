"""Units of whole-number quantities, and enumerations.

A unit is a scale times powers of metre, second and count. Two units are the same if dimension and scale agree: the product
of MM_S and MS is a micrometre, not a millimetre, and has to be converted explicitly.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Unit:
    """A physical unit: `scale` x metre^length x second^time x count^count."""

    name: str
    length: int = 0
    time: int = 0
    count: int = 0
    scale: Fraction = Fraction(1)

    def __hash__(self) -> int:
        """Return a hash without the scale, since hashing a fraction is slow."""
        return hash((self.name, self.length, self.time, self.count))

    def same(self, other: Unit | Enumeration) -> bool:
        """Return whether quantities of both units may be added and compared."""
        if self is other:  # the usual case, without comparing fractions
            return True
        return isinstance(other, Unit) and self.dimension == other.dimension and self.scale == other.scale

    @property
    def dimension(self) -> tuple[int, int, int]:
        """The powers of (metre, second, count)."""
        return (self.length, self.time, self.count)

    def times(self, other: Unit) -> Unit:
        """Return the unit of a product; a unit of NAMED_UNITS if one fits."""
        length, time, count = self.length + other.length, self.time + other.time, self.count + other.count
        scale = self.scale * other.scale
        for unit in NAMED_UNITS:
            if unit.dimension == (length, time, count) and unit.scale == scale:
                return unit
        return Unit(f"{self.name}*{other.name}", length, time, count, scale)


@dataclass(frozen=True, slots=True)
class Enumeration:
    """A finite set of named values, stored as 0, 1, 2 ...; they can be compared for equality only."""

    name: str
    members: tuple[str, ...]

    def same(self, other: Unit | Enumeration) -> bool:
        """Return whether values of both may be compared."""
        return self is other or self == other

    def index(self, member: str) -> int:
        """Return the number of a member; ValueError for an unknown name."""
        return self.members.index(member)


ONE = Unit("1")
COUNT = Unit("count", count=1)
PPM = Unit("ppm", scale=Fraction(1, 10**6))
PER_MILLE = Unit("per mille", scale=Fraction(1, 1000))
NM = Unit("nm", length=1, scale=Fraction(1, 10**9))
UM = Unit("um", length=1, scale=Fraction(1, 10**6))
MM = Unit("mm", length=1, scale=Fraction(1, 1000))
CM = Unit("cm", length=1, scale=Fraction(1, 100))
M = Unit("m", length=1)
US = Unit("us", time=1, scale=Fraction(1, 10**6))
MS = Unit("ms", time=1, scale=Fraction(1, 1000))
S = Unit("s", time=1)
UM_S = Unit("um/s", length=1, time=-1, scale=Fraction(1, 10**6))
MM_S = Unit("mm/s", length=1, time=-1, scale=Fraction(1, 1000))
MM_S2 = Unit("mm/s2", length=1, time=-2, scale=Fraction(1, 1000))
MM_S3 = Unit("mm/s3", length=1, time=-3, scale=Fraction(1, 1000))

NAMED_UNITS = (ONE, COUNT, PPM, PER_MILLE, NM, UM, MM, CM, M, MS, S, UM_S, MM_S, MM_S2, MM_S3)


def per(small: Unit, large: Unit) -> int:
    """Return how many of the smaller unit make one of the larger; ValueError if this is no whole number."""
    ratio = large.scale / small.scale
    if small.dimension != large.dimension or ratio.denominator != 1:
        raise ValueError(f"one {large.name} is no whole number of {small.name}")
    return int(ratio)


NM_PER_UM, NM_PER_MM, UM_PER_MM, MM_PER_M = per(NM, UM), per(NM, MM), per(UM, MM), per(MM, M)
NM_PER_M, UM_PER_M, PPM_PER_ONE = per(NM, M), per(UM, M), per(PPM, ONE)
US_PER_MS, US_PER_S, MS_PER_S = per(US, MS), per(US, S), per(MS, S)
"""Factors between units for plain numbers; terms are converted by `exact_to`, `floor_to` and `ceil_to`."""
