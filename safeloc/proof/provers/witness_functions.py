"""Witness functions, which give inputs as terms over state: they generalize lawful inputs of one state to many states.

First, the atoms that make the conditions on a step true in that one state are collected: linear comparisons and truth values
of inputs. Then each input is solved for in turn: by an equation if there is one, else as near to rest as its bounds allow.
No proof relies on this: a solver decides whether the inputs are lawful where they are used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from safeloc.language.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Var
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import (
    Add,
    And,
    Choose,
    ChooseBool,
    Compare,
    FloorDiv,
    Max,
    Min,
    Mul,
    Not,
    Or,
    Sub,
    Truth,
    Value,
)
from safeloc.language.system import canonical
from safeloc.language.terms import children, in_order
from safeloc.language.units import ONE
from safeloc.proof.provers.linear import Linear, constant_of, solved

Witness = Mapping[Var, Expr]


def at_rest(inputs: Iterable[Var]) -> dict[Var, Value]:
    """Return inputs at rest: all absent or false, and numbers as near zero as their ranges allow."""
    return {var: canonical(var) if isinstance(var, NumVar) else False for var in inputs}


def constants(values: Mapping[Var, Value]) -> Witness:
    """Return the witness function that gives the same inputs in every state."""
    return {var: constant_of(var, value) for var, value in values.items()}


@dataclass(eq=False)
class Generalisation:
    """The conditions on a step of a system, to make witness functions from single states and their inputs."""

    condition: Bool
    inputs: Sequence[Var]
    _order: Sequence[Expr] = field(init=False)
    _reads: set[Expr] = field(init=False)

    def __post_init__(self) -> None:
        self._order = in_order([self.condition])
        free = set(self.inputs)
        self._reads = set()
        for node in self._order:
            if node in free or any(child in self._reads for child in children(node)):
                self._reads.add(node)

    def witness(
        self, state: Mapping[Var, Value], inputs: Mapping[Var, Value], *, eager: bool, resting: bool = False
    ) -> Witness:
        """Return a witness function that gives lawful inputs in this state.

        eager    it also satisfies conditions that are not active in this state
        resting  numbers that are at rest in these inputs are so in every state: it reads less, and is simpler
        """
        values = dict(zip(self._order, evaluate(self._order, {**state, **inputs}), strict=True))
        followed = _Followed(values, self._reads, frozenset(self.inputs), eager)
        followed.follow(self.condition, True)
        flags: dict[Var, Expr] = {var: Truth(value) for var, value in followed.flags.items()}
        numbers = [var for var in self.inputs if isinstance(var, NumVar)]
        rest = constants(at_rest(self.inputs))
        still = [_is_zero(var, canonical(var)) for var in numbers if resting and inputs[var] == canonical(var)]
        found = solved([*numbers, *followed.parts], [*still, *followed.zeros], followed.bounds)
        return {var: flags.get(var, found.get(var, rest[var])) for var in self.inputs}


def _is_zero(var: NumVar, value: int) -> Linear:
    """Return what is 0 where the input has this value."""
    return Linear({var: 1}, Lit(-value, ONE))


class _Followed:
    """The atoms that make a condition true under some values: truth values, equations (= 0) and bounds (<= 0) of inputs."""

    def __init__(self, values: Mapping[Expr, Value], reads: set[Expr], inputs: frozenset[Var], eager: bool) -> None:
        self._values, self._reads, self._inputs, self._eager = values, reads, inputs, eager
        self.flags: dict[BoolVar, bool] = {}
        self.zeros: list[Linear] = []
        self.bounds: list[Linear] = []
        self.parts: list[NumVar] = []
        self._seen: set[tuple[Bool, bool]] = set()
        self._linear: dict[Num, Linear] = {}

    def follow(self, term: Bool, wanted: bool) -> None:
        """Collect the atoms that give the term the value `wanted`, which it must have."""
        stack = [(term, wanted)]
        while stack:
            now, wish = stack.pop()
            if now in self._reads and (now, wish) not in self._seen:
                self._seen.add((now, wish))
                stack += self._step(now, wish)

    def _step(self, term: Bool, wanted: bool) -> list[tuple[Bool, bool]]:
        match term:
            case BoolVar():
                self.flags[term] = wanted
            case Not(inner):
                return [(inner, not wanted)]
            case And(parts):
                return [(part, True) for part in parts] if wanted else [self._chosen(parts, False)]
            case Or(parts):
                return [self._chosen(parts, True)] if wanted else [(part, False) for part in parts]
            case ChooseBool(condition, then, other):
                holds = bool(self._values[condition])
                return [(condition, holds), (then if holds else other, wanted)]
            case Compare(op, left, right):
                self._compare(op, left, right, wanted)
            case _:
                raise AssertionError(term)
        return []

    def _chosen(self, parts: Sequence[Bool], wanted: bool) -> tuple[Bool, bool]:
        """Choose a part with the wanted value: the one that binds the inputs least, or if eager one that binds them."""
        fitting = [part for part in parts if bool(self._values[part]) == wanted]
        return min(fitting, key=self._cost), wanted

    def _cost(self, part: Bool) -> tuple[int, int]:
        inner = part.inner if isinstance(part, Not) else part
        if inner in self._inputs:
            kind = 0 if not self._values[inner] else 3
        elif part in self._reads:
            kind = 1 if self._eager else 4
        else:
            kind = 2
        return kind, 0

    def _compare(self, op: Literal["<", "<=", "=="], left: Num, right: Num, wanted: bool) -> None:
        gap = self.linear(left).minus(self.linear(right))
        if op == "==":
            if wanted:
                self.zeros.append(gap)
            else:
                below = self._values[left] < self._values[right]
                self.bounds.append((gap if below else gap.times(-1)).plus(1))
        elif wanted:
            self.bounds.append(gap.plus(1 if op == "<" else 0))
        else:
            self.bounds.append(gap.times(-1).plus(0 if op == "<" else 1))

    def linear(self, term: Num) -> Linear:
        """Return the term as a sum over inputs; a term that is none is replaced by its active branch or by its value."""
        for node in in_order([term], self._linear):
            if isinstance(node, Num) and node not in self._linear:
                self._linear[node] = self._sum(node)
        return self._linear[term]

    def _sum(self, node: Num) -> Linear:
        if node not in self._reads:
            return Linear({}, node)
        match node:
            case NumVar():
                return Linear({node: 1}, Lit(0, ONE))
            case Add(a, b):
                return self._linear[a].minus(self._linear[b].times(-1))
            case Sub(a, b):
                return self._linear[a].minus(self._linear[b])
            case Mul(Lit(factor, _), a) | Mul(a, Lit(factor, _)):
                return self._linear[a].times(factor)
            case FloorDiv(a, divisor, _):
                return self._divided(self._linear[a], divisor)
            case Min(a, b) | Max(a, b):
                return self._outer(node, a, b)
            case Choose(condition, then, other, _):
                return self._branch(condition, then, other)
            case _:
                return Linear({}, Lit(int(self._values[node]), ONE))

    def _divided(self, dividend: Linear, divisor: int) -> Linear:
        """Introduce a number q for the quotient: divisor * q <= whole < divisor * (q + 1)."""
        part = NumVar(f"part {len(self.parts)}", ONE, 0, 0)
        self.parts.append(part)
        quotient = Linear({part: divisor}, Lit(0, ONE))
        self.bounds += [quotient.minus(dividend), dividend.minus(quotient).plus(1 - divisor)]
        return Linear({part: 1}, Lit(0, ONE))

    def _outer(self, node: Min | Max, a: Num, b: Num) -> Linear:
        one, two = self._linear[a], self._linear[b]
        if one.of == two.of:
            return Linear(one.of, type(node)(one.rest, two.rest, ONE))
        first = self._values[node] == self._values[a]
        taken, left = (one, two) if first else (two, one)
        gap = taken.minus(left)
        self.bounds.append(gap if isinstance(node, Min) else gap.times(-1))
        return taken

    def _branch(self, condition: Bool, then: Num, other: Num) -> Linear:
        one, two = self._linear[then], self._linear[other]
        if condition not in self._reads and one.of == two.of:
            return Linear(one.of, Choose(condition, one.rest, two.rest, ONE))
        holds = bool(self._values[condition])
        self.follow(condition, holds)
        return one if holds else two
