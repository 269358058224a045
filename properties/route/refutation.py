"""Reasons for which a route is given up, and for which it is not; and the change of its interval."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.spec import Property, always, earlier_bool
from safeloc.models.route import Route
from safeloc.models.route.variables import Hypothesis, Parts
from safeloc.properties.route.figures import REQUIREMENTS, Told, carried, ran

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def refutation(model: Route) -> Iterator[Property]:
    """Yield the properties of each route."""
    for route in model.own.routes:
        told = Told(model.own, route)
        yield from _possible(model, told)
        yield from _interval(model.own, route, told)


def _possible(model: Route, told: Told) -> Iterator[Property]:
    route, begun = told.route, model.own.start.present
    yield for_all_inputs(
        f"route {route.number} does not come back",
        (route.possible & ~earlier_bool(route.possible)).implies(begun & route.candidate),
        statement="a refuted route becomes possible again only at a start from which it begins",
    )
    yield for_all_inputs(
        f"route {route.number} begins where the start leads along it",
        (begun & carried(model)).implies(route.possible.iff(route.candidate)),
        statement="after a start exactly those routes are possible that begin there",
    )
    given_up = told.went_on & ~route.possible & carried(model)
    yield for_all_inputs(
        f"route {route.number} is refuted only by what is seen",
        given_up.implies(told.turned_away | (told.never_there & ~told.unseen)),
        statement="a route is given up only for a sighted reflector that it does not have at that place, or a turn that it does "
        "not take; a reflector that is not seen refutes nothing",
    )
    yield for_all_inputs(
        f"route {route.number} is given up where a reflector is sighted that it does not have",
        (told.went_on & told.never_there).implies(told.unseen | ~route.possible),
        statement="a sighting refutes a route that has no reflector of that model where the vehicle would see it",
    )
    yield for_all_inputs(
        f"route {route.number} is given up for a turn that it does not take",
        (told.went_on & told.turned_away).implies(~route.possible),
        statement="a turn that is seen refutes each route that takes another course there",
    )


def _interval(own: Parts, route: Hypothesis, told: Told) -> Iterator[Property]:
    kept, width = told.went_on & route.possible, route.high - route.low
    (least, most), before = ran(own), told.high - told.low
    yield for_all_inputs(
        f"route {route.number} narrows only by a sighting",
        (kept & told.unseen).implies(width >= before),
        statement="without a recognised reflector no interval narrows",
    )
    yield for_all_inputs(
        f"route {route.number} is where its reflector is sighted",
        kept.implies(told.unseen | ((told.place - route.low <= told.slack) & (route.high - told.place <= told.slack))),
        statement="after a sighting the interval lies within the sighting's error of the reflector's place less the range",
    )
    yield for_all_inputs(
        f"route {route.number} widens only by what was run",
        kept.implies((route.low - told.low >= least) & (route.high - told.high <= most)),
        statement="in a cycle neither end moves outward by more than the measured distance and the odometer's error",
    )
