"""A position of satellites as marker information (MRK-D6), and what it says of the vehicle's position.

It is the place of end A at the end of the cycle, with how far the true place may lie to either side. A machine that checks the
receiver, such as `guard`, gives it. It has no identity, waits for no trailing reader and says nothing of the markers that were read.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    BoolVar,
    NumVar,
    Optional,
    as_num,
    boolean,
    choice,
    enumeration,
    exact_to,
    number,
    optional,
)
from safeloc.language.units import MM, NM
from safeloc.models.odometry.marker_reading import NONE, READING, Fix

WIDEST_MM = 1_000_000
"""The greatest margin that is taken as an input, as of a marker's accuracy."""


@dataclass(frozen=True, eq=False)
class SatelliteReader:
    """The device that gives positions of satellites.

    place, below, above   inputs: place of end A at the end of the cycle; how far its true place may lie below it, and above
    verdict               state: the verdict on the cycle's position
    candidate_of_satellites        state: the candidate is a position of satellites, which no other one of them confirms; None where
                                   the first reference is trusted, so that nothing is a candidate
    """

    place: Optional
    below: NumVar
    above: NumVar
    verdict: NumVar
    candidate_of_satellites: BoolVar | None

    @property
    def fix(self) -> Fix:
        """The place of end A by the cycle's position; nothing is run after it."""
        below, above = exact_to(self.below, NM), exact_to(self.above, NM)
        return Fix(self.place.value, above, below, as_num(0, NM))


def satellite_reader(declared: Declared, position_limit_mm: int, *, trusted: bool) -> SatelliteReader:
    """Declare the variables of what gives the positions of satellites; a place beyond the line is read, and refused.

    trusted  the first reference is trusted
    """
    beyond = 2 * position_limit_mm
    return SatelliteReader(
        place=declared.sensor(optional("satellite_position_mm", MM, -beyond, beyond)),
        below=declared.sensor(number("satellite_margin_below_mm", MM, 0, WIDEST_MM)),
        above=declared.sensor(number("satellite_margin_above_mm", MM, 0, WIDEST_MM)),
        verdict=declared.state(choice("satellite_reading", enumeration(READING)), first=NONE),
        candidate_of_satellites=None if trusted else declared.state(boolean("candidate_of_satellites"), first=False),
    )
