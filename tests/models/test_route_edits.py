"""A wrong edit of a term of the route machine is noticed by a proof: claims speak of truth and inputs, not of its terms."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Num, all_of, any_of, as_num, exact_to
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.units import MM, NM
from safeloc.models.route import build
from safeloc.models.route.cycle import Bounded, Cycle
from safeloc.models.route.variables import Parts, RouteConfig, parts
from safeloc.models.vocabulary.odometer import Odometer
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.route import properties
from tests.models.edited_terms import edited, keeps
from tests.models.inductive import changed

CONFIG = RouteConfig(routes=2)
HAS_NOT = "route 1 is given up where a reflector is sighted that it does not have"
ONLY_SEEN = "route 1 is refuted only by what is seen"
TRUE_ROUTE = "the true route is carried"
NONE_LEFT, ON_THE_MAP = "all routes are given up only where none is left", "what the map knows gives no route up"
STARTED = "a start with a route is carried"
WIDTH = "given up for its width only where it may be too wide"


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(CONFIG))
    return model.machine, properties(model)


def placed(cycle: Cycle, error: Num | int, sign: int = -1) -> tuple[Num, Num]:
    """Where the sighting puts the vehicle, with another error or sign of the range."""
    place = exact_to(cycle.route.reflector.value + cycle.own.sighting_range.value * sign, NM)
    return place - error, place + error


def run(cycle: Cycle, sign: int = 1, more: int = 0) -> tuple[Num, Num]:
    """The bounds after the measured distance, run the other way or widened."""
    distance, growth = exact_to(cycle.own.odometer.distance, NM) * sign, cycle.own.odometer.growth + more
    return cycle.route.low + distance - growth, cycle.route.high + distance + growth


def there(cycle: Cycle, *, anywhere: bool = False, any_model: bool = False) -> Bool:
    """The route has what was sighted, by laxer tests."""
    (low, high), (first, last), route = cycle.moved, cycle.sighted, cycle.route
    place = TRUE if anywhere else (first <= high) & (low <= last)
    return route.reflector.present & place & (TRUE if any_model else route.model.eq(cycle.own.sighting_model))


Wrong = Callable[..., object]
EDITS: dict[str, tuple[type, str, Wrong, str]] = {
    "odometer error not added": (Odometer, "growth", lambda _o, right: right * 0, TRUE_ROUTE),
    "blind cycles not added": (Odometer, "growth", lambda o, _: o.most_error, TRUE_ROUTE),
    "any distance admitted": (Odometer, "admitted", lambda o, _: o.measured.present, TRUE_ROUTE),
    "a change of speed is no gate": (
        Odometer, "_jump", lambda _o, _r: FALSE, "a distance is admitted just if it can have been run"),
    "silent odometer not noticed": (Odometer, "failed", lambda _o, _r: FALSE, "a silent odometer ends the report"),
    "noticed a cycle early": (
        Odometer, "failed", lambda o, _: ~o.admitted & (o.gap >= o.limits.gap_limit - 1), "a silent odometer ends the report"),
    "the distance is run backwards": (Cycle, "moved", lambda c, _: run(c, -1), TRUE_ROUTE),
    "a metre too much is added": (
        Cycle, "moved", lambda c, _: run(c, more=10**9), "route 1 widens only by what was run"),
    "the range counts from behind": (Cycle, "sighted", lambda c, _: placed(c, exact_to(c.own.sighting_error, NM), 1), TRUE_ROUTE),
    "the constant is not added to a sighting": (
        Cycle, "sighted", lambda c, _: placed(c, exact_to(c.own.sighting_error, NM)), TRUE_ROUTE),
    "the sighting's error is not added": (Cycle, "sighted", lambda c, _: placed(c, c.own.half_nm), TRUE_ROUTE),
    "the sighting's error is added twice": (
        Cycle, "sighted", lambda c, _: placed(c, exact_to(c.own.sighting_error * 2, NM) + c.own.half_nm),
        "route 1 is where its reflector is sighted"),
    "what is sighted does not narrow": (Cycle, "seen", lambda _c, _r: FALSE, "route 1 is where its reflector is sighted"),
    "an unknown model counts": (Cycle, "seen", lambda c, _: c.own.sighting_range.present, ONLY_SEEN),
    "another track's reflector refutes": (Cycle, "doubtful", lambda _c, _r: FALSE, TRUE_ROUTE),
    "an own reflector there is taken for the one that is sighted": (Cycle, "doubtful", lambda c, r: r & ~c.has_it, TRUE_ROUTE),
    "what stands by the own track tells nothing": (Cycle, "doubtful", lambda c, _: c.route.other_in_view, HAS_NOT),
    "what does not stand by the own track tells nothing": (
        Cycle, "doubtful", lambda c, _: ~c.own.sighting_by_own_track, HAS_NOT),
    "unseen refutes": (Cycle, "fits", lambda c, _: c.has_it & c.turns_so, ONLY_SEEN),
    "any place fits": (Cycle, "has_it", lambda c, _: there(c, anywhere=True), HAS_NOT),
    "any model fits": (Cycle, "has_it", lambda c, _: there(c, any_model=True), HAS_NOT),
    "nothing has to be there": (Cycle, "has_it", lambda _c, _r: TRUE, HAS_NOT),
    "a turn refutes nothing": (Cycle, "turns_so", lambda _c, _r: TRUE, "route 1 is given up for a turn that it does not take"),
    "no turn refutes a course": (Cycle, "turns_so", lambda c, _: c.own.course_taken.eq(c.route.course), ONLY_SEEN),
    "the start's error is not added": (Cycle, "spread", lambda c, _: as_num(c.own.half_nm, NM), TRUE_ROUTE),
    "the constant is not added to a start": (Cycle, "spread", lambda c, _: exact_to(c.own.start_error.value, NM), TRUE_ROUTE),
    "every width is tolerable": (Bounded, "tolerable", lambda _b, _r: TRUE, "tolerance"),
    "half the width is tolerable": (
        Bounded, "tolerable", lambda b, right: right & (b.high - b.low <= exact_to(as_num(CONFIG.tolerance_mm, MM), NM)),
        "given up for its width only where it may be too wide"),
}  # fmt: skip


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    owner, name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)


def _doubtful(own: Parts) -> Bool:
    """Two routes are possible, and what is sighted may stand beside another track."""
    elsewhere = any_of(route.other_in_view for route in own.routes) & ~own.sighting_by_own_track
    return all_of(route.possible for route in own.routes) & own.sighting_range.present & elsewhere


def _unrecognised(own: Parts) -> Bool:
    """One route is decided, and what is sighted shows no model."""
    first, second = own.routes
    return all_of([own.sighting_range.present, own.sighting_model.eq(NO_MODEL), first.possible, ~second.possible])


def _many(own: Parts) -> Bool:
    """Several routes begin at the start."""
    return own.start_error.present & all_of(route.candidate for route in own.routes)


def _wide_before_the_sighting(own: Parts) -> Bool:
    """Run on, the interval of a route is too wide, and nothing was asked of what is sighted in this cycle."""
    return any_of(
        ~Bounded(own, route.possible, *Cycle(own, route).moved).tolerable & route.possible for route in own.routes
    )


ROWS: dict[str, tuple[str, Callable[[Parts], Bool], tuple[str, ...]]] = {
    "another track's reflector ends an undecided route": ("no route fits", _doubtful, (NONE_LEFT, ON_THE_MAP)),
    "an unknown model ends a decided route": ("no route fits", _unrecognised, (NONE_LEFT, ON_THE_MAP)),
    "two routes at a start are none": ("start without a route", _many, (STARTED,)),
    "the width is asked before the sighting": ("tolerance exceeded", _wide_before_the_sighting, (WIDTH,)),
}


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("edit", ROWS)
def test_a_machine_that_gives_every_route_up_is_noticed(edit: str) -> None:
    """It keeps every claim that speaks of a machine which carries routes: then no route is false, and the true one is given up as well."""
    name, more, claims = ROWS[edit]
    model = build(parts(CONFIG))
    [row] = [one for one in model.machine.transitions if one.name == name]
    wrong = changed(model.machine, name, when=row.when | more(model.own))
    assert [] == [claim for claim in claims if not keeps(made(), claim)]
    assert [] == [claim for claim in claims if keeps((wrong, properties(model)), claim)]
    assert keeps((wrong, properties(model)), TRUE_ROUTE)
