"""Reasons for which a route is given up, or all of them are, and for which they are not; and the change of its interval."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import all_of, any_of
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.models.route import Route
from safeloc.models.route.variables import SENSOR_FAILURE, TOLERANCE, Hypothesis, Parts
from safeloc.properties.route.figures import LAW, REQUIREMENTS, CycleEvidence, carried, given_up, ran

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def refutation(model: Route) -> Iterator[Property]:
    """Yield the properties of each route."""
    for route in model.own.routes:
        evidence = CycleEvidence(model.own, route)
        yield from _possible(model, evidence)
        yield from _interval(model.own, route, evidence)
    yield from _all_given_up(model)


def _possible(model: Route, evidence: CycleEvidence) -> Iterator[Property]:
    route, begun = evidence.route, model.own.start_error.present
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
    given_up = evidence.went_on & ~route.possible & carried(model)
    yield for_all_inputs(
        f"route {route.number} is refuted only by what is seen",
        given_up.implies(evidence.turned_away | (evidence.never_there & ~evidence.silent)),
        statement="a route is given up only for a sighted reflector that it does not have at that place and that cannot be another "
        "track's in view, or a turn that it does "
        "not take; a reflector that is not seen refutes nothing",
    )
    yield for_all_inputs(
        f"route {route.number} is given up where a reflector is sighted that it does not have",
        (evidence.went_on & evidence.never_there).implies(evidence.silent | ~route.possible),
        statement="a sighting refutes a route that has no reflector of that model where the vehicle would see it, unless the map has "
        "another track's in view and the image does not stand by the own track",
    )
    yield for_all_inputs(
        f"route {route.number} is given up for a turn that it does not take",
        (evidence.went_on & evidence.turned_away).implies(~route.possible),
        statement="a turn that is seen refutes each route that takes another course there",
    )


def _all_given_up(model: Route) -> Iterator[Property]:
    """Yield the properties of a cycle in which the machine gives all routes up, neither for a width nor for a silent odometer."""
    own, begun = model.own, model.own.start_error.present
    contradicted = given_up(model) & own.reason.ne(TOLERANCE) & own.reason.ne(SENSOR_FAILURE)
    yield for_all_inputs(
        "all routes are given up only where none is left",
        contradicted.implies(all_of(CycleEvidence(own, route).refuted for route in own.routes)),
        statement="for no other reason than its width or a silent odometer the machine gives all routes up, unless each that was possible is refuted by "
        "what is seen in that cycle",
    )
    named = any_of(route.reflector.present | route.other_in_view for route in own.routes)
    yield always(
        "what the map knows gives no route up",
        contradicted.implies(~CycleEvidence(own, own.routes[0]).unseen & ~named),
        statement="the true route is given up with all others only in a cycle in which a reflector is sighted of whose model the map has none in view of "
        "any route, for its width, or for a silent odometer",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )
    yield for_all_inputs(
        "a start with a route is carried",
        begun.implies(carried(model).iff(any_of(route.candidate for route in own.routes))),
        statement="in the cycle of a start the machine reports routes exactly if any begins there",
    )


def _interval(own: Parts, route: Hypothesis, evidence: CycleEvidence) -> Iterator[Property]:
    kept, width = evidence.went_on & route.possible, route.high - route.low
    (least, most), before = ran(own), evidence.high - evidence.low
    yield for_all_inputs(
        f"route {route.number} narrows only by a sighting",
        (kept & evidence.silent).implies(width >= before),
        statement="without a recognised reflector, or with one that may be another track's, no interval narrows",
    )
    yield for_all_inputs(
        f"route {route.number} is where its reflector is sighted",
        kept.implies(
            evidence.silent
            | ((evidence.place - route.low <= evidence.slack) & (route.high - evidence.place <= evidence.slack))
        ),
        statement="after a sighting that cannot be of another track's reflector the interval lies within the sighting's error of the "
        "reflector's place less the range",
    )
    yield for_all_inputs(
        f"route {route.number} widens only by what was run",
        kept.implies((route.low - evidence.low >= least) & (route.high - evidence.high <= most)),
        statement="in a cycle neither end moves outward by more than the measured distance and the odometer's error",
    )
