"""The direction of travel in the reflector device: a wrong direction ends the position, wrong wires are not proved, the recordings say what they teach."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from safeloc.language.expr import FALSE, TRUE
from safeloc.models import reflector_device
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.models.travel_direction.variables import UNKNOWN
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector_device import properties
from tests.models.anchored_wires import always_a_reference, balise_for_the_host
from tests.models.composed_devices import Runs, Wiring, Wrong, flag
from tests.models.owed_contracts import Wires

DEVICE = Wiring(reflector_device, properties)


# ------------------------------------------------------------------ wires exchanged on purpose


def _direction_unheard(whole: ReflectorDevice, right: Wires) -> Wires:
    heard = whole.source.own.contradicted
    return {heard: flag(right[heard]) & ~whole.direction.machine.flag("contradicts")}


def _only_the_direction(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.source.own.contradicted: whole.direction.machine.flag("contradicts")}


def _any_direction_contradicts(whole: ReflectorDevice, right: Wires) -> Wires:
    heard = whole.source.own.contradicted
    return {heard: flag(right[heard]) | whole.direction.machine.output("direction").ne(UNKNOWN)}


def _raw_telegram(whole: ReflectorDevice, _: Wires) -> Wires:
    """Whatever the antenna read is a balise between its neighbours."""
    return {whole.direction.own.balise_read: whole.groups.own.read.group.present}


def _never_turned(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.direction.own.backwards: FALSE}


def _turned_late(whole: ReflectorDevice, _: Wires) -> Wires:
    """The vehicle turned once the balise machine takes it for one that runs backwards: after D_NVROLL."""
    missing = whole.groups.machine.output("odometer").ne(ADMITTED)
    return {whole.direction.own.backwards: whole.groups.own.heading.backwards | missing}


def _never_unmeasured(whole: ReflectorDevice, _: Wires) -> Wires:
    """A cycle without a distance is one in which the vehicle did not turn."""
    heading = whole.groups.own.heading
    return {whole.direction.own.backwards: heading.backwards | (heading.rolled > 0)}


def _passed_is_ahead(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.direction.own.passed_model: whole.met.ahead_model}


def _nothing_passed(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.direction.own.passed_model: NO_MODEL}


def _ahead_is_near(whole: ReflectorDevice, _: Wires) -> Wires:
    """Only a reflector within the passing range is one ahead."""
    return {whole.direction.own.ahead_model: whole.met.near_model}


def _first_ahead(whole: ReflectorDevice, _: Wires) -> Wires:
    """The first echo of the frame, the strongest one, in place of the nearest."""
    return {whole.direction.own.ahead_model: whole.source.own.slots[0].model}


def _near_forgotten(whole: ReflectorDevice, right: Wires) -> Wires:
    """A group that is read has no reflector before it."""
    return {whole.met.turned: flag(right[whole.met.turned]) | whole.groups.own.read.group.present}


def _near_never_forgotten(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.met.turned: FALSE}


def _always_turning(whole: ReflectorDevice, _: Wires) -> Wires:
    """Then no direction is ever stated, and none is wrong."""
    return {whole.direction.own.backwards: TRUE}


WRONG: Mapping[str, tuple[Wrong, str]] = {
    "a contradicted direction unheard": (_direction_unheard, "a contradicted direction withdraws the position"),
    "route and groups unheard": (_only_the_direction, "direction, route and groups contradict, and nothing else"),
    "any direction contradicts": (
        _any_direction_contradicts,
        "direction, route and groups contradict, and nothing else",
    ),
    "a raw telegram is a balise": (_raw_telegram, "the direction counts accepted groups"),
    "the vehicle never turns": (_never_turned, "with a direction the vehicle runs on"),
    "the vehicle turns late": (_turned_late, "with a direction the vehicle runs on"),
    "unmeasured cycles count": (_never_unmeasured, "with a direction the vehicle runs on"),
    "every reflector ahead is passed": (_passed_is_ahead, "no other reflector is passed"),
    "no reflector is passed": (_nothing_passed, "a reflector is passed where its distance is run"),
    "a reflector ahead is near": (_ahead_is_near, "the direction hears the nearest reflector ahead"),
    "the first echo is ahead": (_first_ahead, "the direction hears the nearest reflector ahead"),
    "what was near is forgotten at each group": (
        _near_forgotten,
        "a reflector that is near is carried on by the odometer",
    ),
    "what was near is never forgotten": (_near_never_forgotten, "without a reflector near nothing comes next"),
    "the vehicle turns always": (_always_turning, "a vehicle turns only where it is measured to"),
    "every cycle a reference": (always_a_reference, "only a reference in the permitted direction ends a loss"),
    "the balise's interval for the host": (balise_for_the_host, "a contradicted direction withdraws the position"),
}
"""Wires exchanged on purpose, and the claim that is no longer proved."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_wire_is_not_proved(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each is refused by the claim that is named, which the right wires keep."""
    assert DEVICE.loses(*WRONG[name], monkeypatch)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("claim", sorted({claim for _, claim in WRONG.values()}))
def test_the_right_wires_keep_it(claim: str) -> None:
    """So that a refusal is due to the wire."""
    assert DEVICE.keeps(claim)


# ------------------------------------------------------------------ recordings


RUNS = Runs("reflector_device")
recorded, fired = RUNS.recorded, RUNS.fired


@pytest.mark.thorough
def test_a_wrong_direction_ends_the_position_until_the_end() -> None:
    """Both runs begin the decision at the same group; the second reflector keeps the one position, and ends the other in its cycle."""
    begun = fired("line", "travel_direction", "fits along")
    assert begun == fired("wrong-way", "travel_direction", "fits against")
    assert begun[0] in fired("line", "balise", "group confirms the candidate")
    [confirmed] = fired("line", "travel_direction", "confirmed along")
    assert [confirmed] == fired("wrong-way", "travel_direction", "confirmed against")
    losses = fired("line", "delocalized", "position lost")
    assert all(at < confirmed for at in losses)
    assert [*losses, confirmed] == fired("wrong-way", "delocalized", "position lost")
    assert all(one.outputs["delocalized.restrictive"] for one in recorded("wrong-way").steps[confirmed:])
    assert not any(one.outputs["delocalized.restrictive"] for one in recorded("line").steps[confirmed:])
