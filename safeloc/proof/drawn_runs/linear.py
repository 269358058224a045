"""Disjunctions that are linear in one variable: the values for which they hold follow at once, without any trial.

not present or 3 * x + y <= 5 m     along x: all values where not present, else those up to (5 m - y) / 3
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.language.expr import Bool, Expr, NumVar, Var
from safeloc.language.nodes import Add, Choose, Compare, Lit, Mul, Not, Num, Or, Sub, Value, any_of
from safeloc.language.units import ONE

Segment = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Straight:
    """A disjunction whose parts that read one variable are all comparisons linear in it: its segments follow without any trial.

    parts   the disjunction of all other parts; then of each comparison right side minus left side, and how much this grows when the
            variable grows by 1
    kinds   the operator of each comparison, `!=` too
    """

    parts: tuple[Expr, ...]
    kinds: tuple[str, ...]

    def segments(self, numbers: Sequence[Value], at: int, here: int, within: Segment) -> Sequence[Segment]:
        """Return the intervals in which the disjunction holds, in order, of those `within`.

        numbers  values where the variable is `here`; those of the parts stand from place `at` on
        """
        low, high = within
        if numbers[at]:
            return (within,)
        found = list[Segment]()
        for op in self.kinds:
            for begin, end in _kept(here, int(numbers[at + 1]), op, int(numbers[at + 2]), low, high):
                if begin <= high and end >= low:
                    found.append((begin if begin > low else low, end if end < high else high))
            at += 2
        return found if len(found) < 2 else _united(found)


def _kept(here: int, gap: int, op: str, slope: int, low: int, high: int) -> tuple[Segment, ...]:
    """Return the intervals in which a comparison holds whose gap at `here` grows by `slope` a step; they may exceed the bounds."""
    if not slope:
        holds = {"<": gap > 0, "<=": gap >= 0, "==": gap == 0, "!=": gap != 0}[op]
        return ((low, high),) if holds else ()
    steps, rest = divmod(-gap, slope)
    root = here + steps  # or the whole number below it
    if op == "==":
        return () if rest else ((root, root),)
    if op == "!=":
        return ((low, high),) if rest else ((low, root - 1), (root + 1, high))
    at_root = op == "<=" and not rest
    if slope > 0:
        return ((root if at_root else root + 1, high),)
    return ((low, root if at_root or rest else root - 1),)


def _united(segments: Sequence[Segment]) -> list[Segment]:
    """Return the union, in order."""
    united = list[Segment]()
    for low, high in sorted(segments):
        if united and low <= united[-1][1] + 1:
            united[-1] = (united[-1][0], max(high, united[-1][1]))
        else:
            united.append((low, high))
    return united


def straight_of(var: NumVar, term: Bool, below: Mapping[Expr, frozenset[Var]]) -> Straight | None:
    """Return the condition as a disjunction of comparisons linear in the variable; None if it is none."""
    others, numbers, kinds = list[Bool](), list[Expr](), list[str]()
    for part in term.parts if isinstance(term, Or) else (term,):
        if var not in below[part]:
            others.append(part)
            continue
        negated = isinstance(part, Not)
        compared = part.inner if isinstance(part, Not) else part
        if not isinstance(compared, Compare) or (negated and compared.op != "=="):
            return None
        slope = slope_of_gap(compared, var, below)
        if slope is None:
            return None
        numbers += [Sub(compared.right, compared.left, ONE), slope]
        kinds.append("!=" if negated else compared.op)
    return Straight((any_of(others), *numbers), tuple(kinds))


def slope_of_gap(node: Compare, var: NumVar, below: Mapping[Expr, frozenset[Var]]) -> Num | None:
    """Return how much the right side minus the left side grows when the variable grows by 1; None if that depends on the variable."""
    left, right = _slope(node.left, var, below), _slope(node.right, var, below)
    return None if left is None or right is None else _added(right, left, -1)


def _slope(term: Num, var: NumVar, below: Mapping[Expr, frozenset[Var]]) -> Num | None:
    """Return how much a term grows when the variable grows by 1, as a term without it; None if that depends on the variable."""
    if var not in below[term]:
        return Lit(0, ONE)
    match term:
        case NumVar():
            return Lit(1, ONE)
        case Add(left, right) | Sub(left, right):
            first, second = _slope(left, var, below), _slope(right, var, below)
            return (
                None if first is None or second is None else _added(first, second, 1 if isinstance(term, Add) else -1)
            )
        case Mul(left, right):
            factor, inner = (right, left) if var in below[left] else (left, right)
            grows = None if var in below[factor] else _slope(inner, var, below)
            return None if grows is None else _multiplied(factor, grows)
        case Choose(condition, then, other) if var not in below[condition]:
            first, second = _slope(then, var, below), _slope(other, var, below)
            return None if first is None or second is None else _chosen(condition, first, second)
        case _:
            return None


def _added(first: Num, second: Num, sign: int) -> Num:
    match first, second:
        case Lit(one), Lit(two):
            return Lit(one + sign * two, ONE)
        case _, Lit(0):
            return first
        case _:
            return (Add if sign > 0 else Sub)(first, second, ONE)


def _multiplied(factor: Num, grows: Num) -> Num:
    match factor, grows:
        case Lit(one), Lit(two):
            return Lit(one * two, ONE)
        case _, Lit(1):
            return factor
        case _:
            return Mul(factor, grows, ONE)


def _chosen(condition: Bool, first: Num, second: Num) -> Num:
    match first, second:
        case Lit(one), Lit(two) if one == two:
            return first
        case _:
            return Choose(condition, first, second, ONE)
