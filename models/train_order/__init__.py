"""Which pattern is which train: by their order on the track, never by the nearest (FVA-2; figures, 003 item 21).

    UNKNOWN  it is not known which trains are in the area: no pattern belongs to anyone
    ORDERED  the trains in the area are known, in their order from the low end

On one track no train passes another. Axle counters tell which train enters or leaves, and at which end; so the order is
known without any position. The fibre's patterns lie apart, in order. Only when there are just as many as trains, the
first belongs to the first, and so on; otherwise none belongs to anyone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    boolean,
    exact_to,
    ite,
    number,
)
from safeloc.language.machine import ANY, Machine, Model, Transition, current_mode, modes
from safeloc.language.units import COUNT, MM, UM
from safeloc.language.world import World

TRACE = ("FVA-2", "FVA-11")


class TrainOrderConfig(Config):
    """How many trains are told apart."""

    trains: int = quantity(3, "count", 1, 8, "[D] trains at a time in 10 to 40 km")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine. Trains are numbers from 1 on; 0 is none.

    enters_low, enters_high, leaves_low, leaves_high  what the axle counters at both ends tell, complete trains
    clear     the axle counters tell that the area is empty
    fault     a counter is disturbed
    patterns  how many patterns the fibre sees; lows, highs: where, in order
    order     the trains in the area, from the low end; belongs: whose the patterns are
    there, places  ghosts: which trains are in the area, and where (um)
    """

    config: TrainOrderConfig
    enters_low: NumVar
    enters_high: NumVar
    leaves_low: BoolVar
    leaves_high: BoolVar
    clear: BoolVar
    fault: BoolVar
    patterns: NumVar
    lows: tuple[NumVar, ...]
    highs: tuple[NumVar, ...]
    order: tuple[NumVar, ...]
    belongs: tuple[NumVar, ...]
    places: tuple[NumVar, ...]
    next_places: tuple[NumVar, ...]
    owners: tuple[NumVar, ...]

    @property
    def inputs(self) -> list[Var]:
        """What is heard in a cycle."""
        counters: list[Var] = [self.enters_low, self.enters_high, self.leaves_low, self.leaves_high]
        return [*counters, self.clear, self.fault, self.patterns, *self.lows, *self.highs]

    @property
    def after(self) -> tuple[Num, ...]:
        """The order after the events of the cycle, of which there is at most one."""
        none, order = as_num(0, COUNT), self.order
        up = [self.enters_low, *order[:-1]]
        down = [*order[1:], none]
        result = []
        for rank, here in enumerate(order):
            last = here.ne(0) & (order[rank + 1].eq(0) if rank + 1 < len(order) else TRUE)
            joined = here.eq(0) & (order[rank - 1].ne(0) if rank else TRUE)
            term: Num = ite(self.leaves_high & last, none, here)
            term = ite((self.enters_high > 0) & joined, self.enters_high, term)
            term = ite(self.leaves_low, down[rank], term)
            result.append(ite(self.enters_low > 0, up[rank], term))
        return tuple(result)

    @property
    def possible(self) -> Bool:
        """At most one event, of a train that can make it."""
        events = [self.enters_low > 0, self.enters_high > 0, self.leaves_low, self.leaves_high]
        pairs = [~(a & b) for n, a in enumerate(events) for b in events[:n]]
        enters = events[0] | events[1]
        new = [one.ne(0).implies(one.ne(self.enters_low) & one.ne(self.enters_high)) for one in self.order]
        empty = (events[2] | events[3]) & self.order[0].eq(0)
        return all_of([*pairs, enters.implies(self.order[-1].eq(0)), enters.implies(all_of(new)), ~empty])

    @property
    def apart(self) -> Bool:
        """The patterns lie apart, in order."""
        terms = []
        for rank, (low, high) in enumerate(zip(self.lows, self.highs, strict=True)):
            seen = self.patterns > rank
            terms.append(seen.implies(low <= high))
            if rank:
                terms.append(seen.implies(self.highs[rank - 1] < low))
        return all_of(terms)

    @property
    def matched(self) -> Bool:
        """As many patterns as trains, apart."""
        trains = [one.ne(0).iff(self.patterns > rank) for rank, one in enumerate(self.after)]
        return all_of([*trains, self.patterns <= len(self.order), self.apart])


def parts(config: TrainOrderConfig) -> Parts:
    """Fresh variables for one area."""
    count, far = config.trains, config.position_limit_mm
    ranks = range(1, count + 1)
    return Parts(
        config,
        number("enters_low", COUNT, 0, count),
        number("enters_high", COUNT, 0, count),
        boolean("leaves_low"),
        boolean("leaves_high"),
        boolean("counters_clear"),
        boolean("counter_fault"),
        number("patterns", COUNT, 0, count + 1),
        tuple(number(f"pattern_{n}_low_mm", MM, -far, far) for n in ranks),
        tuple(number(f"pattern_{n}_high_mm", MM, -far, far) for n in ranks),
        tuple(number(f"order_{n}", COUNT, 0, count) for n in ranks),
        tuple(number(f"pattern_{n}_train", COUNT, 0, count) for n in ranks),
        tuple(number(f"train_{n}_place_um", UM, -far * 1_000, far * 1_000) for n in ranks),
        tuple(number(f"next_train_{n}_place_um", UM, -far * 1_000, far * 1_000) for n in ranks),
        tuple(number(f"pattern_{n}_owner", COUNT, 0, count) for n in ranks),
    )


