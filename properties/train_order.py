"""What must hold of the association of patterns with trains (FVA-2)."""

from __future__ import annotations

from safeloc.expr import all_of, between, exact_to
from safeloc.models.train_order import TRACE, TrainOrder, place_of
from safeloc.properties.step import guard
from safeloc.spec import Property, always, reachable
from safeloc.units import UM

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
            trace=TRACE,
            assumption=LAW,
        ),
        always(
            "another number of patterns belongs to nobody",
            (~guard(machine, own.matched)).implies(~associated),
            statement="more or fewer patterns than trains, or patterns that overlap: none belongs to anyone, in that cycle",
            trace=TRACE,
            unconditional=True,
        ),
        always(
            "a fault ends the order",
            own.fault.implies(~associated & ~machine.flag("ordered")),
            statement="with a disturbed counter no order is known, until the area is empty",
            trace=TRACE,
            unconditional=True,
        ),
        reachable("associated", associated, statement="patterns can be told apart", trace=TRACE),
    ]
