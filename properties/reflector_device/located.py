"""Properties of the reflector device as one: what its host gets, and what a telegram may do to it (RFL-1, RFL-5, RFL-9, RFL-D4).

What balise groups do to the reflector machine is claimed as in every composition that has both (`properties/reflector_anchor.py`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Num, all_of, any_of, before, between, exact_to
from safeloc.language.spec import Property, always
from safeloc.language.units import NM
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.models.stop_point.variables import HOLD, NO_ORDER, PROCEED
from safeloc.properties import reflector_anchor, turn_off
from safeloc.properties.reflector_device.host import LAW as SENSORS
from safeloc.properties.reflector_device.host import (
    anchoring,
    astray,
    carrying,
    disproved,
    every_position_that_is_reported,
    interval_of,
    judged_by,
    of_source,
    other_route,
    restrictive,
    the_reflector_machines_interval,
    what_the_host_gets,
    withdrawn,
)
from safeloc.properties.stop_point.place import LAW as BRAKES
from safeloc.properties.turn_off import LAW as IMAGES

LAW = f"{SENSORS}; {IMAGES}; {BRAKES}"
REQUIREMENTS = ("RFL-1", "RFL-5", "RFL-9")
_OF_THE_COURSE = ("course is true", "contradiction")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: ReflectorDevice) -> list[Property]:
    """Return the properties of the whole device."""
    makers = (_host, _anchored, _courses, _stops, _stopped_by)
    return [prop for maker in makers for prop in maker(whole)]


# ------------------------------------------------------------------ what the host gets


def _host(whole: ReflectorDevice) -> Iterator[Property]:
    yield from what_the_host_gets(whole, LAW, REQUIREMENTS)
    yield the_reflector_machines_interval(whole)
    yield every_position_that_is_reported(
        whole,
        "the host gets every position that is reported",
        any_of([~carrying(whole), other_route(whole), astray(whole)]),
        "while the reflector machine reports a position, a route is carried, and course and route are the permitted ones, the host that had a "
        "position keeps one, by odometer as well as by reflector, and one that had none gets it with the first accepted group or recognised reflector",
    )


# ------------------------------------------------------------------ what balise groups do to the reflector machine


def _anchored(whole: ReflectorDevice) -> Iterator[Property]:
    yield from reflector_anchor.properties(anchoring(whole, LAW))
    yield for_all_inputs(
        "groups that contradict withdraw the position",
        disproved(whole).implies(withdrawn(whole)),
        statement="while the balise machine reports nothing because groups contradict its position, the host gets none by "
        "reflectors either, from the same cycle on",
        requirements=("RFL-D4", "RFL-D3"),
    )


# ------------------------------------------------------------------ the course at a switch


def _courses(whole: ReflectorDevice) -> Iterator[Property]:
    machine, own = whole.course.machine, whole.course.own
    into, source = whole.composition.of(machine), whole.source.machine
    for claim in turn_off.properties(whole.course):
        if claim.name in _OF_THE_COURSE:
            yield whole.composition.inherited(machine, claim)
    yield for_all_inputs(
        "a course that is not permitted withdraws the position",
        astray(whole).implies(restrictive(whole)),
        statement="in a cycle in which the vehicle is seen on another course than map and movement authority give, the host gets no position",
        requirements=("RFL-12",),
    )
    behind = whole.switch.reflector
    place = _in_source_num(whole, source.output("reflector_position_mm"))
    shown = whole.composition.of(whole.line.machine)
    yield for_all_inputs(
        "only the reflector behind the switch shows the course",
        into.bool(own.measured).iff(
            all_of([of_source(whole, "precise"), shown.bool(behind.present), place.eq(shown.num(behind.value))])
        ),
        statement="the course is judged by the image of a reflector that is measured in this cycle, and that the map has behind the switch",
        requirements=("RFL-12",),
    )
    yield for_all_inputs(
        "a switch is taken up only ahead of the interval",
        into.bool(own.switch_position.present).implies(into.num(own.switch_position.value) > into.num(own.high)),
        statement="a switch is watched only from where the whole interval lies before it",
        requirements=("RFL-12",),
    )
    yield for_all_inputs(
        "the course is judged by the reported interval",
        judged_by(whole, whole.source.machine),
        statement="before, on and beyond a switch are judged by the ends of the reported interval, as far as they are on the line, and "
        "by those of the line without one",
        requirements=("RFL-12",),
    )
    truth = whole.motion.own.ghosts.truth
    low, high = (exact_to(into.num(one), NM) for one in (own.low, own.high))
    yield under_assumption(
        "the course is judged by an interval that holds the front end",
        between(low, truth, high),
        statement="the true front end lies in the interval by which the machine judges whether the vehicle is before, on or beyond a switch",
        requirements=("RFL-12",),
    )


# ------------------------------------------------------------------ the stop at a platform


def _stops(whole: ReflectorDevice) -> Iterator[Property]:
    """Proved of the stop-point machine for the interval that the host gets, with the true place of the front end."""
    own, machine = whole.stop.own, whole.stop.machine
    proceeds = machine.output("order").eq(PROCEED) & own.pending_number.eq(before(own.pending_number))
    foremost, end = exact_to(own.position + own.above, NM), exact_to(own.stop + own.after, NM)
    for name, front, words in (
        ("brake order in time", own.next_truth, "the true front end"),
        (
            "brake order from the max safe front end",
            foremost,
            "the max safe front end of the interval that the host gets",
        ),
    ):
        claim = under_assumption(
            name,
            proceeds.implies(front + own.run_out <= end),
            statement="the vehicle may proceed to a stop only while the guaranteed brake, ordered in the next cycle, still stops "
            f"{words} within the stop window or before it",
            requirements=("RFL-D7",),
        )
        yield replace(whole.composition.inherited(machine, claim), name=name)
    ordered = whole.composition.of(machine).num(machine.output("order"))
    yield for_all_inputs(
        "without a position nothing moves",
        restrictive(whole).implies(ordered.one_of(NO_ORDER, HOLD)),
        statement="while the vehicle is restrictive it has the order to hold, or none if no stop is pending",
        requirements=("RFL-D7", "MRK-D2"),
    )


def _stopped_by(whole: ReflectorDevice) -> Iterator[Property]:
    """The stop is made by the host's interval: another one that holds the front end would keep every claim about the brake order."""
    own, into, passed = whole.stop.own, whole.composition.of(whole.stop.machine), ~restrictive(whole)
    heard = [into.num(one) for one in (own.position, own.below, own.above)]
    same = all_of(a.eq(b) for a, b in zip(heard, interval_of(whole, whole.restrictive), strict=True))
    yield for_all_inputs(
        "the stop is made by the interval that the host gets",
        into.bool(own.valid).iff(passed) & passed.implies(same),
        statement="the stop-point machine reads the position and both margins that the host gets in this cycle, and has no position "
        "while the host has none",
        requirements=("RFL-D7",),
    )
    yield for_all_inputs(
        "a stop is measured only while a reflector is",
        into.bool(own.precise).iff(passed & of_source(whole, "precise")),
        statement="the stop-point machine takes the position for measured in the cycles in which the host has one and the reflector "
        "machine measures a reflector, and in no others",
        requirements=("RFL-D7",),
    )


# ------------------------------------------------------------------ words


def _in_source_num(whole: ReflectorDevice, term: Num) -> Num:
    return whole.composition.of(whole.source.machine).num(term)