TrainOrder = Model[Parts]


def machine(config: TrainOrderConfig | None = None) -> Machine:
    """The machine that tells whose a pattern is (FVA-2)."""
    return build(parts(config or TrainOrderConfig())).machine


def build(own: Parts) -> TrainOrder:
    """The machine over the given variables."""
    table = modes("UNKNOWN", "ORDERED")
    current = current_mode(table)
    made = Machine(
        name="train_order",
        modes=table,
        inputs=own.inputs,
        state=dict.fromkeys((*own.order, *own.belongs), 0),
        outputs={
            "ordered": current.eq(table[1]),
            "associated": any_of(one > 0 for one in own.belongs),
            **{f"train_of_pattern_{n}": one for n, one in enumerate(own.belongs, 1)},
        },
        transitions=list(_table(own, table)),
        world=World(
            ghosts=dict.fromkeys(own.places, ANY),
            choices=[*own.next_places, *own.owners],
            moves=dict(zip(own.places, own.next_places, strict=True)),
            clauses=_clauses(own, current.eq(table[1])),
            reads_machine="its clauses still assume what passes the machine's own checks",
        ),
        lemmas=_lemmas(own, current.eq(table[1])),
        definitions={"patterns match trains": own.matched, "events possible": own.possible},
        mode_variable=current,
        doc=(
            "Whose a pattern is, by the order of trains on the track. Assumed: undisturbed counters tell every train that "
            "enters or leaves; no train passes another; where there are as many patterns as trains and they lie apart, "
            "each pattern holds a train of its own."
        ),
    )
    return Model(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unknown, ordered = table
    zero = as_num(0, COUNT)
    nobody: dict[Var, Expr] = dict.fromkeys((*own.order, *own.belongs), zero)
    kept: dict[Var, Expr] = dict(zip(own.order, own.after, strict=True))
    nobodys: dict[Var, Expr] = dict.fromkeys(own.belongs, zero)
    theirs: dict[Var, Expr] = dict(zip(own.belongs, own.after, strict=True))
    yield Transition("order lost", table, unknown, own.fault, nobody, TRACE, 0)
    yield Transition("impossible event", ordered, unknown, ~own.possible, nobody, TRACE, 1)
    quiet = own.enters_low.eq(0) & own.enters_high.eq(0) & ~own.leaves_low & ~own.leaves_high
    yield Transition("area is empty", table, ordered, own.clear & quiet, nobody, TRACE, 2)
    yield Transition("patterns belong to trains", ordered, ordered, own.matched, {**kept, **theirs}, TRACE, 3)
    yield Transition("patterns belong to nobody", ordered, ordered, ~own.matched, {**kept, **nobodys}, TRACE, 3)


def place_of(train: Num, places: Sequence[NumVar]) -> Num:
    """Ghost: where a train is."""
    place: Num = places[0]
    for number_, one in enumerate(places[1:], 2):
        place = ite(train.eq(number_), one, place)
    return place


def _in_order(order: Sequence[Num], places: Sequence[NumVar]) -> Bool:
    return all_of(
        order[rank + 1].ne(0).implies(place_of(order[rank], places) < place_of(order[rank + 1], places))
        for rank in range(len(order) - 1)
    )


def _clauses(own: Parts, ordered: Bool) -> dict[str, Bool]:
    """Trains keep their order; a train enters at its end; each of so many patterns holds a train of its own."""
    told = ordered & ~own.fault & own.possible
    owners = [between(exact_to(low, UM), place_of(owner, own.next_places), exact_to(high, UM)) for low, high, owner in
              zip(own.lows, own.highs, own.owners, strict=True)]  # fmt: skip
    among = [any_of(owner.eq(one) for one in own.after) & owner.ne(0) for owner in own.owners]
    seen = [(own.patterns > rank).implies(owners[rank] & among[rank]) for rank in range(len(own.owners))]
    return {
        "trains keep their order": told.implies(_in_order(own.after, own.next_places)),
        "each of as many patterns holds a train of its own": (told & own.matched).implies(all_of(seen)),
    }


def _lemmas(own: Parts, ordered: Bool) -> dict[str, Bool]:
    gaps = [own.order[rank].eq(0).implies(own.order[rank + 1].eq(0)) for rank in range(len(own.order) - 1)]
    apart = [a.ne(0).implies(a.ne(b)) for n, a in enumerate(own.order) for b in own.order[:n]]
    return {
        "the order has no gaps": all_of(gaps),
        "no train is there twice": all_of(apart),
        "the order is true": ordered.implies(_in_order(own.order, own.places)),
    }
