"""Linking: the groups that the map announces, nearest first, each with what to do if it is not found.

Announcements come one a cycle and are held until their group is found or given up. Groups are announced only to a
vehicle that has a position, ahead of it and in order; what breaks that is refused with its reason. The location
accuracy comes from linking, else from the national values, else from the default (SUBSET-026 3.6.4.2.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
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
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM
from safeloc.models.balise.telegram import ORIENTATION, UNKNOWN, chosen
from safeloc.models.vocabulary.first_of import first_of

LARGEST_ACCURACY_MM = 63_000
REACTION = members("reaction", "NONE", "SERVICE_BRAKE", "TRAIN_TRIP")
NO_REACTION, SERVICE_BRAKE, TRAIN_TRIP = REACTION
ORDER = members("order", "ADD", "REPLACE", "WITHDRAW")
ADD, REPLACE, WITHDRAW = ORDER
ANNOUNCED = members(
    "announced", "NONE", "TAKEN", "WITHDRAWN", "MALFORMED", "NOT_LOCATED", "FULL", "KNOWN", "BEHIND", "OUT_OF_ORDER"
)
NOTHING, TAKEN, WITHDRAWN, MALFORMED, NOT_LOCATED, FULL, KNOWN, BEHIND, OUT_OF_ORDER = ANNOUNCED


@dataclass(frozen=True, eq=False)
class Record:
    """One announced group; `group` is 0 where there is none. `accuracy` counts only where it is `accurate`."""

    group: Num
    place: Num
    accurate: Bool
    accuracy: Num
    reaction: Num
    orientation: Num

    @property
    def held(self) -> Bool:
        """There is one."""
        return self.group.ne(0)

    def accuracy_or(self, otherwise: Num) -> Num:
        """Its own location accuracy, else the other one."""
        return ite(self.accurate, self.accuracy, otherwise)

    def become(self, other: Record) -> dict[Var, Expr]:
        """Updates that make the other record its own, of a record whose fields are variables."""
        own, new = self._fields(), other._fields()
        return {var: term for var, term in zip(own, new, strict=True) if isinstance(var, Var)}

    def _fields(self) -> tuple[Expr, ...]:
        return (self.group, self.place, self.accurate, self.accuracy, self.reaction, self.orientation)


def either(condition: Bool, then: Record, other: Record) -> Record:
    """`then` where the condition holds, else `other`."""
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
    """The inputs of one announcement. ADD appends a group, REPLACE starts a new list with it, WITHDRAW ends linking."""

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
        """Nothing is announced."""
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
        """A withdrawal names no group; any other order says everything that has no default."""
        needed = (self.group, self.place, self.reaction, self.orientation)
        named = all_of(one.present for one in needed)
        bare = ~any_of(one.present for one in (*needed, self.accuracy))
        return self.order.present & ite(self.order.value.eq(WITHDRAW), bare, named)

    @cached_property
    def record(self) -> Record:
        """What it announces; meaningful only where it is well formed and no withdrawal."""
        given = self.accuracy.present
        return Record(
            self.group.value,
            self.place.value,
            given,
            ite(given, self.accuracy.value, 0),
            self.reaction.value,
            self.orientation.value,
        )


def announcement(*, last_identity: int, position_limit_mm: int) -> Announcement:
    """An announcement with fresh variables named `linking_...`."""
    return Announcement(
        chosen("linking_order", ORDER),
        optional("linking_group", COUNT, 1, last_identity),
        optional("linking_position_mm", MM, -position_limit_mm, position_limit_mm),
        optional("linking_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM),
        chosen("linking_reaction", REACTION),
        chosen("linking_orientation", ORIENTATION),
    )


def slot(name: str, *, last_identity: int, position_limit_mm: int) -> Record:
    """A record of fresh state variables named `name_...`."""
    return Record(
        number(f"{name}_group", COUNT, 0, last_identity),
        number(f"{name}_position_mm", MM, -position_limit_mm, position_limit_mm),
        boolean(f"{name}_accuracy_given"),
        number(f"{name}_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM),
        choice(f"{name}_reaction", enumeration(REACTION)),
        choice(f"{name}_orientation", enumeration(ORIENTATION)),
    )


@dataclass(frozen=True, eq=False)
class National:
    """The national value for the location accuracy, as far as one was received."""

    received: Optional
    known: BoolVar
    kept: NumVar
    default_mm: int

    @property
    def accuracy(self) -> Num:
        """The location accuracy where linking gives none, mm."""
        default = as_num(self.default_mm, MM)
        return ite(self.received.present, self.received.value, ite(self.known, self.kept, default))

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: none was received."""
        return {self.known: False, self.kept: 0}

    def listen(self) -> dict[Var, Expr]:
        """Updates of every cycle."""
        kept = ite(self.received.present, self.received.value, self.kept)
        return {self.known: self.known | self.received.present, self.kept: kept}


