"""Properties of reflectors with the direction of travel: a wrong direction ends the position, and only a wrong one does (RFL-D5, RFL-D3).

The comparison with the map is one of distance and of direction; a direction that is not the permitted one is a failed comparison.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool, Num, NumVar, before, between, exact_to
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import MS_PER_S, NM, NM_PER_MM
from safeloc.models.reflector_direction import ReflectorDirection
from safeloc.models.travel_direction.variables import AGAINST, UNKNOWN
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reasons import CONTRADICTION
from safeloc.properties import delocalized, travel_direction
from safeloc.properties.balise.step import LAW as GROUPS
from safeloc.properties.hearing import INTERVAL, hears_interval
from safeloc.properties.reflector.figures import LAW as RADAR
from safeloc.properties.travel_direction import LAW as MODELS

LAW = (
    f"{GROUPS}; {RADAR}; of odometer and check unit, where there are both, one keeps its law; telegram and map have a reflector at "
    f"one place; {MODELS}"
)
REQUIREMENTS = ("RFL-D5", "RFL-D3")
_OF_THE_DIRECTION = ("direction is true", "both models count", "another direction than expected contradicts")
_OF_THE_RESTRICTIVE_STATE = ("tolerance", "no resurrection", "same step")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: ReflectorDirection) -> list[Property]:
    """Return the properties of the whole device."""
    makers = (_host, _direction, _wrong_direction, _references, _turning, _runs)
    return [prop for maker in makers for prop in maker(whole)]


# ------------------------------------------------------------------ what the host gets


def _host(whole: ReflectorDirection) -> Iterator[Property]:
    yield _containment(whole)
    for claim in delocalized.properties(whole.restrictive, whole.config.host):
        if claim.name in _OF_THE_RESTRICTIVE_STATE:
            yield whole.composition.inherited(whole.restrictive, claim)
    host, source = whole.composition.of(whole.restrictive), whole.composition.of(whole.source.machine)
    same = hears_interval(host, [whole.restrictive.output(name) for name in INTERVAL], source, whole.source.machine)
    passed, valid = ~_restrictive(whole), _of_source(whole, "valid")
    yield for_all_inputs(
        "the host gets the reflector machine's interval",
        passed.implies(valid & same),
        statement="the position that the host gets, and both margins, are those that the reflector machine reports in this cycle",
        requirements=("RFL-1", "RFL-5"),
    )
    located = earlier_bool(passed) | _accepted(whole) | _measured(whole)
    yield for_all_inputs(
        "the host gets every position that is reported",
        (valid & located).implies(passed),
        statement="while the reflector machine reports a position, the host that had one keeps one, and one that had none gets it with the "
        "first accepted group or recognised reflector",
        requirements=("RFL-1", "RFL-5"),
    )


def _containment(whole: ReflectorDirection) -> Property:
    """Proved of the restrictive state, given that the reflector machine's interval holds the truth, which that machine has to keep."""
    machine, truth = whole.restrictive, next(iter(whole.restrictive.world.choices))  # the vehicle's, after the step
    assert isinstance(truth, NumVar)
    position, below, above = (machine.output(name) for name in ("position_mm", "margin_below_mm", "margin_above_mm"))
    own = under_assumption(
        "containment",
        machine.flag("restrictive") | between(exact_to(position - below, NM), truth, exact_to(position + above, NM)),
        statement="the position that the host gets contains the true position of the front end",
    )
    return replace(whole.composition.inherited(machine, own), name=own.name)


# ------------------------------------------------------------------ the direction, and a wrong one


def _direction(whole: ReflectorDirection) -> Iterator[Property]:
    for claim in travel_direction.properties(whole.direction):
        if claim.name in _OF_THE_DIRECTION:
            yield whole.composition.inherited(whole.direction.machine, claim)
    yield reachable(
        "a vehicle against the permitted direction is found",
        _in_direction(whole, "contradicts") & _stated(whole).eq(AGAINST),
        statement="the device can notice a vehicle that runs against the direction that route and movement authority give",
        requirements=REQUIREMENTS,
    )


def _wrong_direction(whole: ReflectorDirection) -> Iterator[Property]:
    restrictive, wrong = _restrictive(whole), _in_direction(whole, "contradicts")
    yield for_all_inputs(
        "a contradicted direction withdraws the position",
        wrong.implies(restrictive & ~_of_source(whole, "valid")),
        statement="in each cycle in which the vehicle runs in another direction than the permitted one, neither the host nor the reflector "
        "machine has a position",
    )
    line, groups = whole.composition.of(whole.line.machine), whole.composition.of(whole.groups.machine)
    route = line.bool(whole.line.contradicted)
    disproved = groups.num(whole.groups.machine.output("reason")).eq(CONTRADICTION)
    contradicted = whole.composition.of(whole.source.machine).bool(whole.source.own.contradicted)
    yield for_all_inputs(
        "direction, route and groups contradict, and nothing else",
        contradicted.iff(wrong | route | disproved),
        statement="a contradiction is wired to the reflector machine exactly in the cycles in which the direction is not the permitted one, the "
        "route is contradicted, or groups contradict the position",
    )


