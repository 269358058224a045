"""Properties of the association of patterns with trains (FVA-2)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, before, between, exact_to, ite
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import COUNT, UM
from safeloc.models.train_order import REQUIREMENTS, Parts, TrainOrder

LAW = (
    "no train passes another; undisturbed counters report each train that enters or leaves, unless their reports "
    "are impossible; if there are as many patterns as trains, lying apart, each contains a train"
)
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(model: TrainOrder) -> list[Property]:
    """Return the properties: a pattern of a train contains it; in any doubt no pattern belongs to a train."""
    associated = model.machine.flag("associated")
    seen = reachable(
        "associated", associated, statement="patterns can be associated with trains", requirements=REQUIREMENTS
    )
    return [*_true(model), *_patterns(model), *_faults(model), *_begins(model), *_ends(model), *_follows(model), seen]


def _true(model: TrainOrder) -> Iterator[Property]:
    """Claim order and association against the true trains on the track."""
    machine, own = model.machine, model.own
    yield always(
        "a pattern holds its train",
        all_of(_held(own, rank) for rank in range(len(own.belongs))),
        statement="the train to which a pattern belongs is within that pattern, however near other trains are",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )
    listed = [train.inside.iff(any_of(one.eq(train.number) for one in own.order)) for train in own.trains]
    yield always(
        "the order is that on the track",
        machine.flag("ordered").implies(all_of([*listed, _from_the_low_end(own)])),
        statement="while an order is known, it names exactly the trains that are between the counters, from the low end on",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )
    yield always(
        "the outermost trains are those on the track",
        all_of(_outermost(model)),
        statement="a train that is named as outermost is between the counters, and no train there is nearer to that end; none is named "
        "exactly if no order is known or no train is there",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )


def _held(own: Parts, rank: int) -> Bool:
    """Return the condition that the train to which the pattern belongs is within it."""
    low, high = exact_to(own.lows[rank], UM), exact_to(own.highs[rank], UM)
    told = own.belongs[rank]
    return all_of(told.eq(train.number).implies(between(low, train.place, high)) for train in own.trains)


def _outermost(model: TrainOrder) -> Iterator[Bool]:
    """Yield what is claimed of the outermost train at either end."""
    trains, is_ordered = model.own.trains, model.machine.flag("ordered")
    anyone = any_of(train.inside for train in trains)
    for named, sign in ((model.machine.output("outermost_low"), 1), (model.machine.output("outermost_high"), -1)):
        yield named.ne(0).iff(is_ordered & anyone)
        for train in trains:
            none_beyond = all_of(~one.inside | (one.place * sign >= train.place * sign) for one in trains)
            yield named.eq(train.number).implies(train.inside & none_beyond)


def _from_the_low_end(own: Parts) -> Bool:
    """Return the condition that of two trains named one after the other the second is farther up."""
    pairs = [(a, b) for a in own.trains for b in own.trains if a is not b]
    return all_of(
        (one.ne(a.number) | other.ne(b.number)) | (b.place > a.place)
        for one, other in zip(own.order, own.order[1:], strict=False)
        for a, b in pairs
    )


def _patterns(model: TrainOrder) -> Iterator[Property]:
    """Claim the association of patterns from the known order."""
    machine, own = model.machine, model.own
    associated, is_ordered = machine.flag("associated"), machine.flag("ordered")
    trains = _how_many(one.ne(0) for one in own.order)
    yield for_all_inputs(
        "another number of patterns belongs to nobody",
        associated.implies(is_ordered & own.patterns.eq(trains) & _lie_apart(own)),
        statement="with more or fewer patterns than trains, or patterns that overlap, no pattern belongs to a train in that cycle",
    )
    yield for_all_inputs(
        "as many patterns as trains belong to them in their order",
        (is_ordered & own.patterns.eq(trains) & _lie_apart(own)).implies(
            all_of(one.eq(train) for one, train in zip(own.belongs, own.order, strict=True))
        ),
        statement="with as many patterns as trains, lying apart, the first pattern belongs to the first train, and so on, in that cycle",
    )
    yield for_all_inputs(
        "associated patterns are somebody's",
        associated.iff(any_of(one.ne(0) for one in own.belongs)),
        statement="patterns are reported as associated exactly if one of them belongs to a train",
    )


def _faults(model: TrainOrder) -> Iterator[Property]:
    machine, own = model.machine, model.own
    associated, is_ordered = machine.flag("associated"), machine.flag("ordered")
    yield for_all_inputs(
        "a fault ends the order",
        own.fault.implies(~associated & ~is_ordered),
        statement="with a disturbed counter no order is known, until the area is empty",
    )


def _how_many(conditions: Iterable[Bool]) -> Num:
    total = as_num(0, COUNT)
    for one in conditions:
        total = total + ite(one, as_num(1, COUNT), 0)
    return total


def _lie_apart(own: Parts) -> Bool:
    """Return the condition that each pattern begins behind the one before it, and does not end before it begins."""
    terms = list[Bool]()
    for rank, (low, high) in enumerate(zip(own.lows, own.highs, strict=True)):
        behind = all_of([high >= low, low > own.highs[rank - 1]]) if rank else high >= low
        terms.append((own.patterns <= rank) | behind)
    return all_of(terms)


def _events(own: Parts) -> Num:
    """Return the number of events that the counters report in the cycle."""
    return _how_many([own.leaves_low, own.leaves_high, own.enters_low > 0, own.enters_high > 0])


def _begins(model: TrainOrder) -> Iterator[Property]:
    """Claim that an order begins with an empty area."""
    machine, own = model.machine, model.own
    unknown, ordered = machine.modes
    is_ordered = machine.mode.eq(ordered)
    nobody = all_of(one.eq(0) for one in own.order)
    yield for_all_inputs(
        "an order begins with an empty area",
        (before(machine.mode).eq(unknown) & is_ordered).implies(all_of([own.clear, nobody, _events(own).eq(0)])),
        statement="an order is known again only in a cycle in which the counters report an empty area, and no event",
    )


def _ends(model: TrainOrder) -> Iterator[Property]:
    """Claim the events that end an order."""
    machine, own = model.machine, model.own
    _, ordered = machine.modes
    was_ordered, is_ordered = before(machine.mode).eq(ordered), machine.mode.eq(ordered)
    nobody = all_of(one.eq(0) for one in own.order)
    none = before(own.order[0]).eq(0)
    impossible = {
        "two events at once": (_events(own) >= 2, "two events in one cycle"),
        "a train that is not there": (
            (own.leaves_low & none) | (own.leaves_high & none),
            "a train that leaves an area without trains",
        ),
        "a train that is there already": (
            _again(model),
            "a train that enters and is in the area already, or is one too many",
        ),
    }
    for name, (event, what) in impossible.items():
        yield for_all_inputs(
            f"{name} ends the order",
            (was_ordered & event).implies(~is_ordered & nobody & ~machine.flag("associated")),
            statement=f"{what}: no order is known any more, and no pattern belongs to a train, in that cycle",
        )
    yield for_all_inputs(
        "an order ends only for a reason",
        (was_ordered & ~is_ordered).implies(any_of([own.fault, *(event for event, _ in impossible.values())])),
        statement="a known order is given up only for a disturbed counter or an impossible event",
    )


def _follows(model: TrainOrder) -> Iterator[Property]:
    """Claim the change of the order with each event."""
    machine, own = model.machine, model.own
    _, ordered = machine.modes
    was_ordered, is_ordered = before(machine.mode).eq(ordered), machine.mode.eq(ordered)
    nobody = all_of(one.eq(0) for one in own.order)
    for name, moved in _moved(model).items():
        yield for_all_inputs(
            f"the order follows: {name}",
            (was_ordered & is_ordered & ~(own.clear & _events(own).eq(0))).implies(moved),
            statement="the order changes only by the event of the cycle, at the end of the area where it happened",
        )
    yield for_all_inputs(
        "an empty area has nobody in its order",
        (is_ordered & own.clear & _events(own).eq(0)).implies(nobody),
        statement="when the counters report an empty area, and no event, the order names no train",
    )


def _again(model: TrainOrder) -> Bool:
    """Return the condition that a train enters that is there already, or that there is no room for one more."""
    own, full = model.own, before(model.own.order[-1]).ne(0)
    again = [before(one).eq(told) for one in own.order for told in (own.enters_low, own.enters_high)]
    return any_of((told > 0) & any_of([full, *again[n::2]]) for n, told in enumerate((own.enters_low, own.enters_high)))


def _moved(model: TrainOrder) -> dict[str, Bool]:
    """Return the order after each event, from the low end to the high end."""
    own, ranks = model.own, range(len(model.own.order))
    now, earlier, zero = own.order, [before(one) for one in own.order], as_num(0, COUNT)
    trains = _how_many(one.ne(0) for one in earlier)
    up = [own.enters_low, *earlier[:-1]]
    down = [*earlier[1:], zero]
    joined = [ite(trains.eq(rank), own.enters_high, earlier[rank]) for rank in ranks]
    without_last = [ite(after.eq(0), zero, here) for here, after in zip(earlier, down, strict=True)]

    def becomes(told: Sequence[Num]) -> Bool:
        return all_of(one.eq(other) for one, other in zip(now, told, strict=True))

    return {
        "nothing happens": _events(own).eq(0).implies(becomes(earlier)),
        "in at the low end": (own.enters_low > 0).implies(becomes(up)),
        "in at the high end": (own.enters_high > 0).implies(becomes(joined)),
        "out at the low end": own.leaves_low.implies(becomes(down)),
        "out at the high end": own.leaves_high.implies(becomes(without_last)),
    }
