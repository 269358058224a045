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

from safeloc.language.expr import TRUE, Bool, BoolVar, Num, NumVar, all_of, any_of, as_num, between, ite
from safeloc.language.units import COUNT
from safeloc.language.world import Law, World
from safeloc.models.fibre_area.entry_variables import THIS, Parts
from safeloc.models.verification.variables import NOBODY

EXACT = "undisturbed counters count every axle"
EMPTY = "clear counters have no axle between them"
"The laws that the axle section guarantees."
SOUND = "a sound reference counts the train's axles"
"The law that the counters' own records guarantee, where they are beside it (models.fibre_device)."


def world(own: Parts) -> World:
    """Return the moves of the ghosts, and the laws."""
    seen = _Cycle(own)
    moves: dict[NumVar | BoolVar, Num | Bool] = {
        own.true_axles_inside: seen.inside,
        own.true_axles: seen.axles,
        own.true_come_in: seen.come_in,
        own.true_from_high: seen.from_high,
        own.there: seen.is_there,
        own.part_out: seen.is_there & (seen.part_out | seen.passes_out),
        own.behind: seen.behind,
        own.ahead: seen.ahead,
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

    def _before(self, count: Num) -> Num:
        """Return a count of this train's before the cycle; 0 if it comes in."""
        return ite(self.comes_in, as_num(0, COUNT), count)

    @cached_property
    def axles(self) -> Num:
        """Its axles: the same during its stay."""
        return ite(self.comes_in, self.own.axles_of_one_that_enters, self.own.true_axles)

    @cached_property
    def come_in(self) -> Num:
        """Its axles that came in where it did, after the cycle."""
        return self._before(self.own.true_come_in) + self.at_entry(self.own.own_passes)

    @cached_property
    def inside(self) -> Num:
        """Its axles in the area, after the cycle."""
        low, high = self.own.own_passes
        return self._before(self.own.true_axles_inside) + low + high

    @cached_property
    def behind_before(self) -> Num:
        """Axles of others that came in where it did, before the cycle."""
        return self._before(self.own.behind)

    @cached_property
    def behind(self) -> Num:
        """The same after the cycle."""
        return self.behind_before + self.at_entry(self.own.others_pass)

    @cached_property
    def ahead(self) -> Num:
        """Axles of others that came in at the other end, after the cycle."""
        return self._before(self.own.ahead) + self.at_exit(self.own.others_pass)

    @cached_property
    def counts(self) -> tuple[Num, Num, Num]:
        """Axles in the area of the train, and of those behind and ahead of it, after the cycle."""
        return self.inside, self.behind, self.ahead

    @cached_property
    def nobody(self) -> Bool:
        """After the cycle no axle of the train or of others beside it is inside."""
        return all_of(one.eq(0) for one in self.counts)

    @cached_property
    def part_out(self) -> Bool:
        """Its running part was reported to have passed out before the cycle."""
        return self.own.part_out & ~self.comes_in

    @cached_property
    def is_there(self) -> Bool:
        """After the cycle it is in the area, until it has passed out and no axle of it or of those beside it is inside."""
        own = self.own
        return ite(self.comes_in, TRUE, own.there & ~own.clear & ~(self.passes_out & self.nobody))

    @cached_property
    def speaks(self) -> Bool:
        """The counters count, and the order of trains names one, or one comes in, if the area is not clear."""
        own = self.own
        known = any_of(one > 0 for one in (*own.enters, *own.outermost))
        return own.counters_count & (~own.occupied | known)

    def at_entry(self, low_and_high: tuple[Num, ...]) -> Num:
        """Return what passes at the end at which it came in."""
        low, high = low_and_high
        return ite(self.from_high, high, low)

    def at_exit(self, low_and_high: tuple[Num, ...]) -> Num:
        """Return what passes at the other end."""
        low, high = low_and_high
        return ite(self.from_high, low, high)

    @cached_property
    def is_outermost(self) -> tuple[Bool, Bool]:
        """At either end: it comes in there, or it was the outermost there and none comes in."""
        own = self.own
        low, high = (
            came.eq(THIS) | (came.eq(0) & last.eq(THIS)) for came, last in zip(own.enters, own.outermost, strict=True)
        )
        return low, high


def _clauses(own: Parts, seen: _Cycle) -> dict[str, Law]:
    counted, passed = (*own.axles_in, *own.axles_out), (*own.passed_in, *own.passed_out)
    limit = own.inside.high
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
            seen.nobody | own.axle_between,
            "An axle in the area, of this train or of a vehicle beside it that nobody announced, is an axle between its counters.",
            source="[D] a definition of the area",
            owner="nobody",
        ),
        "axles of a train came in where it did": Law(
            all_of(
                [
                    (seen.inside >= 0) & (seen.inside <= seen.come_in) & (seen.come_in <= seen.axles),
                    between(0, seen.behind, limit) & between(0, seen.ahead, limit),
                    seen.is_there | seen.nobody,
                ]
            ),
            "The train's axles in the area came in where it did, and none of them has gone out at the other end; before it came in, and when it has left, there is none, and "
            "nothing is beside it.",
            source="[D] a definition of the counts",
            owner="nobody",
        ),
        "the axles at an end are those of the outermost train": _outermost_law(own, seen),
        "no unannounced vehicle passes a train": _beside_law(own, seen),
        SOUND: Law(
            (seen.is_there & own.comes.ne(NOBODY) & own.record_sound).implies(own.record_axles <= seen.axles),
            "A reference that comes undisturbed while the train is in the area has no more axles than the train.",
            source="[S] FVA-4: the sensor is safe; FVA-D1: the neighbour hands over what it verified",
            owner="supplier",
            check="safety case of the counters; count and record compared at the next counter",
        ),
    }


