"""Terms of one cycle: the order after its events, and the match of patterns and trains."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import TRUE, Bool, Num, all_of, as_num, ite
from safeloc.language.units import COUNT
from safeloc.models.train_order.variables import Parts


@dataclass(frozen=True, eq=False)
class Cycle:
    """The events of a cycle and its patterns, compared with the known order."""

    own: Parts

    @property
    def after(self) -> tuple[Num, ...]:
        """The order after the event of the cycle; there is at most one."""
        own, none, order = self.own, as_num(0, COUNT), self.own.order
        up = [own.enters_low, *order[:-1]]
        down = [*order[1:], none]
        result = []
        for rank, here in enumerate(order):
            last = here.ne(0) & (order[rank + 1].eq(0) if rank + 1 < len(order) else TRUE)
            joined = here.eq(0) & (order[rank - 1].ne(0) if rank else TRUE)
            term: Num = ite(own.leaves_high & last, none, here)
            term = ite((own.enters_high > 0) & joined, own.enters_high, term)
            term = ite(own.leaves_low, down[rank], term)
            result.append(ite(own.enters_low > 0, up[rank], term))
        return tuple(result)

    @property
    def possible(self) -> Bool:
        """There is at most one event, of a train that can make it."""
        own = self.own
        events = [own.enters_low > 0, own.enters_high > 0, own.leaves_low, own.leaves_high]
        pairs = [~(a & b) for n, a in enumerate(events) for b in events[:n]]
        enters = events[0] | events[1]
        new = [one.ne(0).implies(one.ne(own.enters_low) & one.ne(own.enters_high)) for one in own.order]
        empty = (events[2] | events[3]) & own.order[0].eq(0)
        return all_of([*pairs, enters.implies(own.order[-1].eq(0)), enters.implies(all_of(new)), ~empty])

    @property
    def apart(self) -> Bool:
        """The patterns lie apart, in order."""
        own, terms = self.own, list[Bool]()
        for rank, (low, high) in enumerate(zip(own.lows, own.highs, strict=True)):
            seen = own.patterns > rank
            terms.append(seen.implies(low <= high))
            if rank:
                terms.append(seen.implies(own.highs[rank - 1] < low))
        return all_of(terms)

    @property
    def matched(self) -> Bool:
        """There are as many patterns as trains, and they lie apart."""
        own = self.own
        trains = [one.ne(0).iff(own.patterns > rank) for rank, one in enumerate(self.after)]
        return all_of([*trains, own.patterns <= len(own.order), self.apart])
