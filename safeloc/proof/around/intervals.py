"""Bounds of terms while their variables stay in their ranges, where equal parts of a sum cancel.

`safeloc.language.ranges` bounds each operation from the bounds of its parts alone. Here a sum is bounded as a sum of multiples
of its atoms too: `(x + a) - (x + b)` is `a - b`, however wide the range of x.
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.nodes import Add, Expr, Lit, Mul, Node, Num, NumNode, Sub
from safeloc.language.ranges import Bounds, bounds_of
from safeloc.language.terms import in_order

_MOST_ATOMS = 40
"""A sum of more atoms counts as one atom: comparisons of long sums would take long."""


class _Sum:
    """A sum of multiples of atoms, and a constant."""

    __slots__ = ("constant", "of")

    def __init__(self, of: Mapping[Num, int], constant: int) -> None:
        self.of, self.constant = of, constant

    def plus(self, other: _Sum, sign: int) -> _Sum:
        """Return this sum plus or minus the other."""
        found = dict(self.of)
        for atom, factor in other.of.items():
            found[atom] = found.get(atom, 0) + sign * factor
        return _Sum({atom: factor for atom, factor in found.items() if factor}, self.constant + sign * other.constant)


class Intervals:
    """Bounds of terms; what was bounded once is kept."""

    def __init__(self) -> None:
        self._of: dict[Num, Bounds] = {}
        self._sums: dict[Num, _Sum] = {}
        self._seen: set[Expr] = set()

    def __call__(self, term: Num) -> Bounds:
        """Return the least and the greatest value that the term may have."""
        found = self._of.get(term)
        if found is None:
            for node in in_order([term], self._seen):
                self._seen.add(node)
                self._learn(node)
            found = self._of[term]
        return found

    def decide(self, sign: str, left: Num, right: Num) -> bool | None:
        """Return whether a comparison holds for all values of the variables (True), for none (False), or for some (None)."""
        low, high = self._difference(left, right)
        match sign:
            case "<":
                return True if high < 0 else False if low >= 0 else None
            case "<=":
                return True if high <= 0 else False if low > 0 else None
            case _:
                return True if low == high == 0 else False if low > 0 or high < 0 else None

    def _difference(self, left: Num, right: Num) -> Bounds:
        (low, high), (least, most) = self(left), self(right)
        apart = low - most, high - least
        if apart[0] > 0 or apart[1] < 0:
            return apart
        return _common(apart, self._of_sum(self._sums[left].plus(self._sums[right], -1)))

    def _learn(self, node: Node) -> None:
        if not isinstance(node, NumNode):
            return
        of_parts = bounds_of(node, self._of)
        made = self._sum(node)
        self._of[node] = of_parts if made is None else _common(of_parts, self._of_sum(made))
        self._sums[node] = _Sum({node: 1}, 0) if made is None or len(made.of) > _MOST_ATOMS else made

    def _sum(self, node: NumNode) -> _Sum | None:
        """Return the sum that a term is; None for an atom."""
        match node:
            case Lit(value, _):
                return _Sum({}, value)
            case Add(left, right):
                return self._sums[left].plus(self._sums[right], 1)
            case Sub(left, right):
                return self._sums[left].plus(self._sums[right], -1)
            case Mul(Lit(factor), inner) | Mul(inner, Lit(factor)):
                one = self._sums[inner]
                return _Sum({a: f * factor for a, f in one.of.items()} if factor else {}, one.constant * factor)
            case _:
                return None

    def _of_sum(self, one: _Sum) -> Bounds:
        low = high = one.constant
        for atom, factor in one.of.items():
            least, most = self._of[atom]
            low += factor * (least if factor > 0 else most)
            high += factor * (most if factor > 0 else least)
        return low, high


def _common(one: Bounds, other: Bounds) -> Bounds:
    return max(one[0], other[0]), min(one[1], other[1])