def _outermost_law(own: Parts, seen: _Cycle) -> Law:
    terms = list[Bool]()
    ends = zip(
        seen.is_outermost, own.enters, own.outermost, own.own_passes, own.others_pass, own.passed_in, own.passed_out,
        strict=True,
    )  # fmt: skip
    for here, comes, last, its, others, came, went in ends:
        of_nobody = all_of([comes.eq(0), last.eq(0), came > 0, seen.is_there])
        terms.append(here.implies((its + others).eq(came - went) & (others <= came)))
        terms.append((~here).implies(its.eq(0) & others.eq(ite(of_nobody, came - went, as_num(0, COUNT)))))
    return Law(
        seen.speaks.implies(all_of(terms)),
        "While the order of trains is known and names one, or one comes in, the axles that pass at an end are those of the train that comes "
        "in there, or else of the outermost one, with parts that it lost, or of vehicles beside it that nobody announced; no other one of its axles comes or goes. Axles that come in where no train is "
        "known and none comes in, while this train is in the area or comes in at the other end, are of such a vehicle.",
        source="[D] one track: no vehicle passes another, and two trains are more than a cycle apart; [M] announcements by train control",
        owner="infrastructure",
        check="no switch between the counters; headway; axles counted in while no train is announced",
    )


def _beside_law(own: Parts, seen: _Cycle) -> Law:
    stays = (seen.behind_before > 0) & (seen.behind > 0)
    here, there = seen.at_entry(own.others_pass), seen.at_exit(own.others_pass)
    return Law(
        seen.speaks.implies(
            all_of(
                [
                    (here > 0).implies(seen.come_in.eq(seen.axles) | seen.part_out),
                    stays.implies(seen.at_entry(own.own_passes) >= 0),
                    (there > 0).implies(seen.inside.eq(seen.come_in) | seen.part_out),
                ]
            )
        ),
        "A vehicle that nobody announced comes in behind a train only when all axles of the train are in, and at the other end only while none of them is "
        "out, unless the train's running part has been reported to have passed out; while it is behind, the train does not go out there. So a part that has passed out is reported "
        "before anybody else comes in there, and no rolling stock of a train that is partly in the area is exchanged outside a counter.",
        source="[D] one track: no vehicle passes another; [M] operating rules",
        owner="infrastructure",
        check="no switch between the counters, and none between a counter and a standing train; no shunting at a counter",
    )
