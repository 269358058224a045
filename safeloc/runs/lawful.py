"""Inputs that keep a machine's assumption: what a search changes is repaired, at the ends of what is allowed."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from safeloc.backends.compiled import Compiled, compile_system
from safeloc.errors import InputError
from safeloc.expr import Bool, BoolVar, Expr, Lit, NumVar, Var
from safeloc.interpret import evaluate
from safeloc.machine import Any_
from safeloc.nodes import And, Compare, Not, Or, Value
from safeloc.system import TransitionSystem, canonical, environment
from safeloc.terms import in_order, variables

REPAIRS = 12
Pick = Callable[[NumVar, int, int], int]


class Repair:
    """Changes what the environment chooses until the assumption holds; measurements only where that is not enough."""

    def __init__(self, system: TransitionSystem) -> None:
        self._system = system
        whole = environment(system)
        self._parts = list(_conjuncts(whole))
        inputs = set(system.inputs)
        self._check = _checker(system, self._parts)
        self._none = (False,) * len(self._parts)
        self._free = [[v for v in variables([part]) if v in inputs and isinstance(v, NumVar)] for part in self._parts]

    def mend(
        self, state: Mapping[Var, Value], inputs: Mapping[Var, Value], draw: random.Random, pick: Pick | None = None
    ) -> dict[Var, Value] | None:
        """Inputs that keep the assumption, or None if none were found. `pick` chooses within what is allowed."""
        pick = pick or (lambda _var, low, high: draw.choice((low, high, draw.randint(low, high))))
        values = {**state, **inputs}
        for _ in range(REPAIRS):
            truths = self._check.step(self._none, tuple(values[var] for var in self._check.system.inputs))[0]
            broken = [index for index, truth in enumerate(truths) if not truth]
            if not broken:
                return {var: values[var] for var in self._system.inputs}
            for index in broken:
                self._mend_part(index, values, draw, pick)
        return None

    def _mend_part(self, index: int, values: dict[Var, Value], draw: random.Random, pick: Pick) -> None:
        free = self._free[index]
        if not free:
            return
        ghosts = [var for var in free if var in self._system.ghosts]
        pool = ghosts if ghosts and draw.random() < 0.9 else free
        for var in draw.sample(pool, len(pool)):
            found = _allowed(self._parts[index], var, values)
            if found is not None:
                values[var] = pick(var, *found)
                return


def first_state(system: TransitionSystem, draw: random.Random, *, adventurous: float = 0.0) -> dict[str, Value]:
    """Values for what is open at the start, such that `initially` holds; InputError if none were found.

    adventurous: the share of variables that begin at an end of their range instead of near zero
    """
    free = [var for var in system.state if isinstance(system.initial[var], Any_)]
    values: dict[Var, Value] = {}
    for var in system.state:
        declared = system.initial[var]
        if isinstance(declared, Any_):
            values[var] = _open_value(var, draw, adventurous)
        else:
            values[var] = declared.value if isinstance(declared, Lit) else declared
    parts = _conjuncts(system.init)
    for _ in range(REPAIRS):
        broken = [part for part in parts if not evaluate([part], values)[0]]
        if not broken:
            return {var.name: values[var] for var in free}
        for part in broken:
            _mend_first(part, free, values, draw)
    raise InputError(f"{system.name}: no first state found that satisfies `initially`; give one explicitly.")


def _open_value(var: Var, draw: random.Random, adventurous: float) -> Value:
    if isinstance(var, BoolVar):
        return draw.random() < 0.5
    return draw.choice((var.low, var.high)) if draw.random() < adventurous else canonical(var)


def _mend_first(part: Bool, free: Sequence[Var], values: dict[Var, Value], draw: random.Random) -> None:
    reads = set(variables([part]))
    for var in draw.sample(list(free), len(free)):
        found = _allowed(part, var, values) if var in reads and isinstance(var, NumVar) else None
        if found is not None:
            values[var] = draw.choice(found)
            return
        if var in reads and isinstance(var, BoolVar):
            values[var] = not values[var]


def _checker(system: TransitionSystem, parts: Sequence[Bool]) -> Compiled:
    """The parts of the assumption as compiled code: state before and inputs in, truth values out."""
    truths: dict[Var, Expr] = {BoolVar(f"part {number}"): part for number, part in enumerate(parts)}
    reads = (*system.state, *system.inputs)
    return compile_system(
        replace(system, state=tuple(truths), next=truths, inputs=reads, fired={}, outputs={}, optionals=())
    )


def _conjuncts(term: Bool) -> list[Bool]:
    return [inner for part in term.parts for inner in _conjuncts(part)] if isinstance(term, And) else [term]


def _allowed(part: Bool, var: NumVar, values: Mapping[Var, Value]) -> tuple[int, int] | None:
    """An interval of values of `var` that makes the part true, found at the boundaries of its comparisons."""
    points = sorted(_boundaries(part, var, values) | {var.low, var.high})
    good = [point for point in points if evaluate([part], {**values, var: point})[0]]
    return (
        (good[0], good[-1]) if good and all(_between(part, var, values, good)) else (good[0], good[0]) if good else None
    )


def _between(part: Bool, var: NumVar, values: Mapping[Var, Value], good: list[int]) -> list[bool]:
    middle = (good[0] + good[-1]) // 2
    return [bool(evaluate([part], {**values, var: middle})[0])]


def _boundaries(part: Bool, var: NumVar, values: Mapping[Var, Value]) -> set[int]:
    """Where the comparisons that read `var` change, taking each as linear in it between two probes."""
    found: set[int] = set()
    here = int(values[var])
    for node in in_order([part]):
        if isinstance(node, Compare) and var in set(variables([node])):
            found |= _roots(node, var, values, here)
    return {point + shift for point in found for shift in (-1, 0, 1) if var.low <= point + shift <= var.high}


def _roots(node: Compare, var: NumVar, values: Mapping[Var, Value], here: int) -> set[int]:
    probes = (here, here + 1 if here < var.high else here - 1)
    gaps = []
    for probe in probes:
        left, right = evaluate([node.left, node.right], {**values, var: probe})
        gaps.append(right - left)
    slope = (gaps[1] - gaps[0]) // (probes[1] - probes[0])
    return {here - gaps[0] // slope} if slope else set()


def slack(term: Bool, values: Mapping[Var, Value]) -> float:
    """How far a term is from being false: the least numeric distance, negative once it is false, infinite if logical."""
    match term:
        case Compare(op, a, b):
            left, right = evaluate([a, b], values)
            return float(abs(left - right) and -abs(left - right)) if op == "==" else float(right - left)
        case And(parts):
            return min(slack(part, values) for part in parts)
        case Or(parts):
            return max(slack(part, values) for part in parts)
        case Not(Compare("<", a, b)):
            left, right = evaluate([a, b], values)
            return float(left - right)
        case Not(Compare("<=", a, b)):
            left, right = evaluate([a, b], values)
            return float(left - right - 1)
        case _:
            return float("inf") if evaluate([term], values)[0] else float("-inf")
