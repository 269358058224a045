"""Properties of the reflector device with its direction of travel: a wrong direction ends the position, and only a wrong one does (RFL-D5, RFL-D3).

The comparison with the map is one of distance and of direction; a direction that is not the permitted one is a failed comparison.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, NumVar, any_of, before
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import MS_PER_S, NM_PER_MM
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.models.travel_direction.variables import AGAINST, UNKNOWN
from safeloc.properties import travel_direction
from safeloc.properties.reflector_device.host import LAW as SENSORS
from safeloc.properties.reflector_device.host import (
    accepted,
    astray,
    carrying,
    disproved,
    flag,
    lost_route,
    of_source,
    only_a_reference,
    other_route,
    runs_on,
    withdrawn,
)
from safeloc.properties.travel_direction import LAW as MODELS

LAW = f"{SENSORS}; {MODELS}"
REQUIREMENTS = ("RFL-D5", "RFL-D3")
_OF_THE_DIRECTION = ("direction is true", "both models count", "another direction than expected contradicts")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: ReflectorDevice) -> list[Property]:
    """Return the properties of the whole device that concern its direction."""
    makers = (_direction, _wrong_direction, _turning, _runs)
    return [prop for maker in makers for prop in maker(whole)]


# ------------------------------------------------------------------ the direction, and a wrong one


def _direction(whole: ReflectorDevice) -> Iterator[Property]:
    for claim in travel_direction.properties(whole.direction):
        if claim.name in _OF_THE_DIRECTION:
            yield whole.composition.inherited(whole.direction.machine, claim)
    yield reachable(
        "a vehicle against the permitted direction is found",
        _in_direction(whole, "contradicts") & _stated(whole).eq(AGAINST),
        statement="the device can notice a vehicle that runs against the direction that route and movement authority give",
        requirements=REQUIREMENTS,
    )


def _wrong_direction(whole: ReflectorDevice) -> Iterator[Property]:
    wrong = _in_direction(whole, "contradicts")
    yield for_all_inputs(
        "a contradicted direction withdraws the position",
        wrong.implies(withdrawn(whole)),
        statement="in each cycle in which the vehicle runs in another direction than the permitted one, neither the host nor the reflector "
        "machine has a position",
    )
    contradicted = whole.composition.of(whole.source.machine).bool(whole.source.own.contradicted)
    against = any_of([lost_route(whole), other_route(whole), astray(whole)])
    before = earlier_bool(of_source(whole, "valid") & against)
    yield for_all_inputs(
        "direction, route and groups contradict, and nothing else",
        contradicted.iff(any_of([wrong, disproved(whole), before])),
        statement="a contradiction is wired to the reflector machine exactly in the cycles in which the direction is not the permitted one, or groups "
        "contradict the position, or in the cycle before it had a position on a lost route, or course or route were not the permitted ones",
        requirements=(*REQUIREMENTS, "RFL-D6", "RFL-12"),
    )
    yield only_a_reference(
        whole,
        "only a reference in the permitted direction ends a loss",
        carrying(whole) & ~wrong,
        "the restrictive state is left only in a cycle in which a group passed every check or a reflector was recognised, a route is carried, and the "
        "direction is not contradicted",
        (*REQUIREMENTS, "RFL-5", "RFL-D6", "MRK-D1"),
    )


# ------------------------------------------------------------------ what the direction rests on


def _turning(whole: ReflectorDevice) -> Iterator[Property]:
    own, into = whole.direction.own, whole.composition.of(whole.direction.machine)
    yield for_all_inputs(
        "the direction counts accepted groups",
        into.bool(own.balise_read).iff(accepted(whole)),
        statement="a balise counts for the direction exactly in the cycles in which the balise machine accepted its group",
    )
    yield for_all_inputs(
        "a vehicle turns only where it is measured to",
        into.bool(own.backwards).iff(~runs_on(whole)),
        statement="the reflectors that were passed no longer count exactly in the cycles in which the vehicle is measured behind the farthest "
        "place that it reached, or no distance is measured",
    )
    yield for_all_inputs(
        "a vehicle that turned has no direction",
        (~runs_on(whole)).implies(_stated(whole).eq(UNKNOWN)),
        statement="while the vehicle is measured behind the farthest place that it reached, and in a cycle without a measured distance, no "
        "direction is stated",
    )


def _runs(whole: ReflectorDevice) -> Iterator[Property]:
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


def _stated(whole: ReflectorDevice) -> Num:
    machine = whole.direction.machine
    return whole.composition.of(machine).num(machine.output("direction"))


def _in_direction(whole: ReflectorDevice, output: str) -> Bool:
    return flag(whole, whole.direction.machine, output)
