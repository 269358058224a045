"""Outputs of the fibre front end: frozen, in whole numbers, with all bounds rounded outward."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from safeloc.sensing.fibre.axles import Count
from safeloc.sensing.fibre.emitters import Heard
from safeloc.sensing.fibre.sections import Edge, Effect
from safeloc.sensing.rounding import ExactBounds


@dataclass(frozen=True)
class Bounds:
    """Whole numbers that the truth lies between, both included."""

    low: int
    high: int

    @classmethod
    def outward(cls, interval: ExactBounds) -> Bounds:
        """Return the smallest whole bounds around exact ones."""
        return cls(math.floor(interval.low), math.ceil(interval.high))


@dataclass(frozen=True)
class End:
    """One end of a train.

    path_mm             along the fibre's path on the track, over buffers
    fibre_mm            along the cable: Se, by time of flight
    time_of_flight_ps   between pulse and pattern
    points              reflecting points whose reflection coincides with the pattern's end (ZOS); free of drift
    amplitude_cdb       of the pattern there over its normal, rounded to the nearest; None: normal is not known yet
    """

    path_mm: Bounds
    fibre_mm: Bounds
    time_of_flight_ps: Bounds
    points: tuple[str, ...]
    amplitude_cdb: int | None = None


@dataclass(frozen=True)
class SectionSignal:
    """A position signal So.

    effect      of the section on the amplitude; `edge`: what the amplitude did now
    entering    from normal into the section; else back to normal, which is no second section
    leading     at the end in front; else at the rear
    direction   of travel along the fibre: +1 away from the coupler, -1 towards it
    time_ms     of the window in which it was seen
    fibre_mm    Se of that end then: for the comparison that gives F, not for telling which section it is
    length_mm   of the section as run through, when leaving; None when entering, or turned back inside
    section     the only configured section with this effect within the search distance of Se; None: none, or several
    """

    effect: Effect
    edge: Edge
    entering: bool
    leading: bool
    direction: int
    time_ms: int
    fibre_mm: Bounds
    length_mm: Bounds | None
    section: str | None


@dataclass(frozen=True)
class TrainSeen:
    """A train at the block's last frame.

    track       number that it keeps as long as it is followed; `origin`: tracks that joined to, or parted into it
    low, high   its ends, nearer to the coupler and farther along the fibre; None: beyond the fibre
    speed_mm_s  along the fibre, positive away from the coupler
    length_mm   on the track, over buffers; None: an end is beyond the fibre
    count       clusters of axles and axles, as far as counted
    signals     in order of time, since the last block
    """

    track: int
    origin: tuple[int, ...]
    low: End | None
    high: End | None
    speed_mm_s: Bounds
    length_mm: Bounds | None
    count: Count | None
    signals: tuple[SectionSignal, ...]

    @property
    def direction(self) -> int:
        """+1 away from the coupler, -1 towards it, 0 not surely known."""
        return 1 if self.speed_mm_s.low > 0 else -1 if self.speed_mm_s.high < 0 else 0

    @property
    def front(self) -> End | None:
        """The end in front; None where direction or end is not known."""
        return {1: self.high, -1: self.low, 0: None}[self.direction]

    @property
    def rear(self) -> End | None:
        """The end behind; None where direction or end is not known."""
        return {1: self.low, -1: self.high, 0: None}[self.direction]


class Trouble(Enum):
    """Faults of the fibre itself that still allow trains to be detected."""

    END_REFLECTS = "the fibre's end is not absorbed: mirrored trains are possible"
    POINT_MISSING = "a known reflecting point was not found, or not clearly"
    DARK = "some channels get too little light"


@dataclass(frozen=True)
class FibreFrame:
    """One block's result, at its last frame.

    trains   in order along the fibre, nearest to the coupler first
    lost     trains told in the block before and not in this one: silent is not gone; it may come back under its number
             within the hold time
    heard    test patterns that ended in this block
    """

    time_ms: int
    sequence: int
    trains: tuple[TrainSeen, ...]
    lost: tuple[int, ...]
    heard: tuple[Heard, ...]
    troubles: tuple[Trouble, ...]
    missing_points: tuple[str, ...]
