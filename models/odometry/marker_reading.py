"""A reader at one end of the vehicle, and what a marker reading says of the vehicle's position.

A marker has an identity; the map gives its place. An identity without a place is foreign (not on this line). A marker may
also be a virtual one from satellites (MRK-D6), with its own, coarser accuracy.

The position is that of end A (the front reader). A reading at end B adds the vehicle length and its tolerance. The
distance run between the marker and the end of the cycle (`since`) moves the position; the reader's latency widens the
interval on the side to which the vehicle runs, by the distance that it may have run in that time.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    NumVar,
    Optional,
    abs_,
    any_of,
    as_num,
    between,
    choice,
    enumeration,
    exact_to,
    ite,
    members,
    number,
    optional,
)
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, PPM, PPM_PER_ONE
from safeloc.models.odometry.distance_device import Cycle, Values
from safeloc.models.vocabulary.interval import Interval

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
    """A marker reader.

    marker, place, accuracy, since   inputs: identity, place on the map with its accuracy, distance run since the marker
    verdict                          state: the verdict on the cycle's reading
    offset, offset_tolerance_mm      distance of end A from a place that this reader is over, mm: the vehicle length at end B
    unsteady_nm                      what a change of speed adds to the run in the latency, and to that in the whole cycle
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

    @property
    def known(self) -> Bool:
        """The reader read a marker of this line."""
        return self.marker.present & self.place.present

    def flaw(self) -> tuple[Bool, Bool]:
        """Return whether the reading is malformed (data without an identity), and whether it is foreign (no place)."""
        data = self.place.present | self.accuracy.present | self.since.present
        return (~self.marker.present & data, self.marker.present & ~self.place.present)


def reader(declared: Declared, name: str, *, offset: Num, offset_tolerance_mm: int, accuracy_mm: int, latency_ppm: int,
           since_ppm: int, unsteady_nm: tuple[int, int], position_limit_mm: int, max_cycle_distance_mm: int,
           last_identity: int) -> Reader:  # fmt: skip
    """Declare the variables of a reader, named `name_marker...`."""
    return Reader(
        name,
        marker=declared.sensor(optional(f"{name}_marker", COUNT, 1, last_identity)),
        place=declared.sensor(optional(f"{name}_marker_position_mm", MM, -position_limit_mm, position_limit_mm)),
        accuracy=declared.sensor(optional(f"{name}_marker_accuracy_mm", MM, 0, 1_000_000)),
        since=declared.sensor(optional(f"{name}_marker_since_mm", MM, -max_cycle_distance_mm, max_cycle_distance_mm)),
        verdict=declared.state(choice(f"{name}_reading", enumeration(READING)), first=NONE),
        offset=offset,
        offset_tolerance_mm=offset_tolerance_mm,
        accuracy_mm=accuracy_mm,
        latency_ppm=latency_ppm,
        since_ppm=since_ppm,
        unsteady_nm=unsteady_nm,
    )


@dataclass(frozen=True, eq=False)
class Fix(Interval):
    """The place of end A (in mm) at the end of the cycle by one reading.

    unseen_nm  how much farther the vehicle may have run since the reading than the device at that end measured
    """

    unseen_nm: Num

    def fits(self, reference: Interval) -> Bool:
        """Return whether the reading may be true while the reference holds the truth.

        The one-off part of a unit's error may change by the whole constant within a cycle. The constant that is added to
        the values which the reading sets covers that; the reference may be of a device whose error has a part of its own.
        """
        return self.widened(self.unseen_nm).meets(reference)

    def values(self, wander_nm: int, tolerance_nm: int, limit_mm: int) -> Values:
        """Return the values of a unit that the reading sets: its one-off constant counts from the start."""
        own = self.widened(2 * wander_nm)
        usable = (own.margin <= tolerance_nm) & between(-limit_mm, own.position, limit_mm)
        return Values(own.position, own.above, own.below, usable)


def fix(reader: Reader, moved: Cycle) -> Fix:
    """Return the fix by the cycle's reading, given the distances that the device at that end measured in the cycle."""
    since = reader.since.value_or(as_num(0, MM))
    late, untimed = moved.farthest(reader.latency_ppm), moved.farthest(PPM_PER_ONE)
    slack, in_cycle = reader.unsteady_nm
    forth, back = (
        ite(reader.since.present, one + slack, other + in_cycle) for one, other in zip(late, untimed, strict=True)
    )
    accuracy = exact_to(reader.accuracy.value_or(as_num(reader.accuracy_mm, MM)), NM)
    own = accuracy + abs_(since) * Lit(reader.since_ppm, PPM) + reader.offset_tolerance_mm * NM_PER_MM
    constant_nm = 2 * min(unit.start_wander_nm(moved.device) for unit in moved.device.units)
    in_latency_nm = -(-constant_nm * reader.latency_ppm // PPM_PER_ONE)
    unseen_nm = ite(reader.since.present, as_num(in_latency_nm, NM), as_num(constant_nm, NM))
    return Fix(reader.place.value + since + reader.offset, own + forth, own + back, unseen_nm)


# ------------------------------------------------------------------ identities that wait for the trailing reader


@dataclass(frozen=True, eq=False)
class Pending:
    """Identities that the leading reader has read and the trailing one has not yet, oldest first; 0 is an empty place.

    A full queue gives up its oldest identity; the trailing reading of that marker is then unpaired.
    """

    places: tuple[NumVar, ...]

    def has(self, marker: Num) -> Bool:
        """Return whether the identity is in the queue."""
        return any_of(place.eq(marker) for place in self.places)

    def after(self, passed: Bool, trailing: Num, read: Bool, leading: Num, keep: Bool) -> list[Num]:
        """Return the queue after a trailing match (it and all older ones leave), then a leading reading (it joins).

        Without `keep` it is empty.
        """
        left = self._without(passed, trailing)
        full = left[-1].ne(0)
        joined: list[Num] = []
        for index, place in enumerate(left):
            older_filled = left[index - 1].ne(0) if index else as_num(0, COUNT).eq(0)
            shifted = left[index + 1] if index + 1 < len(left) else leading
            appended = ite(place.eq(0) & older_filled, leading, place)
            joined.append(ite(read, ite(full, shifted, appended), place))
        return [ite(keep, value, 0) for value in joined]

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


def pending(declared: Declared, length: int, last_identity: int) -> Pending:
    """Declare the variables of an empty queue."""
    names = (f"pending_{place}" for place in range(1, length + 1))
    return Pending(tuple(declared.state(number(name, COUNT, 0, last_identity), first=0) for name in names))
