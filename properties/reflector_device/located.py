"""Properties of the reflector device as one: what its host gets, and what a telegram may do to it (RFL-1, RFL-5, RFL-9, RFL-D4).

No position of a balise is an input of the whole: that what the reflector machine is anchored by holds the front end is proved of
the balise machine. What a telegram says is compared with the raw telegram, and with the true place of the front end.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, before, between, exact_to
from safeloc.language.spec import Property, always
from safeloc.language.units import NM
from safeloc.models.reflector.balise_reading import BaliseReading
from safeloc.models.reflector.variables import BALISE_CONTRADICTS
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.models.stop_point.variables import HOLD, NO_ORDER, PROCEED
from safeloc.properties import turn_off
from safeloc.properties.reflector_device.host import LAW as SENSORS
from safeloc.properties.reflector_device.host import (
    accepted,
    astray,
    carrying,
    disproved,
    every_position_that_is_reported,
    interval_of,
    judged_by,
    of_source,
    only_an_accepted_group,
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
    makers = (_host, _rejected, _anchored, _distances, _by_map, _courses, _stops, _stopped_by)
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


# ------------------------------------------------------------------ what the balise machine rejects


def _rejected(whole: ReflectorDevice) -> Iterator[Property]:
    given = whole.source.own.balise
    inputs = (given.identity, given.position, given.accuracy, given.since, given.reference, given.search_from)
    read = any_of(_in_source(whole, one.present) for one in inputs)
    yield for_all_inputs(
        "a rejected telegram is no reading",
        (~accepted(whole)).implies(~read),
        statement="of a telegram that the balise machine does not accept, the reflector machine gets nothing: no place, no "
        "distance to a reflector, and no place from which to search for it",
        requirements=("RFL-5", "RFL-9", "RFL-D4"),
    )
    yield only_an_accepted_group(whole)
    yield for_all_inputs(
        "groups that contradict withdraw the position",
        disproved(whole).implies(withdrawn(whole)),
        statement="while the balise machine reports nothing because groups contradict its position, the host gets none by "
        "reflectors either, from the same cycle on",
        requirements=("RFL-D4", "RFL-D3"),
    )


# ------------------------------------------------------------------ what it accepts


def _anchored(whole: ReflectorDevice) -> Iterator[Property]:
    given, truth = whole.source.own.balise, whole.motion.own.ghosts.truth
    place, accuracy = _in_source_num(whole, given.position.value), _in_source_num(whole, given.accuracy.value)
    handed = _in_source(whole, given.identity.present) & _in_source(whole, given.position.present)
    position, below, above = interval_of(whole, whole.groups.machine)
    exact = all_of([_in_source(whole, given.accuracy.present), _in_source(whole, given.since.present)])
    group = whole.composition.of(whole.groups.machine).num(whole.groups.own.memory.group)
    yield for_all_inputs(
        "an accepted group is handed over",
        accepted(whole).implies(
            all_of([
                handed, exact, place.eq(position), (accuracy >= below) & (accuracy >= above),
                accuracy.eq(below) | accuracy.eq(above), _in_source_num(whole, given.since.value).eq(0),
                _in_source_num(whole, given.identity.value).eq(group),
            ])
        ),
        statement="every group that the balise machine accepts is a reading of the reflector machine in the same cycle, with its identity, the "
        "balise machine's position and the greater of its margins, at the end of the cycle",
        requirements=("RFL-5",),
    )  # fmt: skip
    yield under_assumption(
        "no accepted group contradicts the reflector machine",
        _in_source_num(whole, whole.source.machine.output("error")).ne(BALISE_CONTRADICTS),
        statement="the intervals of balise machine and reflector machine never exclude each other",
        requirements=("RFL-5", "RFL-D3"),
    )
    off, most = truth - exact_to(place, NM), exact_to(accuracy, NM)
    yield under_assumption(
        "a reading holds the front end",
        handed.implies(between(-most, off, most)),
        statement="the true position of the front end is no farther from a reading than its accuracy: no reading is stray",
        requirements=("RFL-5",),
    )


# ------------------------------------------------------------------ the distance that a telegram brings


def _distances(whole: ReflectorDevice) -> Iterator[Property]:
    given, ahead = whole.source.own.balise, whole.source.own.ahead
    raw, kept = whole.groups.own.read, whole.groups.own.memory.last_group_position
    telegram, place = whole.composition.of(whole.groups.machine), _in_source_num(whole, given.position.value)
    group = telegram.num(kept)
    for name, mine, theirs, least in (
        ("reflector", given.reference, raw.reflector, 0), ("search", given.search_from, raw.search, 1),
    ):  # fmt: skip
        told, distance = telegram.bool(theirs.present), telegram.num(theirs.value)
        left = group + distance - place
        fits = accepted(whole) & told & between(least, left, whole.config.reflector.range_limit_mm)
        yield for_all_inputs(
            f"the telegram's {name} distance is used",
            _in_source(whole, mine.present).iff(fits) & fits.implies(_in_source_num(whole, mine.value).eq(left)),
            statement=f"the {name} distance of an accepted telegram, counted from the group's place on the map, is handed over as "
            "what of it lies ahead of the position, wherever that is within the radar's range; no other distance is",
            requirements=("RFL-9",),
        )
    yield from _reflector_from_truth(whole, given, _in_source_num(whole, ahead.position.value))


def _by_map(whole: ReflectorDevice) -> Iterator[Property]:
    given, ahead, told = whole.source.own.balise, whole.source.own.ahead, whole.composition.of(whole.line.machine)
    entry, reference = whole.line.position, whole.line.reference
    yield for_all_inputs(
        "the map's next reflector is searched",
        _in_source(whole, ahead.position.present).iff(told.bool(entry.present))
        & told.bool(entry.present).implies(_in_source_num(whole, ahead.position.value).eq(told.num(entry.value))),
        statement="the reflector machine gets the map's next reflector in every cycle in which the map has one, at its place",
        requirements=("RFL-3", "RFL-9"),
    )
    group = whole.composition.of(whole.groups.machine).num(whole.groups.own.memory.last_group_position)
    left = group + told.num(reference.value) - _in_source_num(whole, given.position.value)
    fits = accepted(whole) & told.bool(reference.present) & between(0, left, whole.config.reflector.range_limit_mm)
    yield for_all_inputs(
        "the map's distance is used",
        _in_source(whole, ahead.reference.present).iff(fits)
        & fits.implies(_in_source_num(whole, ahead.reference.value).eq(left)),
        statement="the distance that the map has from an accepted group to its reflector is handed over as what of it lies ahead of the "
        "position, wherever that is within the radar's range; no other distance is",
        requirements=("RFL-6", "RFL-9"),
    )


def _reflector_from_truth(whole: ReflectorDevice, given: BaliseReading, mapped: Num) -> Iterator[Property]:
    """The distance that is handed over against the true place of the front end and the place of the reflector on the map."""
    ahead, truth = whole.source.own.ahead, whole.motion.own.ghosts.truth
    accuracy = _in_source_num(whole, given.accuracy.value) + whole.config.reflector.map_accuracy_mm
    off, most = exact_to(mapped, NM) - truth, exact_to(accuracy, NM)
    for name, told in (("telegram", given.reference), ("map", ahead.reference)):
        distance = exact_to(_in_source_num(whole, told.value), NM)
        known = _in_source(whole, told.present) & _in_source(whole, ahead.position.present)
        yield under_assumption(
            f"the distance by the {name} is that of the true front end",
            known.implies(between(-most, off - distance, most)),
            statement=f"the distance by the {name} is that from the true front end to the map's next reflector, within the accuracy of "
            "the reading and of the survey",
            requirements=("RFL-9", "RFL-6"),
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
    behind = whole.line.switch_reflector
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


def _in_source(whole: ReflectorDevice, term: Bool) -> Bool:
    return whole.composition.of(whole.source.machine).bool(term)


def _in_source_num(whole: ReflectorDevice, term: Num) -> Num:
    return whole.composition.of(whole.source.machine).num(term)
