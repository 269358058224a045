"""Variables declared once: the roles they get, their order, and what is refused."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

from safeloc.errors import ModelError
from safeloc.language.declared import Declared
from safeloc.language.digest import full_digest
from safeloc.language.expr import FALSE, TRUE, boolean, number, optional
from safeloc.language.machine import ANY, Initial, Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.language.world import World


def whole(declared: Declared) -> Machine:
    """A machine of one transition that sets nothing, over what is declared; ghosts rest."""
    (on,) = table = modes("ON")
    moves = {ghost: ghost for ghost in declared.ghosts}
    world = World(ghosts=declared.ghosts, choices=declared.choices, moves=moves)
    return Machine("m", table, declared.inputs, declared.states, {}, [Transition("stay on", on, on)], world)


def test_each_role_keeps_the_order_of_its_declarations() -> None:
    """Variables of one role keep the order of their declarations, which is that of the fields in exported code."""
    declared = Declared()
    b, truth, a = declared.sensor(boolean("b")), declared.ghost(boolean("truth"), first=ANY), number("a_mm", MM, 0, 9)
    place, push = declared.state(a, first=3), declared.choice(boolean("push"))
    fix, held = declared.sensor(optional("fix_mm", MM, 0, 9)), declared.state(boolean("held"), first=False)
    system = lower(whole(declared))
    assert [var.name for var in system.inputs] == ["b", "fix_mm.present", "fix_mm", "push"]
    assert [var.name for var in system.state] == ["mode", "a_mm", "held", "truth"]
    assert [system.initial[var] for var in (place, held, truth)] == [3, False, ANY]
    assert place is a
    assert (declared.inputs, declared.choices) == ([b, fix], [push])
    assert system.ghosts == {truth, push}


def test_machine_and_world_take_what_is_declared() -> None:
    """`declared.world` and `declared.machine` make the same system as the constructors with the four lists by hand."""

    def declared() -> Declared:
        made = Declared()
        made.sensor(optional("fix_mm", MM, 0, 9))
        made.state(number("place_mm", MM, 0, 9), first=3)
        made.ghost(boolean("truth"), first=ANY)
        made.choice(boolean("push"))
        return made

    by_hand, collected = declared(), declared()
    (on,) = table = modes("ON")
    clauses, moves = {"a push": TRUE}, {ghost: ghost for ghost in collected.ghosts}
    world = collected.world(moves, clauses, "no reason")
    made = collected.machine(
        name="m",
        modes=table,
        outputs={},
        transitions=[Transition("stay on", on, on)],
        world=world,
        initially=FALSE,
        lemmas={"a lemma": TRUE},
        definitions={"a name": TRUE},
        doc="A machine.",
    )
    assert (world.clauses, world.reads_machine) == (clauses, "no reason")
    assert (made.initially, made.lemmas, made.definitions, made.doc) == (
        FALSE,
        {"a lemma": TRUE},
        {"a name": TRUE},
        "A machine.",
    )
    assert made.src.startswith(f"{__file__}:")
    plain = collected.machine(name="m", modes=modes("ON"), outputs={}, transitions=[], world=collected.world(moves, {}))
    assert (plain.initially, plain.lemmas, plain.definitions, plain.doc) == (TRUE, {}, {}, "")
    bare = collected.machine(
        name="m", modes=table, outputs={}, transitions=made.transitions, world=collected.world(moves, {})
    )
    assert full_digest(lower(bare)) == full_digest(lower(whole(by_hand)))


A_MM, FIX = number("a_mm", MM, 0, 9), optional("a_mm", MM, 0, 9)
TWICE: dict[str, Callable[[Declared], object]] = {
    "the same variable in another role": lambda declared: declared.sensor(A_MM),
    "the same variable in its role": lambda declared: declared.state(A_MM, first=0),
    "another variable of its name": lambda declared: declared.choice(number("a_mm", MM, 0, 3)),
    "an optional of its name": lambda declared: declared.sensor(FIX),
    "a ghost of its name": lambda declared: declared.ghost(boolean("a_mm"), first=False),
}


@pytest.mark.parametrize("case", TWICE)
def test_a_second_declaration_is_refused(case: str) -> None:
    """The message says where the first one stands; what was declared stays as it was."""
    declared = Declared()
    declared.state(A_MM, first=9)
    place = rf"{re.escape(__file__)}:\d+"
    told = rf"^{place}: 'a_mm' is already declared at {place}; declare each variable once, under a name of its own\.$"
    with pytest.raises(ModelError, match=told):
        TWICE[case](declared)
    assert (declared.states, declared.inputs, declared.ghosts, declared.choices) == ({A_MM: 9}, [], {}, [])


@pytest.mark.parametrize(
    ("first", "told"),
    [
        (10, "initial value of 'a_mm' .*: 10 is outside 0..9"),
        (True, "initial value of 'a_mm' .*: True is not a number"),
        (A_MM, "initial value of 'a_mm' .*: a_mm is a term; give a value, or ANY with a condition in `initially`"),
    ],
)
@pytest.mark.parametrize("role", ["state", "ghost"])
def test_a_first_value_is_in_range(role: str, first: Initial, told: str) -> None:
    """The machine refuses another one, with the place of the variable."""
    declared = Declared()
    getattr(declared, role)(A_MM, first=first)
    with pytest.raises(ModelError, match=told):
        whole(declared)


@pytest.mark.parametrize("role", ["state", "ghost"])
def test_a_first_value_is_given(role: str) -> None:
    """None is taken for granted: 0 is a place."""
    declare: Any = getattr(Declared(), role)
    with pytest.raises(TypeError, match="missing 1 required keyword-only argument: 'first'"):
        declare(A_MM)


def test_what_a_machine_has_does_not_change_afterwards() -> None:
    """A declaration that comes too late is none of the machine's."""
    declared = Declared()
    declared.state(A_MM, first=0)
    machine = whole(declared)
    declared.state(boolean("late"), first=False)
    assert list(machine.state) == [A_MM]
