"""Association of patterns with trains by their order on the track, never by the nearest (FVA-2; figures, 003 item 21).

    UNKNOWN  the trains in the area are not known: no pattern belongs to any train
    ORDERED  the trains in the area are known, in their order from the low end

On one track no train passes another. Axle counters report which train enters or leaves, and at which end; so the order is
known without any position. The fibre's patterns lie apart, in order. If there are exactly as many patterns as trains, the
first belongs to the first, and so on; otherwise none belongs to any train.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from safeloc.language.expr import Lit, Num, any_of, ite
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.models.train_order.cycle import Cycle
from safeloc.models.train_order.lemmas import lemmas
from safeloc.models.train_order.variables import Parts, TrainOrderConfig, parts
from safeloc.models.train_order.world import world

__all__ = ["REQUIREMENTS", "Parts", "TrainOrder", "TrainOrderConfig", "build", "machine", "parts"]

REQUIREMENTS = ("FVA-2", "FVA-11")


TrainOrder = Model[Parts]


def machine(config: TrainOrderConfig | None = None) -> Machine:
    """Return the machine that associates patterns with trains (FVA-2)."""
    return build(parts(config or TrainOrderConfig())).machine


def build(own: Parts) -> TrainOrder:
    """Return the machine over the given variables."""
    table = modes("UNKNOWN", "ORDERED")
    current, cycle = current_mode(table), Cycle(own)
    made = own.declared.machine(
        name="train_order",
        modes=table,
        outputs={
            "ordered": current.eq(table[1]),
            "associated": any_of(one > 0 for one in own.belongs),
            **{f"train_of_pattern_{n}": one for n, one in enumerate(own.belongs, 1)},
            "outermost_low": ite(current.eq(table[1]), own.order[0], 0),
            "outermost_high": ite(current.eq(table[1]), _last(own.order), 0),
        },
        transitions=list(_table(own, cycle, table)),
        world=world(own),
        lemmas=lemmas(own, current.eq(table[1])),
        definitions={"patterns match trains": cycle.matched, "events possible": cycle.possible},
        doc=(
            "Associates patterns with trains by the order of trains on the track. Assumed: undisturbed counters "
            "report every train that enters or leaves, unless their reports are impossible; no train passes "
            "another; if there are as many patterns as trains and they lie apart, each pattern contains a train."
        ),
    )
    return Model(made, own)


def _last(order: Sequence[Num]) -> Num:
    """Return the last number of the order that is a train's; 0 if there is none."""
    last = order[0]
    for one in order[1:]:
        last = ite(one.ne(0), one, last)
    return last


def _table(own: Parts, cycle: Cycle, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unknown, ordered = table
    no_order: Updates = dict.fromkeys(own.order, 0)
    order: Updates = dict(zip(own.order, cycle.after, strict=True))
    nobodys: Updates = dict.fromkeys(own.belongs, 0)
    theirs: Updates = dict(zip(own.belongs, cycle.after, strict=True))
    nothing = together(no_order, nobodys)
    quiet = own.enters_low.eq(0) & own.enters_high.eq(0) & ~own.leaves_low & ~own.leaves_high
    yield Transition("order lost", table, unknown, own.fault, nothing, REQUIREMENTS, 0)
    yield Transition("impossible event", ordered, unknown, ~cycle.possible, nothing, REQUIREMENTS, 1)
    yield Transition("area is empty", table, ordered, own.clear & quiet, nothing, REQUIREMENTS, 2)
    yield Transition(
        "patterns belong to trains", ordered, ordered, cycle.matched, together(order, theirs), REQUIREMENTS, 3)  # fmt: skip
    yield Transition(
        "patterns belong to nobody", ordered, ordered, ~cycle.matched, together(order, nobodys), REQUIREMENTS, 3)  # fmt: skip
