"""Properties of vehicles that come in at borders of an area that report occupancy alone: how far in they may be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, ite, minimum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.terms import Substitution
from safeloc.language.units import MM, MS_PER_S
from safeloc.models.area import Area
from safeloc.models.area.followers import Side
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, Slot

for_all_inputs = partial(always, requirements=("FVA-9",), unconditional=True)


def properties(area: Area, of: Substitution) -> Iterator[Property]:
    """Yield the claims of both ends; none where every vehicle is counted."""
    followers = area.own.followers
    if followers is None:
        return
    for name, side in (("low", followers.low), ("high", followers.high)):
        seen = _Seen(area, of, side)
        yield for_all_inputs(
            f"followers from the {name} end run on",
            seen.run_on(list(zip(area.own.slots, followers.ordered, strict=True))),
            statement="while detection is not clear, the bound of vehicles that came in uncounted moves inward at top speed, up to the far "
            "end of a train whose order is known; no report of a train ends it",
        )
        yield for_all_inputs(
            f"followers come in at the {name} end only from outside",
            seen.begins,
            statement="where nobody may be in uncounted, or a train comes in after whoever is, no follower is while the side outside is clear",
        )
        yield for_all_inputs(
            f"followers from the {name} end run no faster than they can",
            seen.no_farther,
            statement="the bound moves inward by no more than the run of a cycle at top speed, from the end on; from the end anew when a train comes in",
        )


class _Seen:
    """One end, before and after a step. Lengths count inward from the end of the world outside, so that both ends read alike."""

    def __init__(self, area: Area, of: Substitution, side: Side) -> None:
        self._own, self._of, self._side = area.own, of, side
        config = area.own.config
        self._step = -(-config.max_speed_mm_s * config.period_ms // MS_PER_S)
        self._limit = config.limit_mm

    def _inward(self, place: Num) -> Num:
        return place if self._side.is_low else -1 * place

    @property
    def _bound(self) -> Num:
        return self._inward(self._of.num(self._side.bound))

    @property
    def _place(self) -> Num:
        return self._inward(self._of.num(self._side.place))

    @property
    def _far(self) -> Num:
        """Return the farthest that a follower can have run in the cycle."""
        started = ite(self._was_none | self._enters, self._place, earlier_num(self._bound))
        return minimum(started + self._step, self._limit)

    @property
    def _enters(self) -> Bool:
        end = ENTERS_LOW if self._side.is_low else ENTERS_HIGH
        return ~all_of(self._of.bool(one.event.ne(end)) for one in self._own.slots)

    @property
    def _was_none(self) -> Bool:
        return earlier_num(self._bound) < self._place

    @property
    def begins(self) -> Bool:
        """Nobody was in, or a train comes in after them, and the side outside is clear: no follower is in."""
        return ((self._was_none | self._enters) & self._of.bool(self._side.clear)).implies(self._bound < self._place)

    @property
    def no_farther(self) -> Bool:
        """The bound is no farther in than a run of one cycle allows."""
        return self._bound <= self._far

    def run_on(self, trains: Sequence[tuple[Slot, Bool]]) -> Bool:
        """Return whether the bound is as far in as a run of one cycle, or at the far end of a train whose order is known."""
        left = any_of(earlier_bool(self._of.bool(one.present)) & ~self._of.bool(one.present) for one, _ in trains)
        own = self._own
        quiet = self._of.bool(own.healthy & ~own.clear) & ~self._enters & ~left
        some = ~self._was_none | self._of.bool(~self._side.clear)
        held = self._held(trains)
        reached = self._bound >= minimum(self._far, held)
        return (quiet & some).implies(reached | (held < self._place) | self._stopped())

    def _stopped(self) -> Bool:
        """The bound is before a detection section inside the area that is clear, or that section begins at the end."""
        stops = []
        for one in self._own.inner:
            edge = self._inward(self._of.num(one.start if self._side.is_low else one.end))
            stops.append(self._of.bool(one.clear) & (self._bound.eq(edge) | (edge <= self._place)))
        return any_of(stops)

    def _held(self, trains: Sequence[tuple[Slot, Bool]]) -> Num:
        """The nearest far end of a train whose order was known."""
        held: Num = as_num(self._limit, MM)
        for one, ordered in trains:
            far = self._inward(self._of.num(one.high if self._side.is_low else one.low))
            held = ite(earlier_bool(self._of.bool(one.present & ordered)), minimum(held, far), held)
        return held
