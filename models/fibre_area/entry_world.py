"""World of the entry: the axles of a train, and of vehicles beside it that nobody announced (FVA-2, FVA-9).

counters  undisturbed, count every axle, and are clear only if none is between them
axles     that pass at an end are those of the train that comes in there, or else of the outermost one, with parts that it lost; or of a
          vehicle that nobody announced
order     no vehicle passes another: one that nobody announced comes in behind a train when all of it is in, and at the other end while nothing of it is out
records   a sound reference has no more axles than the train
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import TRUE, Bool, BoolVar, Num, NumVar, all_of, any_of, as_num, ite
from safeloc.language.units import COUNT
from safeloc.language.world import Law, World
from safeloc.models.fibre_area.entry_variables import THIS, Parts
from safeloc.models.verification.variables import NOBODY

EXACT = "undisturbed counters count every axle"
EMPTY = "clear counters have no axle between them"
"The laws that the axle section guarantees."


def world(own: Parts) -> World:
    """Return the moves of the ghosts, and the laws."""
    seen = _Cycle(own)
    moves: dict[NumVar | BoolVar, Num | Bool] = {
        own.true_axles_inside: own.next_inside,
        own.true_axles: own.next_axles,
        own.true_came: own.next_came,
        own.true_from_high: seen.from_high,
        own.there: seen.is_there,
        own.part_out: seen.is_there & ~seen.comes_in & (own.part_out | seen.passes_out),
        own.behind: own.next_behind,
        own.ahead: own.next_ahead,
    }
    return own.declared.world(moves=moves, clauses=_clauses(own, seen))


@dataclass(frozen=True, eq=False)
class _Cycle:
    """Truth of one cycle."""

    own: Parts

    @cached_property
    def comes_in(self) -> Bool:
        """This train comes in."""
        return any_of(came.eq(THIS) for came in self.own.enters)

    @cached_property
    def from_high(self) -> Bool:
        """It came in at the high end, or does now."""
        return ite(self.comes_in, self.own.enters[0].ne(THIS), self.own.true_from_high)

    @cached_property
    def passes_out(self) -> Bool:
        """Its running part is reported to have passed out."""
        own = self.own
        outs = zip(own.leaves, own.outermost, strict=True)
        return ~self.comes_in & any_of(out & last.eq(THIS) for out, last in outs)

    @cached_property
    def is_there(self) -> Bool:
        """After the cycle it is in the area, until it has passed out and no axle of it or of those beside it is inside."""
        own = self.own
        none = (own.next_inside + own.next_behind + own.next_ahead).eq(0)
        return ite(self.comes_in, TRUE, own.there & ~own.clear & ~(self.passes_out & none))

    @cached_property
    def speaks(self) -> Bool:
        """The counters count, and the order of trains names one, or one comes in, if the area is not clear."""
        own = self.own
        known = any_of(one > 0 for one in (*own.enters, *own.outermost))
        return own.counters_count & (~own.occupied | known)

    def _at_its_end(self, axles: tuple[Num, ...], *, entry: bool) -> Num:
        """Return the axles that pass at the end at which it came in, or at the other one, if it is the outermost there."""
        own, none = self.own, as_num(0, COUNT)
        ends = zip(own.enters, own.outermost, axles, strict=True)
        low, high = (
            ite((came > 0) & came.ne(THIS), none, ite(came.eq(THIS) | last.eq(THIS), count, none))
            for came, last, count in ends
        )
        return ite(self.from_high, high, low) if entry else ite(self.from_high, low, high)

    def before(self, count: Num) -> Num:
        """Return a count of this train's before the cycle; 0 if it comes in."""
        return ite(self.comes_in, as_num(0, COUNT), count)

    def passed(self, *, entry: bool) -> tuple[Num, Num]:
        """Return the axles that really pass in and out at the end at which it came in, or at the other one."""
        return self._at_its_end(self.own.passed_in, entry=entry), self._at_its_end(self.own.passed_out, entry=entry)


def _clauses(own: Parts, seen: _Cycle) -> dict[str, Law]:
    counted, passed = (*own.axles_in, *own.axles_out), (*own.passed_in, *own.passed_out)
    all_inside = own.next_inside + own.next_behind + own.next_ahead
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
            (all_inside > 0).implies(own.axle_between),
            "An axle in the area, of this train or of a vehicle beside it that nobody announced, is an axle between its counters.",
            source="[D] a definition of the area",
            owner="nobody",
        ),
        "axles of a train came in where it did": Law(
            all_of(
                [
                    (own.next_inside <= own.next_came) & (own.next_came <= own.next_axles),
                    (own.there & ~seen.comes_in).implies(own.next_axles.eq(own.true_axles)),
                ]
            ),
            "A train has the same axles during its stay. Those in the area came in at its end, and none of them has gone out at the other one.",
            source="[D] a definition of the counts",
            owner="nobody",
        ),
        "the axles at an end are those of the outermost train": _outermost_law(own, seen),
        "no unannounced vehicle passes a train": _beside_law(own, seen),
        "a sound reference counts the train's axles": Law(
            (seen.is_there & own.comes.ne(NOBODY) & own.record_sound).implies(own.record_axles <= own.next_axles),
            "A reference that comes undisturbed while the train is in the area has no more axles than the train.",
            source="[S] FVA-4: the sensor is safe; FVA-D1: the neighbour hands over what it verified",
            owner="supplier",
            check="safety case of the counters; count and record compared at the next counter",
        ),
    }


def _outermost_law(own: Parts, seen: _Cycle) -> Law:
    came, inside = own.next_came - seen.before(own.true_came), own.next_inside - seen.before(own.true_axles_inside)
    behind, ahead = own.next_behind - seen.before(own.behind), own.next_ahead - seen.before(own.ahead)
    (in_here, out_here), (in_there, out_there) = (seen.passed(entry=entry) for entry in (True, False))
    return Law(
        seen.speaks.implies(
            all_of(
                [
                    (came + behind).eq(in_here - out_here),
                    (inside - came + ahead).eq(in_there - out_there),
                    (behind <= in_here) & (ahead <= in_there),
                ]
            )
        ),
        "While the order of trains is known and names one, or one comes in, the axles that pass at an end are those of the train that comes "
        "in there, or else of the outermost one, with parts that it lost, or of vehicles beside it that nobody announced; no other one of its axles comes or goes. A train that "
        "comes in is announced in the cycle of its first axle, or nobody announces it.",
        source="[D] one track: no vehicle passes another, and two trains are more than a cycle apart; [M] announcements by train control",
        owner="infrastructure",
        check="no switch between the counters; headway; axles counted in while no train is announced",
    )


def _beside_law(own: Parts, seen: _Cycle) -> Law:
    before = seen.before(own.behind)
    out_before = own.part_out & ~seen.comes_in
    return Law(
        seen.speaks.implies(
            all_of(
                [
                    (own.next_behind > before).implies(own.next_came.eq(own.next_axles) | out_before),
                    ((before > 0) & (own.next_behind > 0)).implies(own.next_came >= own.true_came),
                    (own.next_ahead > seen.before(own.ahead)).implies(own.next_inside.eq(own.next_came) | out_before),
                ]
            )
        ),
        "A vehicle that nobody announced comes in behind a train only when all axles of the train are in, and at the other end only while none of them is "
        "out, unless the train's running part has been reported to have passed out; while it is behind, the train does not go out there.",
        source="[D] one track: no vehicle passes another",
        owner="infrastructure",
        check="no switch between the counters, and none between a counter and a standing train",
    )
