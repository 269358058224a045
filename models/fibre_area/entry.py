"""Trains at both ends of the area: entry of this train, its reference, and its complete exit (FVA-2, FVA-D1; figures, 003 items 3 and 14).

    OUTSIDE  the train is not in the area
    AWAITED  it was counted in; its reference has to come within `record_wait_cycles`
    TOLD     its reference came
    MISSING  its reference did not come in time

The counters report that a train comes in, with its number from train control, or that one has passed out; which one that is follows
from the order of the trains. So do the axles: those that pass at an end belong to the train that is the outermost there. Axles that are
counted in while no train is known in the area, and none comes in, are nobody's: somebody is there, and it is not known who.

A reference is an axle counter's record, or the record handed over by the neighbouring area. It is due in the cycle in
which it comes, or in which it is overdue; then its sender is NOBODY. The verification accepts or refuses it. One that comes while the area is
empty, as that of the counter at the exit, is forgotten in the next cycle; one of an earlier train, in the cycle in which the next one comes in.

A train has left when the counters report its exit and as many of its axles were counted out as in since it entered, in every
cycle by undisturbed counters. If fewer axles leave, the train has left a part behind: its exit is not passed on until the
rest is counted out and reported too. It has left as well when undisturbed counters report an empty area.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Lit,
    Num,
    NumVar,
    all_of,
    any_of,
    as_num,
    between,
    boolean,
    choice,
    enumeration,
    ite,
    number,
)
from safeloc.language.machine import Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT
from safeloc.language.world import Law
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, LEAVES_HIGH, LEAVES_LOW, NO_EVENT
from safeloc.models.verification.variables import AXLE_COUNTER, FROM, NEIGHBOUR, NOBODY

REQUIREMENTS = ("FVA-2", "FVA-11", "FVA-D1")
THIS = 1
"The number of this train; 0 is none."
EXACT = "undisturbed counters count every axle"
EMPTY = "clear counters have no axle between them"
"The laws that the axle section guarantees."


class Parts:
    """The variables of the machine. Pairs are of the low and of the high end.

    enters     number of the train that comes in at this end in this cycle, by train control
    leaves     the running part of a train has passed out at this end in this cycle
    all_left   of each other train: all of it has left, by the axles that its own machine counts
    outermost  number of the train that was the outermost at this end before the cycle, by the order of trains
    comes      sender of the reference that comes for this train in this cycle; NOBODY: none comes
    clear      the counters are undisturbed, and no axle is counted in
    occupied   the counters are undisturbed, and axles are counted in
    counters_count  the counters are undisturbed, and the order of trains is known
    axles_in, axles_out  axles that the counter at this end counted in this cycle, into the area and out of it
    waited     cycles since this train was counted in without a reference
    due, source   messages to the verification
    inside, sure  axles of this train counted in and not out again; no count of them was missed
    left, in_part  in this cycle the whole train has left; a part of it left, and axles are still inside
    events     of each train: it comes in or leaves in this cycle, and at which end; one that left a part behind has not left
    gone       at this end the outermost train has left with all its axles, or one that is not known passes out
    forgets    the reference of an earlier train with this number is no more: it has left, or another one comes in
    unannounced    axles are counted in, of no train that is known or comes in
    true_axles_inside   ghost: this train's axles in the area, with every part that it lost
    passed_in, passed_out  ghosts: axles that really pass at this end in this cycle
    axle_between  ghost: after the cycle an axle is between the counters
    """

    def __init__(self, trains: int, wait_cycles: int, axle_limit: int, axles_a_cycle: int) -> None:
        self.declared = declared = Declared()
        sides, most = ("low", "high"), axles_a_cycle
        self.enters = tuple(declared.sensor(number(f"enters_{side}", COUNT, 0, trains)) for side in sides)
        self.leaves = tuple(declared.sensor(boolean(f"leaves_{side}")) for side in sides)
        self.all_left = tuple(declared.sensor(boolean(f"train_{n}_all_left")) for n in range(2, trains + 1))
        self.outermost = tuple(declared.sensor(number(f"outermost_{side}", COUNT, 0, trains)) for side in sides)
        self.comes = declared.sensor(choice("reference_comes", enumeration(FROM)))
        self.clear = declared.sensor(boolean("counters_clear"))
        self.occupied = declared.sensor(boolean("counters_occupied"))
        self.counters_count = declared.sensor(boolean("counters_count"))
        self.axles_in = tuple(declared.sensor(number(f"axles_in_{side}", COUNT, 0, most)) for side in sides)
        self.axles_out = tuple(declared.sensor(number(f"axles_out_{side}", COUNT, 0, most)) for side in sides)
        self.waited = declared.state(number("waited_cycles", COUNT, 0, wait_cycles), first=0)
        self.due = declared.state(boolean("due"), first=False)
        self.source = declared.state(choice("from", enumeration(FROM)), first=NOBODY)
        self.inside = declared.state(number("axles_inside", COUNT, 0, axle_limit), first=0)
        self.sure = declared.state(boolean("count_is_sure"), first=True)
        self.left = declared.state(boolean("left"), first=False)
        self.in_part = declared.state(boolean("left_in_part"), first=False)
        self.unannounced = declared.state(boolean("unannounced"), first=False)
        self.events = tuple(declared.state(_event(n), first=NO_EVENT) for n in range(1, trains + 1))
        self.gone = tuple(declared.state(boolean(f"gone_{side}"), first=False) for side in sides)
        self.forgets = declared.state(boolean("forgets"), first=False)
        self.true_axles_inside = declared.ghost(number("true_axles_inside", COUNT, 0, axle_limit), first=0)
        self.next_inside = declared.choice(number("next_axles_inside", COUNT, 0, axle_limit))
        self.passed_in = tuple(declared.choice(number(f"true_axles_in_{side}", COUNT, 0, most)) for side in sides)
        self.passed_out = tuple(declared.choice(number(f"true_axles_out_{side}", COUNT, 0, most)) for side in sides)

        self.axle_between = declared.choice(boolean("axle_between"))

    # -------------------------------------------------------------- the train of a cycle

    def event(self, train: int, whole: Bool) -> Num:
        """Return the event of one train at either end; one that passes out is the outermost there, and leaves if it is `whole`."""
        low, high = (out & last.eq(train) & whole for _, out, last in self._ends)
        return self._comes_in(train, ite(low, LEAVES_LOW, ite(high, LEAVES_HIGH, NO_EVENT)))

    def _comes_in(self, train: int, otherwise: Num) -> Num:
        low, high = (came.eq(train) for came in self.enters)
        return ite(low, ENTERS_LOW, ite(high, ENTERS_HIGH, otherwise))

    @cached_property
    def _ends(self) -> tuple[tuple[Num, Bool, Num], ...]:
        return tuple(zip(self.enters, self.leaves, self.outermost, strict=True))

    def passed_on(self, left: Bool) -> Updates:
        """Return what the later machines read in a cycle in which all of this train has `left`, or not.

        A train that has left because the counters are clear is gone at the low end, whichever it left by, so that the order drops it.
        """
        low, high = (
            out & any_of([last.eq(0), last.eq(THIS) & left, *self._others_left(last)]) for _, out, last in self._ends
        )
        cleared = left & ~self.leaving & self.outermost[0].eq(THIS)
        others = [self.event(number, whole) for number, whole in enumerate(self.all_left, 2)]
        return {
            self.left: left,
            **dict(zip(self.events, [self.event(THIS, left), *others], strict=True)),
            **dict(zip(self.gone, (low | cleared, high), strict=True)),
            self.forgets: left | (self.enters_now & self.comes.eq(NOBODY)),
        }

    def _others_left(self, outermost: Num) -> list[Bool]:
        return [outermost.eq(number) & left for number, left in enumerate(self.all_left, 2)]

    @cached_property
    def enters_now(self) -> Bool:
        """This train is counted in."""
        return self._comes_in(THIS, NO_EVENT).ne(NO_EVENT)

    @cached_property
    def leaving(self) -> Bool:
        """The running part of this train has passed out."""
        return self.event(THIS, TRUE).one_of(LEAVES_LOW, LEAVES_HIGH)

    def of_this(self, axles: tuple[Num, ...]) -> Num:
        """Return how many of the axles at both ends are this train's: it comes in there, or was the outermost and nobody comes in."""
        mine = [ite(came.eq(0), last.eq(THIS), came.eq(THIS)) for came, _, last in self._ends]
        low, high = (ite(own, count, as_num(0, COUNT)) for own, count in zip(mine, axles, strict=True))
        return low + high

    @cached_property
    def balance(self) -> Num:
        """Axles counted in and not out; of a train that enters, counted from zero."""
        return ite(self.enters_now, 0, self.inside) + self.of_this(self.axles_in) - self.of_this(self.axles_out)

    @cached_property
    def counted(self) -> Bool:
        """The balance is sure after the cycle."""
        possible = between(0, self.balance, self.inside.high)
        return (self.enters_now | self.sure) & self.counters_count & possible & ~self.of_nobody

    @cached_property
    def of_nobody(self) -> Bool:
        """Axles are counted in, and no train is known in the area or comes in."""
        return self.occupied & all_of(came.eq(0) & last.eq(0) for came, _, last in self._ends)

    @cached_property
    def complete(self) -> Bool:
        """Every axle that came in is out."""
        return self.leaving & self.counted & self.balance.eq(0)

    @cached_property
    def emptied(self) -> Bool:
        """The counters report an empty area, into which this train does not come."""
        return self.clear & ~self.enters_now


