"""Claims on what the host of the reflector device gets, its law, and the words in which all its claims are said (RFL-1, RFL-5, RFL-D3).

The host's position is that of the reflector machine, which begins only from groups that the balise machine accepted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from safeloc.language.expr import Bool, Num, NumVar, all_of, any_of, between, exact_to, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.properties import delocalized
from safeloc.properties.balise.step import LAW as GROUPS
from safeloc.properties.hearing import INTERVAL, hears_interval
from safeloc.properties.reflector.figures import LAW as RADAR
from safeloc.properties.reflector_anchor import Anchoring

LAW = f"{GROUPS}; {RADAR}; of odometer and check unit, where there are both, one keeps its law; telegram and map have the reflector behind an accepted group at one place"
"""What is assumed of the sensors that locate it."""
REQUIREMENTS = ("RFL-1", "RFL-5")
_OF_THE_RESTRICTIVE_STATE = ("tolerance", "no resurrection", "same step")


# ------------------------------------------------------------------ claims


def what_the_host_gets(whole: ReflectorDevice, law: str, requirements: tuple[str, ...]) -> Iterator[Property]:
    """Yield that the host's position holds the front end, and what the restrictive state keeps by itself."""
    yield _containment(whole, law, requirements)
    for claim in delocalized.properties(whole.restrictive, whole.config.host):
        if claim.name in _OF_THE_RESTRICTIVE_STATE:
            yield whole.composition.inherited(whole.restrictive, claim)


def _containment(whole: ReflectorDevice, law: str, requirements: tuple[str, ...]) -> Property:
    """Proved of the restrictive state, given that the reflector machine's interval holds the truth, which that machine has to keep."""
    machine, truth = whole.restrictive, next(iter(whole.restrictive.world.choices))  # the vehicle's, after the step
    assert isinstance(truth, NumVar)
    position, below, above = (machine.output(name) for name in INTERVAL)
    own = always(
        "containment",
        machine.flag("restrictive") | between(exact_to(position - below, NM), truth, exact_to(position + above, NM)),
        statement="the position that the host gets contains the true position of the front end",
        requirements=requirements,
        assumption=law,
    )
    return replace(whole.composition.inherited(machine, own), name=own.name)


def the_reflector_machines_interval(whole: ReflectorDevice) -> Property:
    """Return that the host's position is that of the reflector machine: another interval that holds the front end would keep containment too."""
    host, source = whole.composition.of(whole.restrictive), whole.composition.of(whole.source.machine)
    same = hears_interval(host, [whole.restrictive.output(name) for name in INTERVAL], source, whole.source.machine)
    return always(
        "the host gets the reflector machine's interval",
        (~restrictive(whole)).implies(of_source(whole, "valid") & same),
        statement="the position that the host gets, and both margins, are those that the reflector machine reports in this cycle",
        requirements=REQUIREMENTS,
        unconditional=True,
    )


def every_position_that_is_reported(whole: ReflectorDevice, name: str, unless: Bool, statement: str) -> Property:
    """Return that no position of the reflector machine is held back without a reason."""
    passed = ~restrictive(whole)
    located = earlier_bool(passed) | accepted(whole) | measured(whole)
    return always(
        name,
        all_of([of_source(whole, "valid"), ~unless, located]).implies(passed),
        statement=statement,
        requirements=REQUIREMENTS,
        unconditional=True,
    )


def only_a_reference(
    whole: ReflectorDevice, name: str, allowed: Bool, statement: str, requirements: tuple[str, ...]
) -> Property:
    """Return that only an accepted group or a recognised reflector ends a loss, and only while that is allowed."""
    lost = restrictive(whole)
    return always(
        name,
        (earlier_bool(lost) & ~lost).implies((accepted(whole) | measured(whole)) & allowed),
        statement=statement,
        requirements=requirements,
        unconditional=True,
    )


# ------------------------------------------------------------------ words


def restrictive(whole: ReflectorDevice) -> Bool:
    """Return whether the host has no position."""
    return flag(whole, whole.restrictive, "restrictive")


def withdrawn(whole: ReflectorDevice) -> Bool:
    """Return whether neither the host nor the reflector machine has a position."""
    return restrictive(whole) & ~of_source(whole, "valid")


def anchoring(whole: ReflectorDevice, law: str) -> Anchoring:
    """Return the words for what groups do to the reflector machine."""
    return Anchoring(whole.composition, whole.groups, whole.line, whole.source, whole.motion.own.ghosts.truth, law)


def accepted(whole: ReflectorDevice) -> Bool:
    """Return whether the balise machine reports a position, and the telegram of this cycle passed every check."""
    return anchoring(whole, LAW).accepted


def disproved(whole: ReflectorDevice) -> Bool:
    """Return whether the balise machine reports nothing because groups contradict its position."""
    return anchoring(whole, LAW).disproved


def of_source(whole: ReflectorDevice, output: str) -> Bool:
    return flag(whole, whole.source.machine, output)


def measured(whole: ReflectorDevice) -> Bool:
    """Return whether the reflector machine measures a reflector that it recognised."""
    return of_source(whole, "precise") & of_source(whole, "recognised")


def runs_on(whole: ReflectorDevice) -> Bool:
    """Return whether a distance is measured, and the vehicle is not measured behind the farthest place that it reached."""
    heading, groups = whole.groups.own.heading, whole.composition.of(whole.groups.machine)
    ahead = ~groups.bool(heading.backwards) & groups.num(heading.rolled).eq(0)
    return ahead & groups.num(whole.groups.machine.output("odometer")).eq(ADMITTED)


def astray(whole: ReflectorDevice) -> Bool:
    """Return whether the course at a switch is not the permitted one."""
    return flag(whole, whole.course.machine, "contradicts")


def carrying(whole: ReflectorDevice) -> Bool:
    """Return whether at least one route is possible."""
    into = whole.composition.of(whole.route.machine)
    return any_of(into.bool(one.possible) for one in whole.route.own.routes)


def lost_route(whole: ReflectorDevice) -> Bool:
    """Return whether the route machine has no route left, nor one begun."""
    machine = whole.route.machine
    *_, lost = machine.modes
    return whole.composition.of(machine).bool(machine.mode.eq(lost))


def other_route(whole: ReflectorDevice) -> Bool:
    """Return whether the route is not that of the movement authority."""
    return flag(whole, whole.route.machine, "refutes_authority")


def judged_by(whole: ReflectorDevice, machine: Machine) -> Bool:
    """Return whether the course is judged by the ends of a machine's interval, as far as they are on the line, and by those of the line without one."""
    own, into, limit = (
        whole.course.own,
        whole.composition.of(whole.course.machine),
        whole.config.motion.position_limit_mm,
    )
    position, below, above = interval_of(whole, machine)
    low, high, rear, front = into.num(own.low), into.num(own.high), position - below, position + above
    told = (low.eq(rear) | (low.eq(-limit) & (rear < -limit))) & (high.eq(front) | (high.eq(limit) & (front > limit)))
    return ite(flag(whole, machine, "valid"), told, low.eq(-limit) & high.eq(limit))


def interval_of(whole: ReflectorDevice, machine: Machine) -> list[Num]:
    """Return position, margin below and margin above that a machine states."""
    into = whole.composition.of(machine)
    return [into.num(machine.output(name)) for name in INTERVAL]


def flag(whole: ReflectorDevice, machine: Machine, output: str) -> Bool:
    return whole.composition.of(machine).bool(machine.flag(output))
