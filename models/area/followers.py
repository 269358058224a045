"""Vehicles that come in uncounted at a border that reports occupancy alone, and how far in they can be.

Such a border does not count: whoever stands just outside may come in beside the trains that tell of it. A follower is a
vehicle that came in so since the last train came in at that end; it is behind every train of the area, seen from its end. One bound for
each end says how far in the foremost follower can be:

    it begins    at the end, in a cycle in which the side outside is not clear
    it moves     inward by a cycle's run at top speed, but not past a train whose order is known: none passes another
    it ends      when detection is clear, or when every follower is out again; by no report of a train alone
    it restarts  when a train comes in there: whoever is in from there may be ahead of that train or behind it, and from now on is
                 loose (models.area)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Lit,
    Num,
    NumVar,
    any_of,
    as_num,
    boolean,
    ite,
    maximum,
    minimum,
    number,
)
from safeloc.language.units import MM
from safeloc.models.area.inner import Inner
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, Reach, Slot


@dataclass(frozen=True, eq=False)
class Side:
    """One end of the area.

    place    the place of the end, mm
    clear    input: throughout the cycle no vehicle stood just outside but trains that report when they come in
    bound    followers of this end are between the end and this place, mm; the end of the world behind them if there is none
    came_in  ghost: the vehicle that was never counted is a follower of this end
    inner    detection sections inside the area
    """

    is_low: bool
    reach: Reach
    place: NumVar
    clear: BoolVar
    bound: NumVar
    came_in: BoolVar
    inner: tuple[Inner, ...]

    @property
    def enters(self) -> Lit:
        """The event of a train that comes in here."""
        return ENTERS_LOW if self.is_low else ENTERS_HIGH

    @property
    def none(self) -> Num:
        """The bound while there is no follower."""
        return as_num(self._inward(-self.reach.limit_mm), MM)

    @property
    def some(self) -> Bool:
        """Followers may be in the area."""
        return self.bound >= self.place if self.is_low else self.bound <= self.place

    def any_enters(self, slots: Sequence[Slot]) -> Bool:
        """Return the condition that a train comes in here."""
        return any_of(one.event.eq(self.enters) for one in slots)

    def run_on(self, start: Num, trains: Sequence[tuple[Bool, Num]]) -> Num:
        """Return how far in a follower that was at `start` is after the cycle: not past a train whose order is known."""
        cycle, limit = self.reach.cycle_mm, self.reach.limit_mm
        far = minimum(start + cycle, limit) if self.is_low else maximum(start - cycle, -limit)
        nearer = minimum if self.is_low else maximum
        for known, far_end in trains:
            far = ite(known, nearer(far, far_end), far)
        return far

    def after(self, slots: Sequence[Slot], trains: Sequence[tuple[Bool, Num]]) -> Num:
        """Return the bound after the cycle."""
        enters = self.any_enters(slots)
        begun = maximum(self.bound, self.place) if self.is_low else minimum(self.bound, self.place)
        bound = self._cut(self.run_on(ite(enters, self.place, begun), trains))
        inside = bound >= self.place if self.is_low else bound <= self.place
        return ite((~self.clear | (self.some & ~enters)) & inside, bound, self.none)

    def _cut(self, bound: Num) -> Num:
        """Return the bound before a clear section inside the area in which it lies; none if that begins at the end."""
        for one in reversed(self.inner) if self.is_low else self.inner:
            edge = one.start if self.is_low else one.end
            at_end = edge <= self.place if self.is_low else edge >= self.place
            bound = ite(one.holds(bound), ite(at_end, self.none, edge), bound)
        return bound

    def _inward(self, length: int) -> int:
        return length if self.is_low else -length


@dataclass(frozen=True, eq=False)
class Followers:
    """Both ends, and what is known of the order of trains and followers.

    ordered  for each slot: its train came in at an end that it reported, and its order on the track is known ever since
    behind   ghosts, for each slot: the vehicle that was never counted came in at the same end as the train, after it
    next_loose_comes_in_low   choice: a vehicle that comes in uncounted does so at the low end
    reported_late  choices, for each slot: a follower of the end where the train is reported to come in came in after it
    """

    low: Side
    high: Side
    ordered: tuple[BoolVar, ...]
    behind: tuple[BoolVar, ...]
    next_loose_comes_in_low: BoolVar
    reported_late: tuple[BoolVar, ...]

    @property
    def sides(self) -> tuple[Side, Side]:
        """Low and high."""
        return self.low, self.high

    def turns_loose(self, side: Side, slots: Sequence[Slot]) -> Bool:
        """Return the condition that followers become loose vehicles, ahead of a train that comes in after them."""
        return side.some & side.any_enters(slots)

    def trains(self, side: Side, slots: Sequence[Slot], ends: tuple[Num, Num]) -> list[tuple[Bool, Num]]:
        """Return for each train whether followers of this end are known to be behind it, and the far end of its interval."""
        far_ends = [one.bounds(*ends)[1 if side.is_low else 0] for one in slots]
        known = [one.present & ordered for one, ordered in zip(slots, self.ordered, strict=True)]
        return list(zip(known, far_ends, strict=True))

    def loose_bounds(
        self, slots: Sequence[Slot], ends: tuple[Num, Num], unswept: Bool, apart: tuple[Num, Num]
    ) -> tuple[Num, Num]:
        """Return bounds of all loose vehicles: those that were loose (`apart`), and followers that become loose."""
        limit = self.low.reach.limit_mm
        first, last = as_num(-limit, MM), as_num(limit, MM)
        low, high = ite(unswept, apart[0], last), ite(unswept, apart[1], first)
        for side in self.sides:
            far = side.run_on(side.bound, self.trains(side, slots, ends))
            near_low, near_high = (first, far) if side.is_low else (far, last)
            turns = self.turns_loose(side, slots)
            low, high = ite(turns, minimum(low, near_low), low), ite(turns, maximum(high, near_high), high)
        return low, high

    def beside(self, one: Slot, slots: Sequence[Slot], unswept: Bool) -> tuple[Bool, Bool]:
        """Return whether all loose vehicles are above the train after the cycle, and whether all are below it.

        Followers of one end that become loose are on one side of every train whose order was known, and on either side of the
        train that comes in now: it may be reported later than they came in.
        """
        ordered = self.ordered[one.number - 1]
        from_low, from_high = (self.turns_loose(side, slots) for side in self.sides)
        known = ordered & ~one.leaves
        above_it, below_it = known & (one.below_loose | ~unswept), known & (one.above_loose | ~unswept)
        stays_below = ~from_low & ite(from_high, above_it, one.below_loose & ~one.leaves)
        stays_above = ~from_high & ite(from_low, below_it, one.above_loose & ~one.leaves)
        return (
            ite(one.enters, one.event.eq(ENTERS_LOW) & ~from_low, one.present & stays_below),
            ite(one.enters, one.event.eq(ENTERS_HIGH) & ~from_high, one.present & stays_above),
        )

    def stays_ordered(self, one: Slot) -> Bool:
        """Return whether the train's order is known after the cycle: not once it reported that it left."""
        return one.enters | (self.ordered[one.number - 1] & ~one.leaves)


