"""The true route is always among the possible ones, and the reports about it are true."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, between, exact_to
from safeloc.language.spec import Property, always
from safeloc.language.units import NM
from safeloc.models.route import Route
from safeloc.models.route.variables import Hypothesis
from safeloc.properties.route.figures import LAW, REQUIREMENTS, bounds, carried

under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def safety(model: Route) -> Iterator[Property]:
    """Yield the properties of the true route."""
    machine, seen = model.machine, model.own.ghosts
    yield under_assumption(
        "the true route is carried",
        carried(model).implies(all_of(_holds_truth(model, route) for route in model.own.routes)),
        statement="while the machine reports any route, the true one is possible, and its interval contains the true place",
    )
    yield under_assumption(
        "the decided route is true",
        machine.flag("valid").implies(machine.output("route").eq(seen.route)),
        statement="a decided route is the one on which the vehicle runs",
    )
    position, below, above = (
        exact_to(machine.output(f"{name}_mm"), NM) for name in ("position", "margin_below", "margin_above")
    )
    yield under_assumption(
        "containment",
        machine.flag("valid").implies(between(position - below, seen.truth, position + above)),
        statement="while the route is decided, the reported interval along it contains the true distance from the start",
    )
    yield under_assumption(
        "a right authority is never refuted",
        (carried(model) & model.own.authorised_route.eq(seen.route)).implies(~machine.flag("refutes_authority")),
        statement="the machine never reports that a vehicle on the route of its movement authority is off it",
        requirements=("RFL-D6", "RFL-12"),
    )


def _holds_truth(model: Route, route: Hypothesis) -> Bool:
    (low, high), seen = bounds(model, route), model.own.ghosts
    return seen.route.eq(route.number).implies(route.possible & between(low, seen.truth, high))
