"""What must hold of the association of patterns with trains (FVA-2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from safeloc.language.expr import TRUE, Bool, Num, all_of, any_of, as_num, before, between, exact_to, ite
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import COUNT, UM
from safeloc.models.train_order import TRACE, TrainOrder, place_of
from safeloc.properties.in_step import in_step

LAW = "no train passes another; as many patterns as trains, lying apart, hold a train each"


def properties(model: TrainOrder) -> list[Property]:
    """A pattern that belongs to a train holds it; any doubt, and no pattern belongs to anyone."""
    machine, own = model.machine, model.own
    associated = machine.flag("associated")
    held = [
        one.ne(0).implies(between(exact_to(low, UM), place_of(one, own.places), exact_to(high, UM)))
        for one, low, high in zip(own.belongs, own.lows, own.highs, strict=True)
    ]
    fired = machine.fired("patterns belong to trains")
    return [
        always(
            "a pattern holds its train",
            fired.implies(all_of(held)),
            statement="the train that a pattern is said to be is within that pattern, however near others are",
            requirements=TRACE,
            assumption=LAW,
        ),
        always(
            "another number of patterns belongs to nobody",
            (~in_step(machine, own.matched)).implies(~associated),
            statement="more or fewer patterns than trains, or patterns that overlap: none belongs to anyone, in that cycle",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a fault ends the order",
            own.fault.implies(~associated & ~machine.flag("ordered")),
            statement="with a disturbed counter no order is known, until the area is empty",
            requirements=TRACE,
            unconditional=True,
        ),
        *_order(model),
        reachable("associated", associated, statement="patterns can be told apart", requirements=TRACE),
    ]


def _order(model: TrainOrder) -> Iterator[Property]:
    """The order is that of the counters' events since the area was empty; what cannot be ends it."""
    machine, own = model.machine, model.own
    unknown, ordered = machine.modes
    was_ordered, is_ordered = before(machine.mode).eq(ordered), machine.mode.eq(ordered)
    events = (own.enters_low > 0, own.enters_high > 0, own.leaves_low, own.leaves_high)
    nobody = all_of(one.eq(0) for one in own.order)
    yield always(
        "an order begins with an empty area",
        (before(machine.mode).eq(unknown) & is_ordered).implies(own.clear & nobody),
        statement="an order is known again only in a cycle in which the counters tell that the area is empty",
        requirements=TRACE,
        unconditional=True,
    )
    several = any_of(one & other for n, one in enumerate(events) for other in events[:n])
    nobody_leaves = (own.leaves_low | own.leaves_high) & before(own.order[0]).eq(0)
    impossible = {
        "two events at once": (several, "two events in one cycle"),
        "a train that is not there": (nobody_leaves, "a train that leaves an area without trains"),
        "a train that is there already": (
            _again(model),
            "a train that enters and is in the area already, or is one too many",
        ),
    }
    for name, (event, what) in impossible.items():
        yield always(
            f"{name} ends the order",
            (was_ordered & event).implies(~is_ordered & nobody & ~machine.flag("associated")),
            statement=f"{what}: no order is known any more, and no pattern belongs to anyone, in that cycle",
            requirements=TRACE,
            unconditional=True,
        )
    for name, moved in _moved(model).items():
        yield always(
            f"the order follows: {name}",
            (was_ordered & is_ordered & ~machine.fired("area is empty")).implies(moved),
            statement="the order changes only by the event of the cycle, at the end of the area where it happened",
            requirements=TRACE,
            unconditional=True,
        )


def _again(model: TrainOrder) -> Bool:
    own = model.own
    full = before(own.order[-1]).ne(0)
    there = any_of(before(one).ne(0) & before(one).one_of(own.enters_low, own.enters_high) for one in own.order)
    return ((own.enters_low > 0) | (own.enters_high > 0)) & (full | there)


def _moved(model: TrainOrder) -> dict[str, Bool]:
    """What becomes of the order by each event, from the low end to the high end."""
    own, ranks = model.own, range(len(model.own.order))
    now, earlier, zero = own.order, [before(one) for one in own.order], as_num(0, COUNT)
    quiet = own.enters_low.eq(0) & own.enters_high.eq(0) & ~own.leaves_low & ~own.leaves_high
    first_free = [earlier[rank].eq(0) & (earlier[rank - 1].ne(0) if rank else TRUE) for rank in ranks]
    up = [own.enters_low, *earlier[:-1]]
    down = [*earlier[1:], zero]
    joined = [ite(first_free[rank], own.enters_high, earlier[rank]) for rank in ranks]
    without_last = [ite(after.eq(0), zero, here) for here, after in zip(earlier, down, strict=True)]

    def becomes(told: Sequence[Num]) -> Bool:
        return all_of(one.eq(other) for one, other in zip(now, told, strict=True))

    return {
        "nothing happens": quiet.implies(becomes(earlier)),
        "in at the low end": (own.enters_low > 0).implies(becomes(up)),
        "in at the high end": (own.enters_high > 0).implies(becomes(joined)),
        "out at the low end": own.leaves_low.implies(becomes(down)),
        "out at the high end": own.leaves_high.implies(becomes(without_last)),
    }
