"""The distance of a condition from being false: guidance for searches.

Slack(term)(values)   the least numeric distance to failing
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from safeloc.language.expr import Bool, Expr, Var
from safeloc.language.interpret import Program
from safeloc.language.nodes import And, Compare, Not, Or, Value


class Slack:
    """The distance of a term from being false: the least numeric distance, negative once false, infinite if logical."""

    def __init__(self, term: Bool) -> None:
        self._term = term
        self._reads = [side for leaf in _leaves(term) for side in _sides(leaf)]
        self._program = Program(self._reads)

    def __call__(self, values: Mapping[Var, Value]) -> float:
        """Return the distance under these values."""
        return _slack(self._term, dict(zip(self._reads, self._program(values), strict=True)))


def _leaves(term: Bool) -> Iterable[Bool]:
    """Return the parts of conjunctions and disjunctions that are themselves neither."""
    if isinstance(term, (And, Or)):
        return [leaf for part in term.parts for leaf in _leaves(part)]
    return [term]


def _sides(leaf: Bool) -> Sequence[Expr]:
    """Return the terms whose values determine how far a leaf is from failing."""
    match leaf:
        case Compare(_, a, b) | Not(Compare("<" | "<=", a, b)):
            return (a, b)
        case _:
            return (leaf,)


def _slack(term: Bool, found: Mapping[Expr, Value]) -> float:
    match term:
        case Compare(op, a, b):
            left, right = found[a], found[b]
            return {"==": -abs(left - right), "<": right - left - 1, "<=": right - left}[op]
        case And(parts):
            return min(_slack(part, found) for part in parts)
        case Or(parts):
            return max(_slack(part, found) for part in parts)
        case Not(Compare("<", a, b)):
            return float(found[a] - found[b])
        case Not(Compare("<=", a, b)):
            return float(found[a] - found[b] - 1)
        case _:
            return float("inf") if found[term] else float("-inf")
