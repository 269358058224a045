"""Other vehicles on the line of a vehicle that measures reflectors: the world has them, and none of them gives a position (RFL-15).

For the radar, another vehicle is a thing that sends echoes and is no reflector, and that hides a reflector. The world admits both in any
cycle, at any place and as often as it likes, so what is proved of the machine holds for any number of vehicles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.language.expr import Bool, all_of, any_of, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always
from safeloc.models.reflector import ReflectorMachine, build, echo
from safeloc.models.reflector.variables import parts
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector import properties
from safeloc.properties.reflector.figures import strong, was
from tests.models.edited_terms import edited, keeps
from tests.models.test_reflector_edits import CONFIG, showing

CLAIM = "an echo of another vehicle is no measurement"
NEVER = "never"
OTHERS = "other things show no reflector's signature"


def of_reflectors(model: ReflectorMachine) -> list[Bool]:
    """Of each strong echo: a reflector sent it."""
    own = model.own
    return [strong(own, slot) & real for slot, real in zip(own.slots, own.ghosts.reflector, strict=True)]


def of_others(model: ReflectorMachine) -> list[Bool]:
    """Of each strong echo: no reflector sent it."""
    own = model.own
    return [strong(own, slot) & ~real for slot, real in zip(own.slots, own.ghosts.reflector, strict=True)]


def claim(model: ReflectorMachine) -> Property:
    """In a cycle in which other vehicles hide every reflector, whatever they send, nothing is measured: one of the claims that ship."""
    [found] = [one for one in properties(model) if one.name == CLAIM]
    return found


def hidden_in_view(model: ReflectorMachine) -> Bool:
    """The reflector in view is hidden, and another vehicle sends the only strong echo."""
    return was(model, "VIEW") & any_of(of_others(model)) & ~any_of(of_reflectors(model))


def beside_in_view(model: ReflectorMachine) -> Bool:
    """Another vehicle, nearer than the reflector, sends a strong echo beside the reflector's, which is used."""
    near, far = model.own.slots
    other, right = of_others(model)[0], of_reflectors(model)[1]
    return all_of([was(model, "VIEW"), other, right, near.range.value < far.range.value, model.own.recognised_now])


def made(slots: int = 1, *, without: str = "") -> tuple[ReflectorMachine, Machine]:
    """The machine as it is built now, its world without one law."""
    model = build(parts(CONFIG.model_copy(update={"echo_slots": slots})))
    laws = {name: law for name, law in model.machine.world.laws.items() if name != without}
    return model, replace(model.machine, world=replace(model.machine.world, clauses=laws))


@pytest.mark.thorough
@pytest.mark.parametrize(("slots", "case"), [(1, hidden_in_view), (2, beside_in_view)], ids=["hidden", "beside"])
def test_the_world_has_other_vehicles(slots: int, case: Callable[[ReflectorMachine], Bool]) -> None:
    """A lawful step, from a state that ranges and lemmas admit, in which another vehicle hides the reflector, or sends an echo beside it."""
    model, machine = made(slots)
    assert not keeps((machine, [always(NEVER, ~case(model))]), NEVER)


@pytest.mark.thorough
def test_no_echo_of_another_vehicle_is_a_measurement() -> None:
    """It is proved, and follows from no law but that on what others send."""
    model, machine = made()
    assert keeps((machine, [claim(model)]), CLAIM)
    model, free = made(without=OTHERS)
    assert not keeps((free, [claim(model)]), CLAIM)


@pytest.mark.thorough
def test_a_machine_that_takes_a_vehicle_for_a_reflector_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """An echo that shows no reflector's model is taken for the one that is searched."""
    edited(monkeypatch, echo, "judge", showing(lambda shown, searched: ite(shown.eq(NO_MODEL), searched, shown)))
    model, machine = made()
    assert not keeps((machine, [claim(model)]), CLAIM)
