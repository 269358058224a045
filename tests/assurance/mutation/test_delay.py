"""A wire that is late by a cycle: what a machine reads then, step by step."""

from __future__ import annotations

from safeloc.assurance.mutation.delay import with_delay
from safeloc.language.composition import compose, plans_changed
from safeloc.language.expr import Expr, NumVar, Optional, Var, boolean, number
from safeloc.language.interpret import Program, start
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.units import MM
from tests.assurance.mutation.door import SILENT, SLOW, door, watch

GIVEN_MM, GIVEN, READ_MM, READ = (
    number("given_mm", MM, 5, 9),
    boolean("given"),
    number("read_mm", MM, 5, 9),
    boolean("read"),
)


def repeater(name: str, value: NumVar, there: Var) -> Machine:
    """Keeps what it reads; 0 if there is nothing."""
    (on,) = modes("ON")
    kept_mm, kept = (NumVar("kept_mm", MM, 5, 9), boolean("kept"))
    keeps = Transition("keeps", on, on, set={kept_mm: value, kept: there})
    return Machine(
        name, (on,), [Optional(value, there)], {kept_mm: 5, kept: False}, {"mm": kept_mm, "there": kept}, [keeps]
    )


def late(machines: list[Machine], wires: dict[Var, Expr], to: list[Var]) -> TransitionSystem:
    """The composition with these late wires."""
    with plans_changed(lambda plan: with_delay(plan, to)):
        return compose("whole", machines, wires).system


def outputs(system: TransitionSystem, name: str, steps: list[dict[str, Value]]) -> list[Value]:
    """The values of an output, in the first state and after each step."""
    state, moving = start(system, {}), Program(list(system.next.values()))
    told, look = list[Value](), Program([system.outputs[name]])
    for step in [*steps, {}]:
        told += look(state)
        if step:
            state = dict(
                zip(system.next, moving({**state, **{system.variable(var): step[var] for var in step}}), strict=True)
            )
    return told


def test_a_flag_comes_a_cycle_later() -> None:
    """The door opens in the step after the one in which the watch sees a slow vehicle; in the first step it reads nothing."""
    first, second = watch(), door()
    wires: dict[Var, Expr] = {SLOW: first.flag("slow"), SILENT: first.flag("silent")}
    slow: dict[str, Value] = {"watch.speed_mm_s": 10, "watch.loud": False}
    assert [0, 1, 1] == outputs(compose("whole", [first, second], wires).system, "door.opened", [slow, slow])
    assert [0, 0, 1] == outputs(late([first, second], wires, [SLOW]), "door.opened", [slow, slow])


def test_an_optional_input_comes_later_as_a_whole() -> None:
    """Value and flag stay together; before the first one it is absent."""
    first, second = repeater("first", GIVEN_MM, GIVEN), repeater("second", READ_MM, READ)
    wires: dict[Var, Expr] = {READ_MM: first.outputs["mm"], READ: first.outputs["there"]}
    steps: list[dict[str, Value]] = [
        {"first.given_mm": mm, "first.given": there} for mm, there in ((9, True), (5, False), (7, True))
    ]
    system = late([first, second], wires, [READ_MM, READ])
    assert [5, 5, 9, 5] == outputs(system, "second.mm", steps)
    assert [False, False, True, False] == outputs(system, "second.there", steps)
