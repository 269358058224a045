"""The kinds of wrong terms: replacements of a term, made from its parts.

A change is a function of the parts, not of one node: so it applies to every occurrence of a term, including those that read
the values before the step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

from safeloc.language.expr import before, was
from safeloc.language.nodes import (
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
    Not,
    NumVar,
    Or,
    Sub,
    Var,
    all_of,
    any_of,
)
from safeloc.language.terms import children, logical, numeric, rebuilt
from safeloc.language.units import Enumeration

_BOUND = "bound off by one unit"
_TURNED = "comparison turned"
_DROPPED = "term of a sum dropped"
_EXTREME = "min for max"
_ROUNDING = "rounding turned"
CONDITION = "condition dropped"
_AND_OR = "and for or"
_NEIGHBOUR = "figure replaced by its neighbour"
_ZERO = "figure replaced by zero"
SIGN = "sign turned"
_VARIABLE = "another variable of the same unit"
_ABSENCE = "absence ignored"
_NEGATED = "condition turned"

Parts = tuple[Expr, ...]


@dataclass(frozen=True, eq=False)
class Change:
    """One way in which a term may be wrong: kind, description, and the function that makes the replacement from the parts."""

    kind: str
    words: str
    make: Callable[[Parts], Expr]


Others = Callable[[Var], Var | None]
"""A function that gives another variable that could have been meant; None if there is none."""


def changes(node: Expr, others: Others) -> Iterator[Change]:
    """Return all changes of one term and of its parts that are variables or constants; other parts are terms of their own.

    Bounds move by one unit both ways (`a < b` for `a <= b` is one unit less), since a change that weakens a clause strengthens
    its negation.
    """
    match node:
        case Compare():
            yield from _of_comparison(node)
        case Add() | Sub():
            yield from _of_sum(node)
        case Min() | Max():
            yield from _of_extreme(node)
        case FloorDiv():
            yield from _of_division(node)
        case And() | Or():
            yield from _of_junction(node)
        case Choose() | ChooseBool():
            yield from _of_choice(node)
        case Not(inner) if not isinstance(inner, Compare):
            yield Change(_NEGATED, "not left out", lambda parts: parts[0])
        case _:
            pass
    for number, part in enumerate(children(node)):
        if not _is_spelling(node, part):
            for change in of_operand(part, others):
                yield replace(change, make=partial(_with_part, node, number, change.make))


def _is_spelling(node: Expr, part: Expr) -> bool:
    """Return whether the part is a zero that nobody wrote: `-x` is stored as `0 - x`, a change of unit as a sum with 0."""
    return isinstance(node, (Add, Sub)) and isinstance(part, Lit) and part.value == 0


def of_operand(part: Expr, others: Others) -> Iterator[Change]:
    """Return all changes of a variable or constant; each is made from the operand itself as the only part."""
    match part:
        case Lit():
            yield from _of_figure(part)
        case NumVar() | BoolVar():
            if isinstance(part, BoolVar) and part.name.endswith(".present"):
                yield Change(_ABSENCE, f"{part.name} taken as true", lambda _: TRUE)
            other = others(part if part.before is None else part.before)
            if other is not None:
                yield Change(_VARIABLE, f"{part.name} becomes {other.name}", lambda parts: _meant(parts[0], other))
        case _:
            pass


def _with_part(node: Expr, number: int, make: Callable[[Parts], Expr], parts: Parts) -> Expr:
    changed = (*parts[:number], make((parts[number],)), *parts[number + 1 :])
    return rebuilt(node, changed)  # type: ignore[arg-type] # every node is a Num or a Bool


def _meant(part: Expr, other: Var) -> Var:
    """Return the other variable; its value before the step if the part reads that."""
    if not isinstance(part, (NumVar, BoolVar)) or part.before is None:
        return other
    return before(other) if isinstance(other, NumVar) else was(other)


def _of_comparison(node: Compare) -> Iterator[Change]:
    unit = node.left.unit
    if isinstance(unit, Enumeration):
        yield Change(
            _TURNED, "equal becomes unequal", lambda parts: Not(Compare("==", numeric(parts[0]), numeric(parts[1])))
        )
        return
    one = Lit(1, unit)
    if node.op == "==":
        yield Change(
            _TURNED, "equal becomes unequal", lambda parts: Not(Compare("==", numeric(parts[0]), numeric(parts[1])))
        )
        yield Change(
            _BOUND, "one more", lambda parts: Compare("==", numeric(parts[0]), Add(numeric(parts[1]), one, unit))
        )
    elif node.op == "<":
        yield Change(_BOUND, "< becomes <=", lambda parts: Compare("<=", numeric(parts[0]), numeric(parts[1])))
        yield Change(
            _BOUND, "one unit less", lambda parts: Compare("<", Add(numeric(parts[0]), one, unit), numeric(parts[1]))
        )
        yield Change(_TURNED, "< becomes >", lambda parts: Compare("<", numeric(parts[1]), numeric(parts[0])))
    else:
        yield Change(_BOUND, "<= becomes <", lambda parts: Compare("<", numeric(parts[0]), numeric(parts[1])))
        yield Change(
            _BOUND, "one unit more", lambda parts: Compare("<=", numeric(parts[0]), Add(numeric(parts[1]), one, unit))
        )
        yield Change(_TURNED, "<= becomes >=", lambda parts: Compare("<=", numeric(parts[1]), numeric(parts[0])))


def _of_sum(node: Add | Sub) -> Iterator[Change]:
    zero, unit = Lit(0, node.unit), node.unit
    if not node.left.unit.same(unit):  # a change of unit is stored as a sum with zero
        return
    if isinstance(node, Add):
        yield Change(_DROPPED, "the second is left out", lambda parts: parts[0])
        yield Change(_DROPPED, "the first is left out", lambda parts: parts[1])
        yield Change(SIGN, "+ becomes -", lambda parts: Sub(numeric(parts[0]), numeric(parts[1]), unit))
    elif isinstance(node.left, Lit) and node.left.value == 0:
        yield Change(SIGN, "minus left out", lambda parts: parts[1])
    else:
        yield Change(_DROPPED, "the second is left out", lambda parts: parts[0])
        yield Change(_DROPPED, "the first is left out", lambda parts: Sub(zero, numeric(parts[1]), unit))
        yield Change(SIGN, "- becomes +", lambda parts: Add(numeric(parts[0]), numeric(parts[1]), unit))


def _of_extreme(node: Min | Max) -> Iterator[Change]:
    unit = node.unit
    other: type[Min | Max] = Max if isinstance(node, Min) else Min
    words = "min becomes max" if isinstance(node, Min) else "max becomes min"
    yield Change(_EXTREME, words, lambda parts: other(numeric(parts[0]), numeric(parts[1]), unit))


def _of_division(node: FloorDiv) -> Iterator[Change]:
    """Return the changes of rounding and divisor. Rounding up is stored as `-(-x // d)`, so one change turns either rounding."""
    divisor, unit, zero = node.divisor, node.unit, Lit(0, node.unit)

    def up(parts: Parts) -> Expr:
        inner = numeric(parts[0])
        return Sub(zero, FloorDiv(Sub(Lit(0, inner.unit), inner, inner.unit), divisor, unit), unit)

    yield Change(_ROUNDING, "rounded to the other side", up)
    more = divisor + 1
    yield Change(_NEIGHBOUR, f"divided by {more}", lambda parts: FloorDiv(numeric(parts[0]), more, unit))


def _of_junction(node: And | Or) -> Iterator[Change]:
    both = isinstance(node, And)
    if both:
        yield Change(_AND_OR, "and becomes or", lambda parts: any_of(map(logical, parts)))
    else:
        yield Change(_AND_OR, "or becomes and", lambda parts: all_of(map(logical, parts)))
    for number in range(len(node.parts)):
        yield Change(CONDITION, f"condition {number + 1} is left out", partial(_without, both, number))


def _without(both: bool, number: int, parts: Parts) -> Bool:
    rest = [logical(part) for place, part in enumerate(parts) if place != number]
    return all_of(rest) if both else any_of(rest)


def _of_choice(node: Choose | ChooseBool) -> Iterator[Change]:
    yield Change(CONDITION, "always the first", lambda parts: parts[1])
    yield Change(CONDITION, "always the second", lambda parts: parts[2])
    yield Change(
        _NEGATED, "the two exchanged", lambda parts: rebuilt(node, (parts[0], parts[2], parts[1]))
    )  # both are of one kind and unit


def _of_figure(lit: Lit) -> Iterator[Change]:
    """Return the changes of a constant: the next member; for a number its neighbour away from zero, and zero."""
    value, unit = lit.value, lit.unit
    if isinstance(unit, Enumeration):
        following = Lit((value + 1) % len(unit.members), unit)
        if following.value != value:
            yield Change(_NEIGHBOUR, f"{lit.label} becomes {following.label}", lambda _: following)
        return
    if value == 0:
        yield Change(_NEIGHBOUR, "0 becomes 1", lambda _: Lit(1, unit))
        return
    beside = value + 1 if value > 0 else value - 1
    yield Change(_NEIGHBOUR, f"{value} becomes {beside}", lambda _: Lit(beside, unit))
    yield Change(_ZERO, f"{value} becomes 0", lambda _: Lit(0, unit))
