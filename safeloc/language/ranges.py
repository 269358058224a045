"""Interval analysis: bounds of every term while variables stay in their ranges.

The analysis is sound and coarse: it bounds each operation from the bounds of its parts alone, so a bound may be wider than
the values that can occur, never narrower.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import assert_never

from safeloc.language.expr import Expr, Lit, Num, NumVar
from safeloc.language.nodes import INT64_MAX, INT64_MIN, Add, Choose, FloorDiv, Max, Min, Mul, NumNode, Sub
from safeloc.language.terms import in_order

Bounds = tuple[int, int]


def bounds(terms: Iterable[Expr]) -> dict[Num, Bounds]:
    """Return inclusive bounds of every numeric term below `terms`, the terms themselves included."""
    found: dict[Num, Bounds] = {}
    for node in in_order(terms):
        if isinstance(node, NumNode):
            found[node] = bounds_of(node, found)
    return found


def beyond_int64(terms: Iterable[Expr]) -> list[Num]:
    """Return the terms whose bounds exceed 64 bits: candidates for overflow, which a proof has to exclude."""
    return [term for term, (low, high) in bounds(terms).items() if low < INT64_MIN or high > INT64_MAX]


def bounds_of(node: NumNode, of: Mapping[Num, Bounds]) -> Bounds:
    """Return the bounds of one term from those of its parts."""
    match node:
        case Lit(value, _):
            return value, value
        case NumVar(low=low, high=high):
            return low, high
        case Add(a, b):
            return of[a][0] + of[b][0], of[a][1] + of[b][1]
        case Sub(a, b):
            return of[a][0] - of[b][1], of[a][1] - of[b][0]
        case Mul(a, b):
            corners = [x * y for x in of[a] for y in of[b]]
            return min(corners), max(corners)
        case FloorDiv(a, divisor, _):
            return of[a][0] // divisor, of[a][1] // divisor
        case Min(a, b):
            return min(of[a][0], of[b][0]), min(of[a][1], of[b][1])
        case Max(a, b):
            return max(of[a][0], of[b][0]), max(of[a][1], of[b][1])
        case Choose(_, a, b, _):
            return min(of[a][0], of[b][0]), max(of[a][1], of[b][1])
        case _:
            assert_never(node)
