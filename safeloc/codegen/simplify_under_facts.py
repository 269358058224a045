"""Simplification of terms under known facts: decided parts are folded away, and equal terms become one node.

    Known({present: FALSE})(term)    the rest of the term if the input is absent

Folded terms may lose their units: back ends compute with plain numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

from safeloc.codegen.merge_choices import is_magnitude
from safeloc.language.nodes import (
    FALSE,
    TRUE,
    Add,
    And,
    Bool,
    BoolVar,
    Choose,
    ChooseBool,
    Compare,
    Expr,
    FloorDiv,
    Lit,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Num,
    NumVar,
    Or,
    Past,
    Sub,
    Truth,
    all_of,
    any_of,
)
from safeloc.language.terms import CHILDREN, children, rebuilt
from safeloc.language.units import Enumeration

_MOST_VALUES = 16
_UNKNOWN: frozenset[int] = frozenset()
_FOLDS: dict[type[Expr], Callable[[int, int], int]] = {
    Add: lambda a, b: a + b,
    Sub: lambda a, b: a - b,
    Mul: lambda a, b: a * b,
    Min: min,
    Max: max,
}


_IN_ORDER: frozenset[type[Expr]] = frozenset((Choose, ChooseBool, And, Or, Not, Sub))
"""Operations whose operands have an order; most nodes are one of them."""


Decide = Callable[[str, Num, Num], bool | None]
"""Operator and both sides of a comparison -> whether it holds, if that is known."""


class Known:
    """Folds terms under facts, given as term -> the term that replaces it, mostly its constant value.

    decide  what is known of comparisons besides, such as from the ranges of variables
    """

    def __init__(self, facts: Mapping[Any, Expr], decide: Decide | None = None) -> None:
        self._decide = decide
        self._done: dict[Expr, Expr] = dict(facts)
        self._kept: dict[tuple[object, ...], Expr] = {}
        self._among: dict[Expr, frozenset[int]] = {}
        self._distances: dict[tuple[int, int], Expr] = {}

    def under(self, facts: Mapping[Expr, Expr]) -> Known:
        """Return a simplifier under further facts that reuses the results for terms that this one left unchanged.

        It visits only terms that contain one of the facts again.
        """
        if not self._settled:
            return Known(facts, self._decide)
        more = Known({}, self._decide)
        more._done, more._kept = dict(self._done), dict(self._kept)
        more._among, more._distances = dict(self._among), dict(self._distances)
        left = [*facts]
        while left:
            for parent in self._parents.get(left.pop(), ()):
                if more._done.pop(parent, None) is not None:
                    left.append(parent)
        more._done.update(facts)
        return more

    @cached_property
    def _settled(self) -> bool:
        return all(folded is node for node, folded in self._done.items())

    @cached_property
    def _parents(self) -> Mapping[Expr, Sequence[Expr]]:
        """The terms that contain each term as an operand."""
        found: dict[Expr, list[Expr]] = {}
        for node in self._done:
            for part in children(node):
                found.setdefault(part, []).append(node)
        return found

    def __call__(self, term: Expr) -> Expr:
        """Return the term under the facts; of a decided choice only the chosen branch is visited."""
        done = self._done
        if term in done:
            return done[term]
        stack = [term]
        below = CHILDREN
        while stack:
            node = stack[-1]
            if node in done:
                stack.pop()
                continue
            kind = type(node)
            parts = self._branches(node) if kind is Choose or kind is ChooseBool else below[kind](node)
            if waits := [part for part in parts if part not in done]:
                stack += waits
                continue
            stack.pop()
            folded = self._folded(node)
            done[node] = self._kept.setdefault(_shape(folded), folded)
        return done[term]

    def _branches(self, node: Any) -> Sequence[Expr]:
        """Return what a choice waits for: its condition, then the branches that this leaves."""
        condition = self._done.get(node.condition)
        if condition is None:
            return (node.condition,)
        if type(condition) is Truth:
            return (node.then if condition.value else node.other,)
        return (node.then, node.other)

    def _folded(self, node: Expr) -> Expr:
        assert isinstance(node, Node)
        match node:
            case Choose() | ChooseBool():
                return self._choice(node)
            case Lit() | NumVar() | Truth() | BoolVar():
                return node
            case And(parts):
                return _joined(node, [self._done[part] for part in parts], all_of)
            case Or(parts):
                return _joined(node, [self._done[part] for part in parts], any_of)
            case Compare():
                return self._comparison(node, self._done[node.left], self._done[node.right])
            case Add() | Sub() | Mul() | Min() | Max():
                return self._distance(self._arithmetic(node, self._done[node.left], self._done[node.right]))
            case FloorDiv(left, divisor, unit):
                inner = self._done[left]
                return Lit(inner.value // divisor, unit) if isinstance(inner, Lit) else rebuilt(node, (inner,))
            case _:
                return rebuilt(node, tuple(self._done[part] for part in children(node)))

    def _choice(self, node: Choose | ChooseBool) -> Expr:
        done = self._done
        condition = done[node.condition]
        if type(condition) is Truth:
            return done[node.then if condition.value else node.other]
        then, other = done[node.then], done[node.other]
        if _same(then, other):
            return then
        chosen: Expr = node
        if condition is not node.condition or then is not node.then or other is not node.other:
            chosen = rebuilt(node, (condition, then, other))
        if (one := self._values(then)) and (two := self._values(other)) and len(values := one | two) <= _MOST_VALUES:
            self._among[chosen] = values
        return chosen

    def _distance(self, term: Expr) -> Expr:
        """Return a distance |a - b| in the order of its two terms that occurred first; any other term unchanged."""
        if not isinstance(term, Max) or not isinstance(term.left, Sub) or not is_magnitude(term):
            return term
        one, two = id(term.left.left), id(term.left.right)
        if (two, one) in self._distances:
            return self._distances[two, one]
        return self._distances.setdefault((one, two), term)

    def _values(self, term: Expr) -> frozenset[int]:
        """Return the possible values of a term that is always one of a few constants; empty if unknown."""
        return frozenset((term.value,)) if type(term) is Lit else self._among.get(term, _UNKNOWN)

    def _comparison(self, node: Compare, left: Expr, right: Expr) -> Expr:
        assert isinstance(left, Num)
        assert isinstance(right, Num)
        if isinstance(left, Lit) and isinstance(right, Lit):
            return _truth(node.op, left.value, right.value)
        if left is right:
            return FALSE if node.op == "<" else TRUE
        one, two = self._values(left), self._values(right)
        if node.op == "==" and one and two and one.isdisjoint(two):
            return FALSE
        holds = None if self._decide is None else self._decide(node.op, left, right)
        if holds is not None:
            return TRUE if holds else FALSE
        return rebuilt(node, (left, right))

    def _arithmetic(self, node: Add | Sub | Mul | Min | Max, left: Expr, right: Expr) -> Expr:
        """Return the operation on folded operands; of the smaller or greater of two, the one that is known to be it."""
        if self._decide is not None and isinstance(node, (Min, Max)):
            assert isinstance(left, Num)
            assert isinstance(right, Num)
            if self._decide("<=", left, right):
                return left if isinstance(node, Min) else right
            if self._decide("<=", right, left):
                return right if isinstance(node, Min) else left
        return _arithmetic(node, left, right)


def _shape(term: Expr) -> tuple[object, ...]:
    """Return the key of a node: two nodes with shared parts and equal keys have the same value."""
    kind, parts = type(term), children(term)
    if kind in _IN_ORDER:
        return (kind, *map(id, parts))
    if isinstance(term, Lit):
        return (Lit, term.value, term.unit if isinstance(term.unit, Enumeration) else None)  # a member keeps its label
    if isinstance(term, Truth):
        return (Truth, term.value)
    if not parts:
        return (id(term),)
    if isinstance(term, (Compare, Past)):
        return (type(term), term.op, *map(id, parts))
    if isinstance(term, FloorDiv):
        return (FloorDiv, term.divisor, id(parts[0]))
    return (kind, *sorted(map(id, parts)))  # Add, Mul, Min, Max: the order of operands does not matter


def _truth(op: str, left: int, right: int) -> Bool:
    holds = left < right if op == "<" else left <= right if op == "<=" else left == right
    return TRUE if holds else FALSE


def _same(one: Expr, two: Expr) -> bool:
    if one is two:
        return True
    return isinstance(one, (Lit, Truth)) and isinstance(two, (Lit, Truth)) and one.value == two.value


def _joined(node: Expr, parts: list[Expr], join: Callable[[Sequence[Bool]], Bool]) -> Expr:
    if all(new is old for new, old in zip(parts, children(node), strict=True)):
        return node
    return join([part for part in dict.fromkeys(parts) if isinstance(part, Bool)])


def _arithmetic(node: Add | Sub | Mul | Min | Max, left: Expr, right: Expr) -> Expr:
    if isinstance(left, Lit) and isinstance(right, Lit):
        return Lit(_FOLDS[type(node)](left.value, right.value), node.unit)
    if isinstance(node, (Add, Sub)) and isinstance(right, Lit) and right.value == 0:
        return left
    if isinstance(node, Add) and isinstance(left, Lit) and left.value == 0:
        return right
    if isinstance(node, (Min, Max)) and left is right:
        return left
    return rebuilt(node, (left, right))


def implied(condition: Bool, holds: bool) -> dict[Expr, Expr]:
    """Return the facts that follow if the condition holds (or fails), also for the parts of a conjunction (or
    disjunction)."""
    known: dict[Expr, Expr] = {condition: TRUE if holds else FALSE}
    if isinstance(condition, Not):
        known |= implied(condition.inner, not holds)
    elif isinstance(condition, And if holds else Or):
        for part in condition.parts:
            known |= implied(part, holds)
    return known
