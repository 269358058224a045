"""Variables of the entry of a train, and the terms of one cycle: what passes at both ends, and whose axles they are (FVA-2, FVA-9)."""

from __future__ import annotations

from functools import cached_property

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
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
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, LEAVES_HIGH, LEAVES_LOW, NO_EVENT
from safeloc.models.verification.variables import FROM, NOBODY

THIS = 1
"The number of this train; 0 is none."


class Parts:
    """The variables of the machine. Pairs are of the low and of the high end.

    enters     number of the train that comes in at this end in this cycle, by train control
    leaves     the running part of a train has passed out at this end in this cycle
    all_left   of each other train: all of it has left, by the axles that its own machine counts
    beside_trains  of each other train: more axles came in beside it than are its own, by its own machine
    outermost  number of the train that was the outermost at this end before the cycle, by the order of trains
    comes      sender of the reference that comes for this train in this cycle; NOBODY: none comes
    record_sound, record_axles  that reference: undisturbed, and its axles
    clear      the counters are undisturbed, and no axle is counted in
    occupied   the counters are undisturbed, and axles are counted in
    counters_count  the counters are undisturbed, and the order of trains is known
    axles_in, axles_out  axles that the counter at this end counted in this cycle, into the area and out of it
    waited     cycles since this train was counted in without a reference
    due, source   messages to the verification
    inside, sure  axles of this train counted in and not out again; it is there, and no count of them was missed
    come_in, from_high  axles counted in at the end at which it came in, and not out again there; that is the high end
    known, own_axles  a sound reference came since it entered; the axles of the first one
    left, in_part  in this cycle the whole train has left; a part of it left, and axles are still inside
    events     of each train: it comes in or leaves in this cycle, and at which end; one that left a part behind has not left
    gone       at this end the outermost train has left with all its axles, or one that is not known passes out
    forgets    the reference of an earlier train with this number is no more: it has left, or another one comes in
    of_others  axles came in beside this train that are not its own
    unannounced    axles are counted in, of no train that is known or comes in
    true_axles_inside   ghost: this train's axles in the area, with every part that it lost
    passed_in, passed_out  ghosts: axles that really pass at this end in this cycle
    axle_between  ghost: after the cycle an axle is between the counters, of any train

    Ghosts of a train that is there, and of vehicles that nobody announced:

    true_axles, true_come_in, true_from_high  its axles; those that came in where it did, and not out again there; that is the high end
    there      it came in, and not all of it has left
    part_out   its running part was reported to have passed out, and axles of it or of others stayed
    behind, ahead  axles of others that came in where this train did, and at the other end
    axles_of_one_that_enters  what its axles are if it comes in
    own_passes, others_pass  axles of the train, and of others, that come in at this end in this cycle, less those that go out
    """

    def __init__(self, trains: int, wait_cycles: int, axle_limit: int, axles_a_cycle: int) -> None:
        self.declared = declared = Declared()
        self._read(declared, trains, axle_limit, axles_a_cycle)
        self._keep(declared, trains, wait_cycles, axle_limit)
        self._imagine(declared, axle_limit, axles_a_cycle)

    def _read(self, declared: Declared, trains: int, axle_limit: int, most: int) -> None:
        """Declare what the entry hears."""
        sides = ("low", "high")
        self.enters = tuple(declared.sensor(number(f"enters_{side}", COUNT, 0, trains)) for side in sides)
        self.leaves = tuple(declared.sensor(boolean(f"leaves_{side}")) for side in sides)
        others = range(THIS + 1, trains + 1)
        self.all_left = tuple(declared.sensor(boolean(f"train_{n}_all_left")) for n in others)
        self.beside_trains = tuple(declared.sensor(boolean(f"train_{n}_axles_of_others")) for n in others)
        self.outermost = tuple(declared.sensor(number(f"outermost_{side}", COUNT, 0, trains)) for side in sides)
        self.comes = declared.sensor(choice("reference_comes", enumeration(FROM)))
        self.record_sound = declared.sensor(boolean("record_sound"))
        self.record_axles = declared.sensor(number("record_axles", COUNT, 0, axle_limit))
        self.clear = declared.sensor(boolean("counters_clear"))
        self.occupied = declared.sensor(boolean("counters_occupied"))
        self.counters_count = declared.sensor(boolean("counters_count"))
        self.axles_in = tuple(declared.sensor(number(f"axles_in_{side}", COUNT, 0, most)) for side in sides)
        self.axles_out = tuple(declared.sensor(number(f"axles_out_{side}", COUNT, 0, most)) for side in sides)

    def _keep(self, declared: Declared, trains: int, wait_cycles: int, axle_limit: int) -> None:
        """Declare what the entry keeps and tells."""
        self.waited = declared.state(number("waited_cycles", COUNT, 0, wait_cycles), first=0)
        self.due = declared.state(boolean("due"), first=False)
        self.source = declared.state(choice("from", enumeration(FROM)), first=NOBODY)
        self.inside = declared.state(number("axles_inside", COUNT, 0, axle_limit), first=0)
        self.sure = declared.state(boolean("count_is_sure"), first=False)
        self.come_in = declared.state(number("axles_come_in", COUNT, 0, axle_limit), first=0)
        self.from_high = declared.state(boolean("from_high"), first=False)
        self.known = declared.state(boolean("own_axles_known"), first=False)
        self.own_axles = declared.state(number("own_axles", COUNT, 0, axle_limit), first=0)
        self.left = declared.state(boolean("left"), first=False)
        self.in_part = declared.state(boolean("left_in_part"), first=False)
        self.of_others = declared.state(boolean("axles_of_others"), first=False)
        self.unannounced = declared.state(boolean("unannounced"), first=False)
        self.events = tuple(declared.state(_event(n), first=NO_EVENT) for n in range(THIS, trains + 1))
        self.gone = tuple(declared.state(boolean(f"gone_{side}"), first=False) for side in ("low", "high"))
        self.forgets = declared.state(boolean("forgets"), first=False)

    def _imagine(self, declared: Declared, axle_limit: int, most: int) -> None:
        """Declare the ghosts: axles of the train, and of vehicles that nobody announced."""

        def axles(name: str) -> NumVar:
            return number(name, COUNT, 0, axle_limit)

        def passes(name: str) -> NumVar:
            return number(name, COUNT, -axle_limit, axle_limit)

        sides = ("low", "high")
        self.true_axles_inside = declared.ghost(axles("true_axles_inside"), first=0)
        self.true_axles = declared.ghost(axles("true_axles"), first=ANY)
        self.true_come_in = declared.ghost(axles("true_axles_come_in"), first=0)
        self.true_from_high = declared.ghost(boolean("true_from_high"), first=False)
        self.there = declared.ghost(boolean("there"), first=False)
        self.part_out = declared.ghost(boolean("part_out"), first=False)
        self.behind = declared.ghost(axles("axles_of_others_behind"), first=0)
        self.ahead = declared.ghost(axles("axles_of_others_ahead"), first=0)
        self.axles_of_one_that_enters = declared.choice(axles("axles_of_one_that_enters"))
        self.own_passes = tuple(declared.choice(passes(f"own_axles_{side}")) for side in sides)
        self.others_pass = tuple(declared.choice(passes(f"other_axles_{side}")) for side in sides)
        self.passed_in = tuple(declared.choice(number(f"true_axles_in_{side}", COUNT, 0, most)) for side in sides)
        self.passed_out = tuple(declared.choice(number(f"true_axles_out_{side}", COUNT, 0, most)) for side in sides)
        self.axle_between = declared.choice(boolean("axle_between"))

    # -------------------------------------------------------------- the trains of a cycle

    def event(self, train: int, whole: Bool) -> Num:
        """Return the event of one train at either end; one that passes out is the outermost there, and leaves if it is `whole`."""
        low, high = (out & last.eq(train) & whole for _, out, last in self.ends)
        return self._comes_in(train, ite(low, LEAVES_LOW, ite(high, LEAVES_HIGH, NO_EVENT)))

    def _comes_in(self, train: int, otherwise: Num) -> Num:
        low, high = (came.eq(train) for came in self.enters)
        return ite(low, ENTERS_LOW, ite(high, ENTERS_HIGH, otherwise))

    @cached_property
    def ends(self) -> tuple[tuple[Num, Bool, Num], ...]:
        """Of each end: the train that comes in, whether one passes out, and the outermost one."""
        return tuple(zip(self.enters, self.leaves, self.outermost, strict=True))

    @cached_property
    def enters_now(self) -> Bool:
        """This train is counted in."""
        return self._comes_in(THIS, NO_EVENT).ne(NO_EVENT)

    @cached_property
    def leaving(self) -> Bool:
        """The running part of this train has passed out."""
        return self.event(THIS, TRUE).one_of(LEAVES_LOW, LEAVES_HIGH)

    # -------------------------------------------------------------- its axles

    @cached_property
    def is_from_high(self) -> Bool:
        """The train came in at the high end, or does now."""
        return ite(self.enters_now, self.enters[0].ne(THIS), self.from_high)

    def of_this(self, axles: tuple[Num, ...]) -> tuple[Num, Num]:
        """Return how many of the axles at either end are taken for this train's: it comes in there, or was the outermost and nobody comes in."""
        none = as_num(0, COUNT)
        mine = [ite(came.eq(0), last.eq(THIS), came.eq(THIS)) for came, _, last in self.ends]
        low, high = (ite(own, count, none) for own, count in zip(mine, axles, strict=True))
        return low, high

    @cached_property
    def passes(self) -> tuple[Num, Num]:
        """Axles taken for this train's that came in at either end, less those that went out there."""
        (in_low, in_high), (out_low, out_high) = self.of_this(self.axles_in), self.of_this(self.axles_out)
        return in_low - out_low, in_high - out_high

    @cached_property
    def balance(self) -> Num:
        """Axles counted in and not out; of a train that enters, counted from zero."""
        low, high = self.passes
        return ite(self.enters_now, 0, self.inside) + low + high

    @cached_property
    def come_in_now(self) -> Num:
        """Axles counted in and not out at the end at which the train came in; of one that enters, counted from zero."""
        low, high = self.passes
        return ite(self.enters_now, 0, self.come_in) + ite(self.is_from_high, high, low)

    # -------------------------------------------------------------- axles that are not its own

    @cached_property
    def was_known(self) -> Bool:
        """A sound reference of this train came in an earlier cycle."""
        return self.known & ~self.enters_now

    @cached_property
    def reference_comes_now(self) -> Bool:
        """A sound reference with axles comes in this cycle."""
        return self.comes.ne(NOBODY) & self.record_sound & (self.record_axles > 0)

    @cached_property
    def most(self) -> Num:
        """Axles of the train by its first reference, if there is one."""
        return ite(self.was_known, self.own_axles, self.record_axles)

    @cached_property
    def has_more(self) -> Bool:
        """Axles came in beside this train that cannot be its own.

        More came in where it did than its reference has; more came in at the other end than had gone out there; some came in after the
        exit of its running part had been reported; or more went out than had come in.
        """
        came_in = any_of(one > 0 for one in self.of_this(self.axles_in))
        reasons = [
            (self.was_known | self.reference_comes_now) & (self.come_in_now > self.most),
            self.balance > self.come_in_now,
            self.in_part & ~self.enters_now & came_in,
            ~self.possible,
        ]
        return (self.enters_now | self.sure) & any_of(reasons)

    @cached_property
    def possible(self) -> Bool:
        """As many axles as the counts say can be there."""
        limit = self.inside.high
        return between(0, self.balance, limit) & between(0, self.come_in_now, limit)

    @cached_property
    def of_nobody(self) -> Bool:
        """Axles are counted in of no train that is known: none is in the area, and none comes in; or none where an axle does.

        A train that comes in while the order is not known is none that is known.
        """
        nobody_comes = all_of(came.eq(0) for came in self.enters) | ~self.counters_count
        ends = zip(self.enters, self.outermost, self.axles_in, strict=True)
        at_an_end = any_of((axles > 0) & came.eq(0) & last.eq(0) for came, last, axles in ends)
        nobody_there = all_of(last.eq(0) for last in self.outermost)
        return (self.occupied & nobody_comes & nobody_there) | (~self.clear & at_an_end)

    @cached_property
    def someone_unannounced(self) -> Bool:
        """Axles are in the area that no announced train has."""
        return any_of([self.of_nobody, self.has_more, self.beside_others])

    @cached_property
    def beside_others(self) -> Bool:
        """Axles are counted in, some of them beside another train that has fewer of its own."""
        return self.occupied & any_of(self.beside_trains)

    # -------------------------------------------------------------- its exit

    @cached_property
    def counted(self) -> Bool:
        """The balance is sure after the cycle."""
        return (self.enters_now | self.sure) & self.counters_count & ~self.of_nobody & ~self.has_more

    @cached_property
    def complete(self) -> Bool:
        """Every axle that came in is out."""
        return self.leaving & self.counted & self.balance.eq(0)

    @cached_property
    def emptied(self) -> Bool:
        """The counters report an empty area, into which this train does not come."""
        return self.clear & ~self.enters_now


def parts(*, trains: int, wait_cycles: int, axle_limit: int, axles_a_cycle: int) -> Parts:
    """Return fresh variables of one train of up to `axle_limit` axles, the first of `trains`."""
    return Parts(trains, wait_cycles, axle_limit, axles_a_cycle)


def _event(train: int) -> NumVar:
    name = "event" if train == THIS else f"event_of_train_{train}"
    return choice(name, enumeration((NO_EVENT, ENTERS_LOW, ENTERS_HIGH, LEAVES_LOW, LEAVES_HIGH)))
