"""What must hold of route recognition (RFL-D6): the true route is always among those carried, and no sequence decides alone."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, between, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.route import Route
from safeloc.models.route.variables import NO_REASON, Hypothesis
from safeloc.models.turn_off import UNDECIDED
from safeloc.models.vocabulary.measured import ADMITTED

LAW = (
    "the true route is among the candidates at the start; admitted distances obey the error law; sightings and turns are "
    "true of the true route"
)
TRACE = ("RFL-D6",)


def properties(model: Route) -> list[Property]:
    """Every property of the route machine."""
    return [*_safety(model), *_refutation(model), *_reports(model), *_reached(model)]


def _carried(model: Route) -> Bool:
    _, undecided, decided, _ = model.machine.modes
    return model.machine.mode.one_of(undecided, decided)


def _bounds(model: Route, route: Hypothesis) -> tuple[Num, Num]:
    low, high = (model.machine.output(f"route_{route.number}_{end}_mm") for end in ("low", "high"))
    return exact_to(low, NM), exact_to(high, NM)


def _safety(model: Route) -> Iterator[Property]:
    machine, own = model.machine, model.own
    inside = [
        own.true_route.eq(route.number).implies(
            route.possible & between(_bounds(model, route)[0], own.truth, _bounds(model, route)[1])
        )
        for route in own.routes
    ]
    yield always(
        "the true route is carried",
        _carried(model).implies(all_of(inside)),
        statement="while anything is reported, the true route is among the hypotheses, and its interval holds the truth",
        requirements=TRACE,
        assumption=LAW,
    )
    yield always(
        "the decided route is true",
        machine.flag("valid").implies(machine.output("route").eq(own.true_route)),
        statement="a route that is stated is the one the vehicle is on",
        requirements=TRACE,
        assumption=LAW,
    )
    position, below, above = (
        exact_to(machine.output(f"{name}_mm"), NM) for name in ("position", "margin_below", "margin_above")
    )
    yield always(
        "containment",
        machine.flag("valid").implies(between(position - below, own.truth, position + above)),
        statement="once the route is decided, the reported interval along it holds the true distance from the start",
        requirements=TRACE,
        assumption=LAW,
    )
    yield always(
        "a right authority is never refuted",
        (_carried(model) & own.authorised.eq(own.true_route)).implies(~machine.flag("refutes_authority")),
        statement="a vehicle on the route of its movement authority is never reported to be off it",
        requirements=("RFL-D6", "RFL-12"),
        assumption=LAW,
    )


def _refutation(model: Route) -> Iterator[Property]:
    own = model.own
    begun = own.start.present
    for route in own.routes:
        was = earlier_bool(route.possible)
        yield always(
            f"route {route.number} does not come back",
            (route.possible & ~was).implies(begun & route.candidate),
            statement="a refuted route becomes possible again only at a start that leads along it",
            requirements=TRACE,
            unconditional=True,
        )
        yield always(
            f"route {route.number} is refuted only by what is seen",
            (was & ~route.possible & ~begun & _carried(model)).implies(_contradicts(model, route)),
            statement="a route is given up only for a sighted reflector that it does not have at that place, or a turn that "
            "it does not take; a reflector that is not seen refutes nothing",
            requirements=TRACE,
            unconditional=True,
        )
        width = route.high - route.low
        yield always(
            f"route {route.number} narrows only by a sighting",
            (was & route.possible & ~begun & ~own.seen).implies(
                width >= earlier_num(route.high) - earlier_num(route.low)
            ),
            statement="without a recognised reflector no interval narrows",
            requirements=TRACE,
            unconditional=True,
        )


def _contradicts(model: Route, route: Hypothesis) -> Bool:
    """The sighting cannot be this route's, by model or by place against the interval before; or the turn cannot."""
    own = model.own
    admitted = own.odometer.judged.eq(ADMITTED)
    far = exact_to(ite(admitted, own.odometer.step.value, as_num(0, MM)), NM)
    growth = ite(admitted, own.odometer.most_error, as_num(own.odometer.limits.blind_nm, NM))
    low, high = earlier_num(route.low) + far - growth, earlier_num(route.high) + far + growth
    error = exact_to(own.sighting_error, NM) + own.half_nm
    place = exact_to(route.reflector.value - own.sighting.value, NM)
    elsewhere = (place - error > high) | (place + error < low)
    missing = ~route.reflector.present | route.model.ne(own.sighting_model) | elsewhere
    turned = own.turned.ne(UNDECIDED) & route.course.ne(UNDECIDED) & own.turned.ne(route.course)
    return (own.seen & missing) | turned


def _reports(model: Route) -> Iterator[Property]:
    machine, own = model.machine, model.own
    silent = all_of(~route.possible for route in own.routes)
    yield always(
        "nothing is reported without a start",
        _carried(model) | (silent & machine.output("route").eq(0)),
        statement="idle or lost, no route and no interval is reported",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "no route left is no report",
        silent.implies(~_carried(model)),
        statement="the cycle in which no route fits any more is the cycle in which nothing is reported",
        requirements=TRACE,
        unconditional=True,
    )
    widths = []
    for route in own.routes:
        low, high = _bounds(model, route)
        widths.append(high - low <= as_num(2 * own.config.tolerance_mm * NM_PER_MM, NM))
    yield always(
        "tolerance",
        all_of(widths),
        statement="no reported interval is wider than the tolerable error to either side",
        requirements=("RFL-D6", "RFL-D1"),
        unconditional=True,
    )
    yield always(
        "reason stated",
        own.reason.eq(NO_REASON).iff(_carried(model)),
        statement="a reason is stated exactly while nothing is reported",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "no resurrection",
        (_carried(model) & ~earlier_bool(_carried(model))).implies(own.start.present),
        statement="after a contradiction only a new start, with its own reference, begins to report",
        requirements=TRACE,
        unconditional=True,
    )
    refuted = any_of(own.authorised.eq(route.number) & ~route.possible for route in own.routes)
    yield always(
        "authority",
        _carried(model).implies(machine.flag("refutes_authority").iff(refuted)),
        statement="that the route of the movement authority is refuted is reported in the same cycle",
        requirements=("RFL-D6", "RFL-12"),
        unconditional=True,
    )


def _reached(model: Route) -> Iterator[Property]:
    own = model.own
    for route in own.routes:
        yield reachable(
            f"route {route.number} is decided after others were possible",
            model.machine.fired("one route is left") & route.possible,
            statement="the route can be told from the others by what is seen",
            requirements=TRACE,
        )
