"""The world of the machine that associates patterns with trains: trains between the counters, their places, and patterns.

    trains    keep their order: on one track none passes another
    counters  undisturbed, report each train that enters or leaves, and at which end; or their reports are impossible
    patterns  contain a train each, if there are as many of them as trains and they lie apart

Impossible are a train that enters and is there already, one that leaves an empty area, and two events at once: nothing is
assumed of the counters in such a cycle. Nothing is assumed of patterns if their number differs from that of the trains.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from safeloc.language.expr import Bool, Expr, Num, Var, all_of, any_of, as_num, between, exact_to, ite
from safeloc.language.units import COUNT, UM
from safeloc.language.world import Law, World
from safeloc.models.train_order.variables import Parts, TrainGhosts


def world(own: Parts) -> World:
    """Return the world: the trains, and the laws of counters and patterns."""
    moves: dict[Var, Expr] = {}
    for train in own.trains:
        moves |= {train.inside: train.next_inside, train.place: train.next_place}
    return own.declared.world(
        moves=moves,
        clauses={
            "trains keep their order": _order_law(own),
            "a leaving train is reported with its end": _leaving_law(own),
            "an entering train is reported with its end": _entering_law(own),
            "an area that is reported as empty is empty": _empty_law(own),
            "each of as many patterns holds a train": _pattern_law(own),
        },
    )


def many(conditions: Iterable[Bool]) -> Num:
    """Return how many of the conditions hold."""
    total = as_num(0, COUNT)
    for one in conditions:
        total = ite(one, total + 1, total)
    return total


# ------------------------------------------------------------------ trains


def _order_law(own: Parts) -> Law:
    pairs = [(a, b) for a in own.trains for b in own.trains if a is not b]
    kept = [
        all_of([a.inside, b.inside, a.next_inside, b.next_inside, a.place < b.place]).implies(
            a.next_place < b.next_place
        )
        for a, b in pairs
    ]
    apart = [
        (a.next_inside & b.next_inside).implies(a.next_place.ne(b.next_place)) for a, b in pairs if a.number < b.number
    ]
    return Law(
        all_of([*kept, *apart]),
        "Of two trains between the counters the one that is ahead stays ahead, and they are never at one place.",
        source="[S] 003 item 21: one track",
        owner="infrastructure",
        check="no switch and no track beside it between the counters",
    )


def _outermost(own: Parts, train: TrainGhosts, before: Callable[[TrainGhosts, TrainGhosts], Bool]) -> Bool:
    return all_of(before(train, other) for other in own.trains if other is not train)


def _first(own: Parts, train: TrainGhosts) -> Bool:
    """Return the condition that before the cycle no other train was nearer to the low end."""
    return _outermost(own, train, lambda a, b: b.inside.implies(a.place < b.place))


def _last(own: Parts, train: TrainGhosts) -> Bool:
    return _outermost(own, train, lambda a, b: b.inside.implies(a.place > b.place))


def _first_now(own: Parts, train: TrainGhosts) -> Bool:
    """Return the condition that after the cycle no other train is nearer to the low end."""
    return _outermost(own, train, lambda a, b: b.next_inside.implies(a.next_place < b.next_place))


def _last_now(own: Parts, train: TrainGhosts) -> Bool:
    return _outermost(own, train, lambda a, b: b.next_inside.implies(a.next_place > b.next_place))


# ------------------------------------------------------------------ counters


def _disturbed(own: Parts) -> Bool:
    """Return the condition that a counter reports a disturbance, or the counters' reports are impossible."""
    empty = all_of(~train.inside for train in own.trains)
    there = [
        train.inside & any_of(number.eq(train.number) for number in (own.enters_high, own.enters_low))
        for train in own.trains
    ]
    events = many([own.leaves_low, own.leaves_high, own.enters_low.ne(0), own.enters_high.ne(0)])
    return any_of([own.fault, *there, empty & own.leaves_low, empty & own.leaves_high, events > 1])


def _leaving_law(own: Parts) -> Law:
    terms = list[Bool]()
    for event, outermost in ((own.leaves_low, _first), (own.leaves_high, _last)):
        terms.append(event.implies(any_of(_left(train) & outermost(own, train) for train in own.trains)))
    for train in own.trains:
        by = [(own.leaves_low & _first(own, train)), (own.leaves_high & _last(own, train))]
        terms.append(_left(train).implies(any_of(by)))
    return Law(
        _disturbed(own) | all_of(terms),
        "Undisturbed counters report each train that has left the area, and at which end: there no other was "
        "before it.",
        source="[M] axle counters at both ends; complete trains [D]",
        owner="supplier",
        check="counts at both ends agree whenever the area is empty",
    )


def _left(train: TrainGhosts) -> Bool:
    return train.inside & ~train.next_inside


def _entering_law(own: Parts) -> Law:
    terms = list[Bool]()
    for train in own.trains:
        low, high = own.enters_low.eq(train.number), own.enters_high.eq(train.number)
        terms.append((train.next_inside & ~train.inside).iff(low | high))
        terms += [low.implies(_first_now(own, train)), high.implies(_last_now(own, train))]
    return Law(
        _disturbed(own) | all_of(terms),
        "Undisturbed counters report each train that has entered the area, by its number, and at which end: "
        "there no other is before it.",
        source="[M] axle counters at both ends; the number by train control [D]",
        owner="supplier",
        check="counts at both ends agree whenever the area is empty",
    )


def _empty_law(own: Parts) -> Law:
    return Law(
        (own.clear & ~own.fault).implies(all_of(~train.next_inside for train in own.trains)),
        "Undisturbed counters report an empty area only if no train is in it.",
        source="[M] axle counters",
        owner="supplier",
        check="safety case of the counters",
    )


# ------------------------------------------------------------------ patterns


def _pattern_law(own: Parts) -> Law:
    as_many = own.patterns.eq(many(train.next_inside for train in own.trains))
    held = [(own.patterns <= rank) | _holds(own, rank) for rank in range(len(own.owners))]
    return Law(
        (as_many & _apart(own)).implies(all_of(held)),
        "If the fibre sees as many patterns, lying apart, as trains are in the area, each pattern contains a "
        "train: a pattern without a train never comes together with a train that is not seen, or with two that "
        "are seen as one.",
        source="[D] 003 item 21; each alone changes the number",
        owner="supplier",
        check="commissioning runs with several trains; patterns against trains are counted in operation",
    )


def _apart(own: Parts) -> Bool:
    """Return the condition that no pattern reaches into the next one."""
    ends = [end for pair in zip(own.lows, own.highs, strict=True) for end in pair]
    absent = [own.patterns < 1 + number // 2 for number in range(len(ends))]
    return all_of(
        absent[n + 1] | ((ends[n + 1] >= ends[n]) if n % 2 == 0 else (ends[n + 1] > ends[n]))
        for n in range(len(ends) - 1)
    )


def _holds(own: Parts, rank: int) -> Bool:
    """Return the condition that the pattern contains a train that is in the area."""
    low, high = exact_to(own.lows[rank], UM), exact_to(own.highs[rank], UM)
    return any_of(
        all_of([own.owners[rank].eq(train.number), train.next_inside, between(low, train.next_place, high)])
        for train in own.trains
    )