Entry = Model[Parts]


def parts(*, trains: int, wait_cycles: int, axle_limit: int, axles_a_cycle: int) -> Parts:
    """Return fresh variables of one train of up to `axle_limit` axles, the first of `trains`."""
    return Parts(trains, wait_cycles, axle_limit, axles_a_cycle)


def _event(train: int) -> NumVar:
    name = "event" if train == THIS else f"event_of_train_{train}"
    return choice(name, enumeration((NO_EVENT, ENTERS_LOW, ENTERS_HIGH, LEAVES_LOW, LEAVES_HIGH)))


def build(own: Parts) -> Entry:
    """Return the machine over the given variables."""
    table = modes("OUTSIDE", "AWAITED", "TOLD", "MISSING")
    current = current_mode(table)
    machine = own.declared.machine(
        name="entry",
        modes=table,
        outputs={
            "reference_due": own.due,
            "reference_from": own.source,
            "in_area": current.ne(table[0]),
            "reference_missing": current.eq(table[3]),
            "waited_cycles": own.waited,
            "axles_inside": own.inside,
            "left": own.left,
            "left_in_part": own.in_part,
            "unannounced": own.unannounced,
            **{one.name: one for one in own.events},
            **{one.name: one for one in own.gone},
            "forgets": own.forgets,
        },
        transitions=list(_table(own, table)),
        world=own.declared.world(moves={own.true_axles_inside: own.next_inside}, clauses=_clauses(own)),
        lemmas={
            "nothing is due from nobody but once": (own.due & own.source.eq(NOBODY)).implies(current.eq(table[3])),
            "a sure balance is true": own.sure.implies(own.inside.eq(own.true_axles_inside)),
        },
        doc="Entry of a train, arrival of its reference or the lack of it, and its exit with as many axles as came in.",
    )
    return Entry(machine, own)


