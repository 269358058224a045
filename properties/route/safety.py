"""The true route is always among those carried, and what is stated of it is true."""

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
    """The claims of the true route."""
    machine, seen = model.machine, model.own.ghosts
    yield under_assumption(
        "the true route is carried",
        carried(model).implies(all_of(_holds_truth(model, route) for route in model.own.routes)),
        statement="while anything is reported, the true route is among the hypotheses, and its interval holds the truth",
    )
    yield under_assumption(
        "the decided route is true",
        machine.flag("valid").implies(machine.output("route").eq(seen.route)),
        statement="a route that is stated is the one the vehicle is on",
    )
    position, below, above = (
        exact_to(machine.output(f"{name}_mm"), NM) for name in ("position", "margin_below", "margin_above")
    )
    yield under_assumption(
        "containment",
        machine.flag("valid").implies(between(position - below, seen.truth, position + above)),
        statement="once the route is decided, the reported interval along it holds the true distance from the start",
    )
    yield under_assumption(
        "a right authority is never refuted",
        (carried(model) & model.own.authorised.eq(seen.route)).implies(~machine.flag("refutes_authority")),
        statement="a vehicle on the route of its movement authority is never reported to be off it",
        requirements=("RFL-D6", "RFL-12"),
    )


def _holds_truth(model: Route, route: Hypothesis) -> Bool:
    (low, high), seen = bounds(model, route), model.own.ghosts
    return seen.route.eq(route.number).implies(route.possible & between(low, seen.truth, high))
