"""Entry of a train into the area, its reference, and its complete exit (FVA-2, FVA-D1; figures, 003 items 3 and 14).

    OUTSIDE  the train is not in the area
    AWAITED  it was counted in; its reference has to come within `record_wait_cycles`
    TOLD     its reference came
    MISSING  its reference did not come in time

A reference is an axle counter's record, or the record handed over by the neighbouring area. It is due in the cycle in
which it comes, or in which it is overdue; then its sender is NOBODY. The verification accepts or refuses it.

A train has left when the counters report its exit and as many of its axles were counted out as in since it entered, in every
cycle by undisturbed counters. If fewer axles leave, the train has left a part behind: its exit is not passed on until the
rest is counted out too. The area also clears the train when undisturbed counters report an empty area.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Lit,
    Num,
    NumVar,
    Optional,
    as_num,
    between,
    boolean,
    choice,
    enumeration,
    ite,
    number,
    optional,
)
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT
from safeloc.language.world import Law
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, EVENT, LEAVES_HIGH, LEAVES_LOW, NO_EVENT
from safeloc.models.verification.variables import AXLE_COUNTER, FROM, NEIGHBOUR, NOBODY

REQUIREMENTS = ("FVA-2", "FVA-11", "FVA-D1")


@dataclass(frozen=True, eq=False)
class Entry:
    """The machine and its variables.

    event   the axle counters at both ends: this train enters, or its running part has left
    comes   sender of the reference that comes for this train in this cycle; NOBODY: none comes
    axles_in, axles_out  axles of the train that the counters at both ends counted in this cycle, into the area and out of it;
                         absent while a counter is disturbed
    waited  cycles since it was counted in without a reference
    due, source  messages to the verification
    inside, sure  axles counted in and not out again; no count of them was missed
    left, in_part  in this cycle the whole train has left; a part of it left, and axles are still inside
    true_axles_inside   ghost: the train's axles in the area, with every part that it lost
    """

    machine: Machine
    event: NumVar
    comes: NumVar
    axles_in: Optional
    axles_out: Optional
    waited: NumVar
    due: BoolVar
    source: NumVar
    inside: NumVar
    sure: BoolVar
    left: BoolVar
    in_part: BoolVar
    true_axles_inside: NumVar
    next_inside: NumVar

    @property
    def leaves(self) -> Bool:
        """All of the train has left in this cycle."""
        return self.left

    @property
    def passed_on(self) -> Num:
        """The event for the area: a train that left a part behind has not left."""
        leaving = self.event.one_of(LEAVES_LOW, LEAVES_HIGH)
        return ite(leaving & ~self.left, NO_EVENT, self.event)


@dataclass(frozen=True, eq=False)
class EntryInputs:
    """The inputs, and the balance of axles before the cycle."""

    event: NumVar
    comes: NumVar
    axles_in: Optional
    axles_out: Optional
    inside: NumVar
    sure: BoolVar
    in_part: BoolVar

    @property
    def leaving(self) -> Bool:
        """The counters report that the running part of the train has left."""
        return self.event.one_of(LEAVES_LOW, LEAVES_HIGH)

    @property
    def enters(self) -> Bool:
        """The train is counted in."""
        return self.event.one_of(ENTERS_LOW, ENTERS_HIGH)

    @property
    def balance(self) -> Num:
        """Axles counted in and not out; of a train that enters, counted from zero."""
        return ite(self.enters, 0, self.inside) + self.axles_in.value - self.axles_out.value

    @property
    def counted(self) -> Bool:
        """The balance is sure after the cycle."""
        counted_now = self.axles_in.present & self.axles_out.present & between(0, self.balance, self.inside.high)
        return (self.enters | self.sure) & counted_now

    @property
    def complete(self) -> Bool:
        """Every axle that came in is out."""
        return self.leaving & self.counted & self.balance.eq(0)


def entry(wait_cycles: int, axle_limit: int) -> Entry:
    """Return the machine of one train of up to `axle_limit` axles."""
    table = modes("OUTSIDE", "AWAITED", "TOLD", "MISSING")
    declared = Declared()
    event = declared.sensor(choice("event", enumeration(EVENT)))
    comes = declared.sensor(choice("reference_comes", enumeration(FROM)))
    axles_in = declared.sensor(optional("axles_in", COUNT, 0, axle_limit))
    axles_out = declared.sensor(optional("axles_out", COUNT, 0, axle_limit))
    waited = declared.state(number("waited_cycles", COUNT, 0, wait_cycles), first=0)
    due = declared.state(boolean("due"), first=False)
    source = declared.state(choice("from", enumeration(FROM)), first=NOBODY)
    inside = declared.state(number("axles_inside", COUNT, 0, axle_limit), first=0)
    sure = declared.state(boolean("count_is_sure"), first=True)
    left = declared.state(boolean("left"), first=False)
    in_part = declared.state(boolean("left_in_part"), first=False)
    truly = declared.ghost(number("true_axles_inside", COUNT, 0, axle_limit), first=0)
    next_truly = declared.choice(number("next_axles_inside", COUNT, 0, axle_limit))
    current = current_mode(table)
    entry = EntryInputs(event, comes, axles_in, axles_out, inside, sure, in_part)
    machine = declared.machine(
        name="entry",
        modes=table,
        outputs={
            "reference_due": due,
            "reference_from": source,
            "in_area": current.ne(table[0]),
            "reference_missing": current.eq(table[3]),
            "waited_cycles": waited,
            "axles_inside": inside,
            "left": left,
            "left_in_part": in_part,
        },
        transitions=list(_table(table, entry, waited, due, source, left)),
        world=declared.world(
            moves={truly: next_truly},
            clauses=_clauses(entry, truly, next_truly),
        ),
        lemmas={
            "nothing is due from nobody but once": (due & source.eq(NOBODY)).implies(current.eq(table[3])),
            "a sure balance is true": sure.implies(inside.eq(truly)),
        },
        doc="Entry of a train, arrival of its reference or the lack of it, and its exit with as many axles as came in.",
    )
    balance = (inside, sure, left, in_part, truly, next_truly)
    return Entry(machine, event, comes, axles_in, axles_out, waited, due, source, *balance)


def _clauses(entry: EntryInputs, truly: NumVar, next_truly: NumVar) -> dict[str, Law]:
    came, went = entry.axles_in, entry.axles_out
    there = ite(entry.event.one_of(ENTERS_LOW, ENTERS_HIGH), 0, truly)
    return {
        "undisturbed counters count every axle": Law(
            (came.present & went.present).implies((next_truly - there).eq(came.value - went.value)),
            "In each cycle, undisturbed counters at both ends report how many axles of the train came into the "
            "area and left it. A train that enters had no axle in it before.",
            source="[S] FVA-4: the sensor is safe; [D] proved of the axle counter and the axle section under their own laws",
            owner="supplier",
            check="the axles of every train at both ends",
        ),
    }


def _table(
    table: tuple[Lit, ...], entry: EntryInputs, waited: NumVar, due: BoolVar, source: NumVar, left: BoolVar
) -> Iterator[Transition]:
    outside, awaited, referenced, missing = table
    stays: Updates = {
        entry.inside: ite(entry.counted, entry.balance, as_num(0, COUNT)),
        entry.sure: entry.counted,
        left: FALSE,
        entry.in_part: ~entry.enters & (entry.in_part | entry.leaving),
    }
    gone: Updates = {entry.inside: 0, entry.sure: TRUE, left: TRUE, entry.in_part: FALSE}
    not_due: Updates = {due: False, source: NOBODY}
    answered = together(stays, {waited: 0, due: True, source: entry.comes})
    overdue = together(stays, {waited: 0, due: True, source: NOBODY})
    waits = together(stays, not_due, {waited: waited + 1})
    same = together(stays, not_due, {waited: 0})
    left_now = together(gone, not_due, {waited: 0})
    came = entry.comes.one_of(AXLE_COUNTER, NEIGHBOUR)
    yield Transition("train leaves", table, outside, entry.complete, left_now, REQUIREMENTS, 0)
    yield Transition("reference comes", table, referenced, came, answered, REQUIREMENTS, 1)
    yield Transition("train enters", table, awaited, entry.enters, same, REQUIREMENTS, 2)
    yield Transition("reference overdue", awaited, missing, waited >= waited.high, overdue, REQUIREMENTS, 3)
    yield Transition("wait for the reference", awaited, awaited, TRUE, waits, REQUIREMENTS, 4)
    yield Transition("train is not here", outside, outside, TRUE, same, REQUIREMENTS, 4)
    yield Transition("reference is known", referenced, referenced, TRUE, same, REQUIREMENTS, 4)
    yield Transition("reference is missing", missing, missing, TRUE, same, REQUIREMENTS, 4)