def _clauses(own: Parts) -> dict[str, Law]:
    counted, passed = (*own.axles_in, *own.axles_out), (*own.passed_in, *own.passed_out)
    there = ite(any_of(came.eq(THIS) for came in own.enters), 0, own.true_axles_inside)
    known = any_of(one > 0 for one in (*own.enters, *own.outermost))
    came, went = (_of_the_outermost(own, axles) for axles in (own.passed_in, own.passed_out))
    return {
        EXACT: Law(
            own.counters_count.implies(all_of(one.eq(true) for one, true in zip(counted, passed, strict=True))),
            "In each cycle, undisturbed counters report how many axles passed at either end, into the area and out of it.",
            source="[S] FVA-4: the sensor is safe; [D] the law of the axle section, which hears the same counters",
            owner="supplier",
            check="counts of neighbouring sections compared",
        ),
        EMPTY: Law(
            own.clear.implies(~own.axle_between),
            "Undisturbed counters report an empty area only if no axle is between them.",
            source="[S] FVA-4: the sensor is safe; [D] proved of the axle section under its own laws",
            owner="supplier",
            check="safety case of the counters",
        ),
        "the train's axles in the area are between the counters": Law(
            (own.next_inside > 0).implies(own.axle_between),
            "An axle of this train in the area is an axle between its counters.",
            source="[D] a definition of the area",
            owner="nobody",
        ),
        "the axles at an end are those of the outermost train": Law(
            (own.counters_count & (~own.occupied | known)).implies((own.next_inside - there).eq(came - went)),
            "While the order of trains is known and names one, or one comes in, the axles that pass at an end are those of the train that comes "
            "in there, or else of the outermost one, with parts that it lost; no other one of its axles comes or goes. A train that "
            "comes in is announced in the cycle of its first axle.",
            source="[D] one track: no vehicle passes another, and two trains are more than a cycle apart; [M] announcements by train control",
            owner="infrastructure",
            check="no switch between the counters; headway; axles counted in while no train is announced",
        ),
    }