def national(default_mm: int) -> National:
    """National values with fresh variables."""
    received = optional("national_accuracy_mm", MM, 0, LARGEST_ACCURACY_MM)
    kept = number("national_accuracy_kept_mm", MM, 0, LARGEST_ACCURACY_MM)
    return National(received, boolean("national_accuracy_known"), kept, default_mm)


@dataclass(frozen=True, eq=False)
class Linking:
    """The announced groups, nearest first. No group is held behind an empty place."""

    slots: tuple[Record, ...]
    offered: Announcement
    judged: NumVar

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: nothing is announced."""
        empty: dict[Var, Initial] = {}
        for one in self.slots:
            for var, term in one.become(EMPTY).items():
                empty[var] = False if isinstance(var, BoolVar) else term.value if isinstance(term, Lit) else 0
        return {**empty, self.judged: NOTHING}

    def become(self, records: Sequence[Record]) -> dict[Var, Expr]:
        """Updates that make the records its own."""
        updates: dict[Var, Expr] = {}
        for one, record in zip(self.slots, records, strict=True):
            updates |= one.become(record)
        return updates

    def forget(self) -> dict[Var, Expr]:
        """Updates after which nothing is announced."""
        return self.become([EMPTY] * len(self.slots))

    def advanced(self, by: Sequence[Bool]) -> list[Record]:
        """The records left when the first `n + 1` are done with, where `by[n]` holds; all of them where none does."""
        result = []
        for index, one in enumerate(self.slots):
            left = one
            for done, condition in enumerate(by):
                later = index + done + 1
                left = either(condition, self.slots[later] if later < len(self.slots) else EMPTY, left)
            result.append(left)
        return result

    def verdict(self, left: Sequence[Record], passed: Bool) -> Num:
        """What becomes of the announcement. `passed`: the vehicle is surely beyond the place of the announced group."""
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
        """The records after the announcement, given those that are left of the cycle."""
        taken = verdict.eq(TAKEN)
        emptied = verdict.eq(WITHDRAWN) | (taken & self.offered.replaces)
        kept = [either(emptied, EMPTY, one) for one in left]
        free = [~one.held for one in kept]
        result = []
        for index, one in enumerate(kept):
            here = taken & free[index] & (~free[index - 1] if index else TRUE)
            result.append(either(here, self.offered.record, one))
        return result


def linking(slots: int, *, last_identity: int, position_limit_mm: int) -> Linking:
    """Linking with fresh variables: the nearest group is `expected`, the others are `announced_2` and so on."""
    names = ["expected", *(f"announced_{number_}" for number_ in range(2, slots + 1))]
    bounds = {"last_identity": last_identity, "position_limit_mm": position_limit_mm}
    return Linking(
        tuple(slot(name, **bounds) for name in names),
        announcement(**bounds),
        choice("linking_judged", enumeration(ANNOUNCED)),
    )
