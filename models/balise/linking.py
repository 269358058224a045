"""Linking: the groups that the map announces, nearest first, each with the reaction if it is not found.

One announcement may come in a cycle; it is stored until its group is found or given up. Groups are announced only to a
vehicle that has a position, ahead of it and in order; any other announcement is refused, with its reason. The location
accuracy comes from linking, else from the national values, else from the default (SUBSET-026 3.6.4.2.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Num,
    NumVar,
    Optional,
    all_of,
    any_of,
    as_num,
    boolean,
    choice,
    enumeration,
    ite,
    members,
    number,
    optional,
)
from safeloc.language.units import COUNT, MM
from safeloc.models.balise.telegram import ORIENTATION, UNKNOWN, chosen
from safeloc.models.vocabulary.first_of import first_of

LARGEST_ACCURACY_MM = 63_000
REACTION = members("reaction", "NONE", "SERVICE_BRAKE", "TRAIN_TRIP")
NO_REACTION, SERVICE_BRAKE, TRAIN_TRIP = REACTION
ORDER = members("order", "ADD", "REPLACE", "WITHDRAW")
ADD, REPLACE, WITHDRAW = ORDER
_ANNOUNCED = members(
    "announced", "NONE", "TAKEN", "WITHDRAWN", "MALFORMED", "NOT_LOCATED", "FULL", "KNOWN", "BEHIND", "OUT_OF_ORDER"
)
NOTHING, TAKEN, WITHDRAWN, MALFORMED, NOT_LOCATED, FULL, KNOWN, BEHIND, OUT_OF_ORDER = _ANNOUNCED


@dataclass(frozen=True, eq=False)
class Record:
    """One announced group; `group` is 0 where there is none. `accuracy` is valid only where `accurate` holds."""

    group: Num
    place: Num
    accurate: Bool
    accuracy: Num
    reaction: Num
    orientation: Num

    @property
    def held(self) -> Bool:
        """There is a group."""
        return self.group.ne(0)

    def accuracy_or(self, otherwise: Num) -> Num:
        """Return its own location accuracy, else the other one, mm."""
        return ite(self.accurate, self.accuracy, otherwise)


@dataclass(frozen=True, eq=False)
class Slot(Record):
    """State variables that store an announced group."""

    group: NumVar
    place: NumVar
    accurate: BoolVar
    accuracy: NumVar
    reaction: NumVar
    orientation: NumVar


def either(condition: Bool, then: Record, other: Record) -> Record:
    """Return `then` where the condition holds, else `other`."""
    return Record(
        ite(condition, then.group, other.group),
        ite(condition, then.place, other.place),
        ite(condition, then.accurate, other.accurate),
        ite(condition, then.accuracy, other.accuracy),
        ite(condition, then.reaction, other.reaction),
        ite(condition, then.orientation, other.orientation),
    )


EMPTY = Record(as_num(0, COUNT), as_num(0, MM), ~TRUE, as_num(0, MM), NO_REACTION, UNKNOWN)


@dataclass(frozen=True, eq=False)
class Announcement:
    """The inputs of one announcement: ADD appends a group, REPLACE starts a new list with it, WITHDRAW ends linking."""

    order: Optional
    group: Optional
    place: Optional
    accuracy: Optional
    reaction: Optional
    orientation: Optional

    @property
    def inputs(self) -> tuple[Optional, ...]:
        """All inputs."""
        return (self.order, self.group, self.place, self.accuracy, self.reaction, self.orientation)

    @cached_property
    def silent(self) -> Bool:
        """There is no announcement."""
        return ~any_of(one.present for one in self.inputs)

    @cached_property
    def withdraws(self) -> Bool:
        """It ends linking."""
        return self.order.present & self.order.value.eq(WITHDRAW)

    @cached_property
    def replaces(self) -> Bool:
        """It starts a new list."""
        return self.order.present & self.order.value.eq(REPLACE)

    @cached_property
    def well_formed(self) -> Bool:
        """A withdrawal names no group; any other order gives all values that have no default."""
        needed = (self.group, self.place, self.reaction, self.orientation)
        named = all_of(one.present for one in needed)
        bare = ~any_of(one.present for one in (*needed, self.accuracy))
        return self.order.present & ite(self.order.value.eq(WITHDRAW), bare, named)

    @cached_property
    def record(self) -> Record:
        """The announced group; valid only if the announcement is well formed and no withdrawal."""
        given = self.accuracy.present
        return Record(
            self.group.value,
            self.place.value,
            given,
            ite(given, self.accuracy.value, 0),
            self.reaction.value,
            self.orientation.value,
        )


def announcement(declared: Declared, *, last_identity: int, position_limit_mm: int) -> Announcement:
    """Declare the inputs of an announcement, named `linking_...`."""
    return Announcement(
        declared.sensor(chosen("linking_order", ORDER)),
        declared.sensor(optional("linking_group", COUNT, 1, last_identity)),
        declared.sensor(optional("linking_position_mm", MM, -position_limit_mm, position_limit_mm)),
        declared.sensor(optional("linking_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM)),
        declared.sensor(chosen("linking_reaction", REACTION)),
        declared.sensor(chosen("linking_orientation", ORIENTATION)),
    )


def slot(declared: Declared, name: str, *, last_identity: int, position_limit_mm: int) -> Slot:
    """Declare the state of an empty slot, named `name_...`."""
    limit = position_limit_mm
    return Slot(
        declared.state(number(f"{name}_group", COUNT, 0, last_identity), first=0),
        declared.state(number(f"{name}_position_mm", MM, -limit, limit), first=0),
        declared.state(boolean(f"{name}_accuracy_given"), first=False),
        declared.state(number(f"{name}_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM), first=0),
        declared.state(choice(f"{name}_reaction", enumeration(REACTION)), first=NO_REACTION),
        declared.state(choice(f"{name}_orientation", enumeration(ORIENTATION)), first=UNKNOWN),
    )


@dataclass(frozen=True, eq=False)
class National:
    """The national value for the location accuracy.

    national_accuracy     input
    known, stored  state: a value was received, and the last one
    """

    national_accuracy: Optional
    known: BoolVar
    stored: NumVar
    default_mm: int

    @property
    def accuracy(self) -> Num:
        """The location accuracy where linking gives none, mm."""
        default = as_num(self.default_mm, MM)
        return ite(self.national_accuracy.present, self.national_accuracy.value, ite(self.known, self.stored, default))


def national(declared: Declared, default_mm: int) -> National:
    """Declare the national value; none was received yet."""
    return National(
        declared.sensor(optional("national_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM)),
        declared.state(boolean("national_accuracy_known"), first=False),
        declared.state(number("national_accuracy_stored_mm", MM, 0, LARGEST_ACCURACY_MM), first=0),
        default_mm,
    )


@dataclass(frozen=True, eq=False)
class Linking:
    """The announced groups, nearest first; no group is stored behind an empty place.

    offered       inputs: the announcement of the cycle
    last_verdict  state: the verdict on it
    """

    slots: tuple[Slot, ...]
    offered: Announcement
    last_verdict: NumVar

    def advanced(self, by: Sequence[Bool]) -> list[Record]:
        """Return the records without the first `n + 1`, where `by[n]` holds; all of them where none holds."""
        result = []
        for index, one in enumerate(self.slots):
            left: Record = one
            for done, condition in enumerate(by):
                later = index + done + 1
                left = either(condition, self.slots[later] if later < len(self.slots) else EMPTY, left)
            result.append(left)
        return result

    def verdict(self, left: Sequence[Record], passed: Bool) -> Num:
        """Return the verdict on the announcement. `passed`: the vehicle is surely beyond the place of the announced group."""
        offered, record = self.offered, self.offered.record
        appends = ~offered.replaces
        named = any_of(one.held & one.group.eq(record.group) for one in left)
        ahead = all_of(~one.held | (one.place < record.place) for one in left)
        return first_of(
            (offered.silent, NOTHING),
            (~offered.well_formed, MALFORMED),
            (offered.withdraws, WITHDRAWN),
            (passed, BEHIND),
            (appends & left[-1].held, FULL),
            (appends & named, KNOWN),
            (appends & ~ahead, OUT_OF_ORDER),
            default=TAKEN,
        )

    def after(self, left: Sequence[Record], verdict: Num) -> list[Record]:
        """Return the records after the announcement, given those that the cycle leaves."""
        taken = verdict.eq(TAKEN)
        emptied = verdict.eq(WITHDRAWN) | (taken & self.offered.replaces)
        kept = [either(emptied, EMPTY, one) for one in left]
        free = [~one.held for one in kept]
        result = []
        for index, one in enumerate(kept):
            here = taken & free[index] & (~free[index - 1] if index else TRUE)
            result.append(either(here, self.offered.record, one))
        return result


def linking(declared: Declared, slots: int, *, last_identity: int, position_limit_mm: int) -> Linking:
    """Declare the variables of linking: the nearest group is `expected`, the others are `announced_2` and so on."""
    names = ["expected", *(f"announced_{number_}" for number_ in range(2, slots + 1))]
    bounds = {"last_identity": last_identity, "position_limit_mm": position_limit_mm}
    return Linking(
        tuple(slot(declared, name, **bounds) for name in names),
        announcement(declared, **bounds),
        declared.state(choice("linking_last_verdict", enumeration(_ANNOUNCED)), first=NOTHING),
    )
