"""A machine of one variable, in variants with one fault each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import cvc5

from safeloc import yices
from safeloc.language.expr import TRUE, Bool, boolean, minimum, number
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.spec import Goal, always, observe
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.proof.provers.facts import Fact

LOW, HIGH = modes("LOW", "HIGH")
MODE = current_mode((LOW, HIGH))
TICK = boolean("tick")
LEVEL = number("level", COUNT, 0, 10)
ASKED_FIRST = f"cvc5 {cvc5.__version__}" if yices.version() is None else f"yices {yices.version()}"
"""The program that is asked first for a second opinion: it confirms all that is small."""


def counter(
    *,
    stride: int = 1,
    lemmas: Mapping[str, Bool] | None = None,
    assumption: Bool = TRUE,
    rise: tuple[int, ...] = (),
) -> Machine:
    """Counts ticks up to 10 and starts again; HIGH from 5 on.

    A `stride` of 2 leaves the range; a `rise` below 4 makes two guards overlap.
    """
    return Machine(
        name="counter",
        modes=(LOW, HIGH),
        inputs=[TICK],
        state={LEVEL: 0},
        outputs={"level": LEVEL},
        transitions=[
            Transition("full", HIGH, LOW, TICK & (LEVEL >= 10), {LEVEL: 0}),
            Transition("rise", LOW, HIGH, TICK & LEVEL.one_of(4, *rise), {LEVEL: LEVEL + 1}, rank=1),
            Transition("count low", LOW, LOW, TICK & (LEVEL < 4), {LEVEL: LEVEL + 1}, rank=1),
            Transition("count high", HIGH, HIGH, TICK, {LEVEL: LEVEL + stride}, rank=1),
        ],
        world=World(clauses={"assumption": assumption}, reads_machine="the test asks it"),
        lemmas=lemmas or {},
    )


def system(machine: Machine) -> TransitionSystem:
    """The machine, lowered."""
    return lower(machine)


def goal(machine: Machine, term: Bool, *, unconditional: bool = False) -> Goal:
    """The goal that `term` always holds."""
    return observe(lower(machine), always("claim", term, unconditional=unconditional))


ONLY = modes("ONLY")[0]
LEFT, RIGHT = number("left", COUNT, 0, 10), number("right", COUNT, 0, 10)
SAME = LEFT.eq(RIGHT)


def pair(lemmas: Mapping[str, Bool] | None = None, *, behind: bool = False) -> Machine:
    """Two counters in step with each other; `behind` is the fault that the second one starts a step late."""
    return Machine(
        name="pair",
        modes=(ONLY,),
        inputs=[TICK],
        state={LEFT: 0, RIGHT: 0},
        outputs={},
        transitions=[
            Transition("wrap", ONLY, ONLY, TICK & (LEFT >= 10), {LEFT: 0, RIGHT: 0}),
            Transition("late", ONLY, ONLY, TICK & LEFT.eq(0), {LEFT: 1, RIGHT: 0 if behind else 1}, rank=1),
            Transition("count", ONLY, ONLY, TICK, {LEFT: LEFT + 1, RIGHT: minimum(RIGHT + 1, 10)}, rank=2),
        ],
        lemmas=lemmas or {},
    )


FULL_TOGETHER = RIGHT.eq(10).implies(LEFT.eq(10))


def told(facts: Iterable[Fact]) -> set[str]:
    """Facts by their names for people."""
    return {str(fact) for fact in facts}