def _of_the_outermost(own: Parts, axles: tuple[Num, ...]) -> Num:
    """Return the axles at those ends at which this train comes in, or was the outermost before a cycle in which none comes in."""
    total = as_num(0, COUNT)
    for came, last, count in zip(own.enters, own.outermost, axles, strict=True):
        total = total + ite((came > 0) & came.ne(THIS), 0, ite(came.eq(THIS) | last.eq(THIS), count, 0))
    return total


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    outside, awaited, referenced, missing = table
    stays: Updates = {
        own.inside: ite(own.counted, own.balance, as_num(0, COUNT)),
        own.sure: own.counted,
        own.unannounced: own.of_nobody,
        own.in_part: ~own.enters_now & (own.in_part | own.leaving),
        **own.passed_on(FALSE),
    }
    gone: Updates = {own.inside: 0, own.sure: TRUE, own.in_part: FALSE, own.unannounced: FALSE, **own.passed_on(TRUE)}
    not_due: Updates = {own.due: False, own.source: NOBODY}
    answered = together(stays, {own.waited: 0, own.due: True, own.source: own.comes})
    overdue = together(stays, {own.waited: 0, own.due: True, own.source: NOBODY})
    waits = together(stays, not_due, {own.waited: own.waited + 1})
    same = together(stays, not_due, {own.waited: 0})
    left_now = together(gone, not_due, {own.waited: 0})
    came = own.comes.one_of(AXLE_COUNTER, NEIGHBOUR)
    there = (awaited, referenced, missing)
    yield Transition("train leaves", table, outside, own.complete, left_now, REQUIREMENTS, 0)
    yield Transition("area is empty", there, outside, own.emptied, left_now, REQUIREMENTS, 1)
    yield Transition("reference comes", table, referenced, came, answered, REQUIREMENTS, 2)
    yield Transition("train enters", table, awaited, own.enters_now, same, REQUIREMENTS, 3)
    yield Transition("reference overdue", awaited, missing, own.waited >= own.waited.high, overdue, REQUIREMENTS, 4)
    yield Transition("wait for the reference", awaited, awaited, TRUE, waits, REQUIREMENTS, 5)
    yield Transition("train is not here", outside, outside, TRUE, same, REQUIREMENTS, 5)
    yield Transition("reference is known", referenced, referenced, TRUE, same, REQUIREMENTS, 5)
    yield Transition("reference is missing", missing, missing, TRUE, same, REQUIREMENTS, 5)
