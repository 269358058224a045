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
    """Whole bounds of a quantity, both included."""

    low: int
    high: int

    @classmethod
    def outward(cls, interval: ExactBounds) -> Bounds:
        """Return the smallest whole bounds around exact ones."""
        return cls(math.floor(interval.low), math.ceil(interval.high))


@dataclass(frozen=True)
class End:
    """One end of a train.

    path_mm             place along the fibre's path on the track, over buffers
    fibre_mm            place along the cable: Se, by time of flight
    time_of_flight_ps   time of flight between pulse and pattern
    points              reflecting points whose reflection coincides with the pattern's end (ZOS); free of drift
    amplitude_cdb       amplitude of the pattern there over its normal level, to the nearest; None: level not known yet
    """

    path_mm: Bounds
    fibre_mm: Bounds
    time_of_flight_ps: Bounds
    points: tuple[str, ...]
    amplitude_cdb: int | None = None


@dataclass(frozen=True)
class SectionSignal:
    """A position signal So.

    effect      effect of the section on the amplitude
    edge        the present change of the amplitude
    entering    True: from the normal level into the section; False: back to the normal level, which is no second section
    leading     True: at the front of the train; False: at the rear
    direction   direction of travel along the fibre: +1 away from the coupler, -1 towards it
    time_ms     time of the window with the change
    fibre_mm    Se of that end then: for the comparison that gives F, not to identify the section
    length_mm   run through the section, on leaving; None on entering, or if the train turned back inside
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

    track       number of the train while it is tracked
    origin      tracks that joined to, or parted into, this one
    low, high   ends nearer to the coupler and farther from it; None: beyond the fibre
    speed_mm_s  speed along the fibre, positive away from the coupler
    length_mm   length on the track, over buffers; None: an end is beyond the fibre
    count       counted clusters of axles, and axles; None: not counted
    signals     position signals since the last block, in order of time
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
        """The direction of travel: +1 away from the coupler, -1 towards it, 0 uncertain."""
        return 1 if self.speed_mm_s.low > 0 else -1 if self.speed_mm_s.high < 0 else 0

    @property
    def front(self) -> End | None:
        """The front end; None if direction or end is unknown."""
        return {1: self.high, -1: self.low, 0: None}[self.direction]

    @property
    def rear(self) -> End | None:
        """The rear end; None if direction or end is unknown."""
        return {1: self.low, -1: self.high, 0: None}[self.direction]


class Trouble(Enum):
    """Faults of the fibre itself that still allow trains to be detected."""

    END_REFLECTS = "the fibre's end is not absorbed: mirrored trains are possible"
    POINT_MISSING = "a known reflecting point was not found, or not clearly"
    DARK = "some channels get too little light"


@dataclass(frozen=True)
class FibreFrame:
    """One block's result, at its last frame.

    trains   trains in order along the fibre, nearest to the coupler first
    lost     trains reported in the previous block and not in this one: silent, not gone; a train may return under its
             number within the hold time
    heard    test patterns that ended in this block
    troubles, missing_points   faults of the fibre, and the reflecting points not found
    """

    time_ms: int
    sequence: int
    trains: tuple[TrainSeen, ...]
    lost: tuple[int, ...]
    heard: tuple[Heard, ...]
    troubles: tuple[Trouble, ...]
    missing_points: tuple[str, ...]