def followers(
    declared: Declared, reach: Reach, ends: tuple[NumVar, NumVar], trains: int, inner: tuple[Inner, ...]
) -> Followers:
    """Return fresh variables."""
    return Followers(
        _side(declared, reach, ends[0], inner, is_low=True),
        _side(declared, reach, ends[1], inner, is_low=False),
        tuple(declared.state(boolean(f"train_{n}_is_ordered"), first=False) for n in range(1, trains + 1)),
        tuple(declared.ghost(boolean(f"train_{n}_is_followed"), first=False) for n in range(1, trains + 1)),
        declared.choice(boolean("next_loose_comes_in_low")),
        tuple(declared.choice(boolean(f"train_{n}_is_reported_late")) for n in range(1, trains + 1)),
    )


def _side(declared: Declared, reach: Reach, place: NumVar, inner: tuple[Inner, ...], *, is_low: bool) -> Side:
    name, limit = "low" if is_low else "high", reach.limit_mm
    return Side(
        is_low,
        reach,
        place,
        declared.sensor(boolean(f"{name}_side_clear")),
        declared.state(number(f"followers_{name}_mm", MM, -limit, limit), first=-limit if is_low else limit),
        declared.ghost(boolean(f"loose_came_in_{name}"), first=False),
        inner,
    )
