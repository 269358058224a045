"""Dead ends by enumeration of all states and inputs in the interpreter, and small random machines to enumerate."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import product

from safeloc.errors import InputError
from safeloc.language.expr import TRUE, Bool, BoolVar, Num, Var, boolean, ite, maximum, minimum, number, optional
from safeloc.language.interpret import Program, start, step
from safeloc.language.machine import ANY, Any_, Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, environment, lower
from safeloc.language.units import COUNT
from safeloc.language.world import World

State = tuple[Value, ...]
(S,) = modes("S")
HIGHEST = 4


def dead_end(system: TransitionSystem) -> int | None:
    """Length of the shortest run into a dead end (-1: there is no first state); None if no reachable state is one."""
    allowed, inputs = Program([environment(system)]), list(_every(system.inputs))
    level, depth = set(_first(system)), 0
    seen = set(level)
    if not level:
        return -1
    while level:
        after: set[State] = set()
        for row in level:
            state = dict(zip(system.state, row, strict=True))
            lawful = [one for one in inputs if allowed({**state, **one})[0]]
            if not lawful:
                return depth
            moved = (step(system, state, one)[0] for one in lawful)
            after |= {tuple(one[var] for var in system.state) for one in moved}
        level, depth = after - seen, depth + 1
        seen |= after
    return None


def _first(system: TransitionSystem) -> Iterator[State]:
    open_ = tuple(var for var in system.state if isinstance(system.initial[var], Any_))
    for values in _every(open_):
        try:
            chosen = start(system, {var.name: value for var, value in values.items()})
        except InputError:
            continue
        yield tuple(chosen[var] for var in system.state)


def _every(variables: tuple[Var, ...]) -> Iterator[dict[Var, Value]]:
    ranges = [(False, True) if isinstance(var, BoolVar) else range(var.low, var.high + 1) for var in variables]
    return (dict(zip(variables, values, strict=True)) for values in product(*ranges))


def random_system(seed: int) -> TransitionSystem:
    """A machine of two counters and a flag, with a number, a flag and an optional input; its assumption reads all of
    them.
    """
    draw = random.Random(seed)
    x, y, on = number("x", COUNT, 0, HIGHEST), number("y", COUNT, 0, HIGHEST), boolean("on")
    k, go, told = number("k", COUNT, draw.choice((-1, 0, 1)), 2), boolean("go"), optional("o", COUNT, 0, 2)
    seen: list[Num] = [x, y, k, told.value_or(0), *(0 * x + draw.randint(0, HIGHEST) for _ in range(2))]

    def term() -> Num:
        one, other = draw.choice(seen), draw.choice(seen)
        return draw.choice((one, one + other, one - other, maximum(one, other), ite(flag(), one, other)))

    def flag() -> Bool:
        one, other = draw.choice(seen), draw.choice(seen)
        return draw.choice((go, on, told.present, one < other, one <= other, one.eq(other)))

    def clause() -> Bool:
        one, other = term(), term()
        part = draw.choice((one <= other, one < other, one.eq(other), ~one.eq(other), flag(), ~flag()))
        return draw.choice((part, part | flag(), flag().implies(part), part.iff(flag())))

    moves = {x: _held(term()), y: _held(term()), on: flag()}
    rows = [Transition("go", S, S, flag(), moves), Transition("else", S, S, TRUE, {x: _held(x + 1)}, rank=1)]
    begins = draw.choice((0, ANY))
    asked = clause() & clause() & (clause() | clause())
    inputs = [k, go, told]
    return lower(
        Machine(
            "random",
            (S,),
            inputs,
            {x: begins, y: 0, on: False},
            {},
            rows,
            world=World(clauses={"assumption": asked}, reads_machine="the test asks it"),
        )
    )


def _held(term: Num) -> Num:
    return maximum(minimum(term, HIGHEST), 0)
