"""Shorter forms of terms for back ends that compute both branches of every choice.

In a transition table many rows give a variable the same value, so its chain of choices repeats a few values. These back ends
need one choice for each value instead; conditions are cheap for them, and all variables share them:

    ite(c, a, ite(d, b, ite(e, a, b)))  =  ite(c or (e and not (c or d)), a, b)
    ite(c, a, ite(d, a, b))             =  ite(c or d, a, b)
    ite(c, a, ite(d, b, a))             =  ite(not c and d, b, a)
    ite(c, p, q)                        =  (c and p) or (not c and q)       of truth values
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from safeloc.language.nodes import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Choose,
    ChooseBool,
    Expr,
    Lit,
    Max,
    Node,
    Num,
    NumVar,
    Sub,
    Truth,
    all_of,
    any_of,
)
from safeloc.language.terms import Sharing, children, in_order, rebuilt

_SHORTEST_TABLE = 3


def is_magnitude(term: Expr) -> bool:
    """Return whether the term is max(x, 0 - x), as `abs_` builds it."""
    match term:
        case Max(a, Sub(Lit(0, _), b), _):
            return a is b
        case _:
            return False


def operations(results: Sequence[Expr]) -> list[Node]:
    """List the terms that straight-line code must compute, operands first; variables need no computation."""
    wanted = set(results)
    order = in_order(results)
    for node in reversed(order):
        if node in wanted:
            wanted.update(operands(node))
    return [node for node in order if node in wanted and not isinstance(node, (NumVar, BoolVar))]


def operands(node: Expr) -> tuple[Expr, ...]:
    """Return the terms that the node's operation reads: for a magnitude max(x, 0 - x) only x."""
    return children(node)[:1] if is_magnitude(node) else children(node)


def chain(term: Expr) -> tuple[list[tuple[Bool, Expr]], Expr]:
    """Return the rows of a chain of choices (condition and value), and its value if no condition holds."""
    rows: list[tuple[Bool, Expr]] = []
    while isinstance(term, (Choose, ChooseBool)):
        rows.append((term.condition, term.then))
        term = term.other
    return rows, term


def merged(terms: Sequence[Expr]) -> list[Expr]:
    """Return terms of equal value with fewer choices, and with no choice of truth values; shared parts stay shared."""
    rows = _Rows()
    return _rewritten(_rewritten([rows.by_value(term) for term in terms], _merged), _logic)


def _rewritten(terms: Sequence[Expr], rule: Callable[[Expr], Expr]) -> list[Expr]:
    """Return the terms with the rule applied to every node, operands first."""
    share, done = Sharing(), dict[Expr, Expr]()
    for node in in_order(terms):
        done[node] = share(rule(rebuilt(node, tuple(done[part] for part in children(node)))))
    return [done[term] for term in terms]


class _Rows:
    """Rewrites chains by value instead of by row; chains with the same conditions share their terms."""

    def __init__(self) -> None:
        self._taken: dict[tuple[int, int], tuple[Bool, Bool]] = {}

    def by_value(self, term: Expr) -> Expr:
        """Return a chain of choices as one choice for each value; the term itself if the chain is short."""
        rows, last = chain(term)
        if len(rows) < _SHORTEST_TABLE:
            return term
        places: dict[object, _Places] = {}
        earlier: Bool = FALSE
        for condition, value in [*rows, (TRUE, last)]:
            taken, earlier = self._row(earlier, condition)
            for only, part in _parts(value):
                places.setdefault(_key(part), _Places(part, {})).where.setdefault(only, []).append(taken)
        usual = max(places.values(), key=lambda place: sum(map(len, place.where.values())))
        result = usual.value
        for place in places.values():
            if place is not usual:
                result = _choose(
                    any_of(all_of([any_of(t), only]) for only, t in place.where.items()), place.value, result
                )
        return result

    def _row(self, earlier: Bool, condition: Bool) -> tuple[Bool, Bool]:
        """Return two conditions: this row is the first whose condition holds; this or an earlier row's condition holds."""
        key = id(earlier), id(condition)
        if key not in self._taken:
            self._taken[key] = all_of([~earlier, condition]), any_of([earlier, condition])
        return self._taken[key]


@dataclass(frozen=True)
class _Places:
    """A value, and the rows that give it: condition within the row -> the conditions that such rows are taken."""

    value: Expr
    where: dict[Bool, list[Bool]]


def _parts(value: Expr) -> list[tuple[Bool, Expr]]:
    """Split the value of a row: one value, or a value under a condition and otherwise a constant, such as 0."""
    if isinstance(value, Choose) and isinstance(value.other, Lit):
        return [(value.condition, value.then), (~value.condition, value.other)]
    return [(TRUE, value)]


def _key(value: Expr) -> object:
    return (type(value), value.value) if isinstance(value, (Lit, Truth)) else id(value)


def _choose(condition: Bool, then: Expr, other: Expr) -> Expr:
    if isinstance(then, Num) and isinstance(other, Num):
        return Choose(condition, then, other, then.unit)
    assert isinstance(then, Bool) and isinstance(other, Bool)
    return ChooseBool(condition, then, other)


def _merged(term: Expr) -> Expr:
    assert isinstance(term, Node)
    match term:
        case Choose(_, a, b, _) | ChooseBool(_, a, b) if a is b:
            return a
        case Choose(c, a, Choose(d, b, e, _), unit):
            if a is b:
                return Choose(any_of([c, d]), a, e, unit)
            return Choose(all_of([~c, d]), b, a, unit) if a is e else term
        case ChooseBool(c, p, ChooseBool(d, q, r)):
            if p is q:
                return ChooseBool(any_of([c, d]), p, r)
            return ChooseBool(all_of([~c, d]), q, p) if p is r else term
        case _:
            return term


def _logic(term: Expr) -> Expr:
    """Return a choice of truth values as and, or, not; any other term unchanged."""
    if not isinstance(term, ChooseBool):
        return term
    condition, then, other = term.condition, term.then, term.other
    if isinstance(then, Truth):
        return any_of([condition, other]) if then.value else all_of([~condition, other])
    if isinstance(other, Truth):
        return any_of([~condition, then]) if other.value else all_of([condition, then])
    return any_of([all_of([condition, then]), all_of([~condition, other])])
