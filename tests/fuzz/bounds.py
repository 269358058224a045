"""Between which bounds a term of our own stays, and whether it and all below it stay within 64 bits."""

from __future__ import annotations

from collections.abc import Mapping

from tests.fuzz.terms import Term, below

FIRST, LAST = -(2**63), 2**63 - 1
Range = tuple[int, int]
COMPARED = ("lt", "le", "gt", "ge", "eq", "ne", "among")


def bounds(term: Term, ranges: Mapping[str, Range]) -> Range:
    """Of a number, from the bounds of its parts."""
    match term:
        case ("lit" | "member", number):
            return number, number
        case ("var" | "was", name):
            return ranges[name]
        case ("ite", _, left, right):
            (a, b), (c, d) = bounds(left, ranges), bounds(right, ranges)
            return min(a, c), max(b, d)
        case ("abs", inner):
            a, b = bounds(inner, ranges)
            return max(a, -b), max(b, -a)  # of its parts alone, as the greater of it and its negation
        case ("floor" | "ceil", inner, divisor):
            a, b = bounds(inner, ranges)
            return (a // divisor, b // divisor) if term[0] == "floor" else (-(-a // divisor), -(-b // divisor))
        case (operator, left, right):
            return _both(operator, bounds(left, ranges), bounds(right, ranges))
    raise ValueError(term)


def _both(operator: str, left: Range, right: Range) -> Range:
    match operator:
        case "add":
            return left[0] + right[0], left[1] + right[1]
        case "sub":
            return left[0] - right[1], left[1] - right[0]
        case "mul":
            corners = [a * b for a in left for b in right]
            return min(corners), max(corners)
        case "min":
            return min(left[0], right[0]), min(left[1], right[1])
        case "max":
            return max(left[0], right[0]), max(left[1], right[1])
    raise ValueError(operator)


def fits(term: Term, ranges: Mapping[str, Range]) -> bool:
    """Whether no number below the term leaves 64 bits, whatever its variables are; nor what its negation needs."""
    numbers = [one for one in below(term) if one[0] in ("add", "sub", "mul", "floor", "ceil", "min", "max", "abs")]
    return all(_within(one, ranges) for one in numbers)


def _within(term: Term, ranges: Mapping[str, Range]) -> bool:
    low, high = bounds(term, ranges)
    if term[0] in ("ceil", "abs"):  # made of negations
        inner = bounds(term[1], ranges)
        low, high = min(low, -inner[1]), max(high, -inner[0])
    return low >= FIRST and high <= LAST