def _references(whole: ReflectorDirection) -> Iterator[Property]:
    restrictive, located = _restrictive(whole), _of_source(whole, "valid")
    yield for_all_inputs(
        "only a reference in the permitted direction ends a loss",
        (earlier_bool(restrictive) & ~restrictive).implies(
            (_accepted(whole) | _measured(whole)) & ~_in_direction(whole, "contradicts")
        ),
        statement="the restrictive state is left only in a cycle in which a group passed every check or a reflector was recognised, and the "
        "direction is not contradicted",
    )
    yield for_all_inputs(
        "only an accepted group anchors",
        (located & ~earlier_bool(located)).implies(_accepted(whole)),
        statement="the reflector machine reports a position again only in a cycle in which the balise machine accepted a group",
    )


# ------------------------------------------------------------------ what the direction rests on


def _turning(whole: ReflectorDirection) -> Iterator[Property]:
    own, into = whole.direction.own, whole.composition.of(whole.direction.machine)
    yield for_all_inputs(
        "the direction counts accepted groups",
        into.bool(own.balise_read).iff(_accepted(whole)),
        statement="a balise counts for the direction exactly in the cycles in which the balise machine accepted its group",
    )
    heading, groups = whole.groups.own.heading, whole.composition.of(whole.groups.machine)
    ahead = ~groups.bool(heading.backwards) & groups.num(heading.rolled).eq(0)
    measured = groups.num(whole.groups.machine.output("odometer")).eq(ADMITTED)
    yield for_all_inputs(
        "a vehicle turns only where it is measured to",
        into.bool(own.backwards).iff(~(ahead & measured)),
        statement="the reflectors that were passed no longer count exactly in the cycles in which the vehicle is measured behind the farthest "
        "place that it reached, or no distance is measured",
    )
    yield for_all_inputs(
        "a vehicle that turned has no direction",
        (~(ahead & measured)).implies(_stated(whole).eq(UNKNOWN)),
        statement="while the vehicle is measured behind the farthest place that it reached, and in a cycle without a measured distance, no "
        "direction is stated",
    )


def _runs(whole: ReflectorDirection) -> Iterator[Property]:
    groups, seen, odometer = (
        whole.composition.of(whole.groups.machine),
        whole.groups.own.world,
        whole.groups.own.odometer,
    )
    wander, truth = groups.num(seen.wander), groups.num(seen.truth)
    assert isinstance(wander, NumVar) and isinstance(truth, NumVar)
    law, period = whole.config.balise.odometer, whole.config.balise.period_ms
    floor = law.floor_mm_s * period * NM_PER_MM // MS_PER_S
    further: Num | int = 0 if odometer.more is None else groups.num(odometer.more)
    ran = (truth - before(truth)) - (wander - before(wander))
    yield under_assumption(
        "with a direction the vehicle runs on",
        _stated(whole).eq(UNKNOWN) | (ran + further >= -floor),
        statement="in each cycle at whose end a direction is stated, the front end truly ran on, or stood: apart from the change of the "
        "odometer's one-off error, its floor and what a check unit leaves open, it did not run back",
    )


# ------------------------------------------------------------------ words


def _stated(whole: ReflectorDirection) -> Num:
    machine = whole.direction.machine
    return whole.composition.of(machine).num(machine.output("direction"))


def _in_direction(whole: ReflectorDirection, output: str) -> Bool:
    return _flag(whole, whole.direction.machine, output)


def _of_source(whole: ReflectorDirection, output: str) -> Bool:
    return _flag(whole, whole.source.machine, output)


def _measured(whole: ReflectorDirection) -> Bool:
    """The reflector machine measures a reflector that it recognised."""
    return _of_source(whole, "precise") & _of_source(whole, "recognised")


def _restrictive(whole: ReflectorDirection) -> Bool:
    return _flag(whole, whole.restrictive, "restrictive")


def _accepted(whole: ReflectorDirection) -> Bool:
    """The balise machine reports a position, and the telegram of this cycle passed every check."""
    return _flag(whole, whole.groups.machine, "reference_accepted")


def _flag(whole: ReflectorDirection, machine: Machine, output: str) -> Bool:
    return whole.composition.of(machine).bool(machine.flag(output))
