"""A reader at one end of the vehicle, and what a marker reading says of the vehicle's position.

A marker is known by its identity; the map gives its place. An identity without a place is foreign (not on this
line). Marker information may also come from satellites (MRK-D6): a virtual marker with its own, coarser accuracy.

The position that is kept is that of end A (the front reader). A reading at end B adds the vehicle length and its
tolerance. What was run between passing the marker and the end of the cycle (`since`) moves the position; what is
not known of it (reader latency) widens the side the vehicle runs to, by what it may really have run in that time.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import (
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    abs_,
    any_of,
    as_num,
    between,
    choice,
    exact_to,
    ite,
    maximum,
    members,
    optional,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, PPM, PPM_PER_ONE, Enumeration
from safeloc.models.odometry.distance_device import Cycle, Values

READING = members(
    "reading",
    "NONE",
    "ACCEPTED",
    "CANDIDATE",
    "NOT_BETTER",
    "MALFORMED",
    "FOREIGN",
    "REPEATED",
    "OUT_OF_ORDER",
    "UNPAIRED",
    "UNCONFIRMED",
    "TOO_COARSE",
    "OUT_OF_WINDOW",
)
(
    NONE,
    ACCEPTED,
    CANDIDATE,
    NOT_BETTER,
    MALFORMED,
    FOREIGN,
    REPEATED,
    OUT_OF_ORDER,
    UNPAIRED,
    UNCONFIRMED,
    TOO_COARSE,
    OUT_OF_WINDOW,
) = READING


@dataclass(frozen=True, eq=False)
class Reader:
    """A marker reader: the inputs of one reading and the verdict on it.

    offset, offset_tolerance_mm: where end A is when this reader stands over a place (the vehicle length at end B), mm.
    unsteady_nm: what a changing speed adds to the run in the reader's latency, and to that in the whole cycle.
    """

    name: str
    marker: Optional
    place: Optional
    accuracy: Optional
    since: Optional
    verdict: NumVar
    offset: Num
    offset_tolerance_mm: int
    accuracy_mm: int
    latency_ppm: int
    since_ppm: int
    unsteady_nm: tuple[int, int]

    @property
    def inputs(self) -> tuple[Optional, ...]:
        """The inputs of one reading: identity, place, accuracy of the place, distance run since."""
        return (self.marker, self.place, self.accuracy, self.since)

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values."""
        return {self.verdict: NONE}

    @property
    def known(self) -> Bool:
        """A marker of this line was read."""
        return self.marker.present & self.place.present

    def flaw(self) -> tuple[Bool, Bool]:
        """(malformed, foreign): data without an identity, and an identity without a place."""
        data = self.place.present | self.accuracy.present | self.since.present
        return (~self.marker.present & data, self.marker.present & ~self.place.present)


def reader(name: str, *, offset: Num, offset_tolerance_mm: int, accuracy_mm: int, latency_ppm: int, since_ppm: int,
           unsteady_nm: tuple[int, int], position_limit_mm: int, max_step_mm: int, last_identity: int) -> Reader:  # fmt: skip
    """A reader with fresh variables named `name_marker...`."""
    verdicts = READING[0].unit
    assert isinstance(verdicts, Enumeration)
    return Reader(
        name,
        optional(f"{name}_marker", COUNT, 1, last_identity),
        optional(f"{name}_marker_position_mm", MM, -position_limit_mm, position_limit_mm),
        optional(f"{name}_marker_accuracy_mm", MM, 0, 1_000_000),
        optional(f"{name}_marker_since_mm", MM, -max_step_mm, max_step_mm),
        choice(f"{name}_reading", verdicts),
        offset,
        offset_tolerance_mm,
        accuracy_mm,
        latency_ppm,
        since_ppm,
        unsteady_nm,
    )


@dataclass(frozen=True, eq=False)
class Fix:
    """What a reading says of end A at the end of the cycle: truth in [position - below, position + above], nm."""

    position: Num
    above: Num
    below: Num

    def values(self, wander_nm: int, tolerance_nm: int, limit_mm: int) -> Values:
        """The fix as a unit's new values: its one-off constant is charged from the start."""
        above, below = self.above + 2 * wander_nm, self.below + 2 * wander_nm
        usable = (maximum(above, below) <= tolerance_nm) & between(-limit_mm, self.position, limit_mm)
        return Values(usable, self.position, above, below)

    def meets(self, values: Values) -> Bool:
        """Whether the fix and the interval of `values` have a point in common."""
        centre = exact_to(self.position, NM)
        return (centre - self.below <= values.high) & (values.low <= centre + self.above)


def fix(reader: Reader, moved: Cycle) -> Fix:
    """The fix of this cycle's reading, given what the device at the same end measured in the cycle."""
    since = reader.since.value_or(as_num(0, MM))
    late, untimed = moved.farthest(reader.latency_ppm), moved.farthest(PPM_PER_ONE)
    slack, whole = reader.unsteady_nm
    forth, back = (
        ite(reader.since.present, one + slack, other + whole) for one, other in zip(late, untimed, strict=True)
    )
    accuracy = exact_to(reader.accuracy.value_or(as_num(reader.accuracy_mm, MM)), NM)
    own = accuracy + abs_(since) * Lit(reader.since_ppm, PPM) + reader.offset_tolerance_mm * NM_PER_MM
    return Fix(reader.place.value + since + reader.offset, own + forth, own + back)


# ------------------------------------------------------------------ identities that wait for the trailing reader


@dataclass(frozen=True, eq=False)
class Pending:
    """Identities read by the leading reader and not yet by the trailing one, oldest first; 0 is an empty place.

    The queue is bounded: when it is full the oldest identity is given up, and its trailing reading is then unpaired.
    """

    places: tuple[NumVar, ...]

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values."""
        return dict.fromkeys(self.places, 0)

    def has(self, marker: Num) -> Bool:
        """Whether the identity is waited for."""
        return any_of(place.eq(marker) for place in self.places)

    def after(self, passed: Bool, trailing: Num, read: Bool, leading: Num, keep: Bool) -> dict[Var, Expr]:
        """The queue after a trailing match (it and all older ones leave), then a leading reading (it joins)."""
        left = self._without(passed, trailing)
        full = left[-1].ne(0)
        joined: list[Num] = []
        for index, place in enumerate(left):
            older_filled = left[index - 1].ne(0) if index else as_num(0, COUNT).eq(0)
            shifted = left[index + 1] if index + 1 < len(left) else leading
            appended = ite(place.eq(0) & older_filled, leading, place)
            joined.append(ite(read, ite(full, shifted, appended), place))
        return {place: ite(keep, value, 0) for place, value in zip(self.places, joined, strict=True)}

    def _without(self, passed: Bool, trailing: Num) -> list[Num]:
        result: list[Num] = []
        empty: Num = as_num(0, COUNT)
        for index, place in enumerate(self.places):
            value: Num = place
            for match in range(len(self.places)):
                source = index + match + 1
                moved = self.places[source] if source < len(self.places) else empty
                value = ite(passed & self.places[match].eq(trailing), moved, value)
            result.append(value)
        return result
