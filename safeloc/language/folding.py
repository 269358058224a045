"""Simplification of terms by known truth values: decided branches are removed, and nothing else changes.

    Folding({present: FALSE})(term)    the rest of the term if the input is absent; comparisons of two constants decide branches too
    settled(term)                      the rest of the term if wires have replaced inputs by constants

The module is small on purpose: claims that rest on its result are made without a solver.
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.expr import Bool, Expr, Lit, Num, ite
from safeloc.language.interpret import Program
from safeloc.language.nodes import Choose, ChooseBool, Compare, Node, Past, Truth, Var
from safeloc.language.terms import children, in_order, rebuilt


class Folding:
    """Replaces variables by constants, and each choice that these decide by its chosen branch.

    A verdict is often chosen first and compared later: `ite(present, ..., MISSING) == ADMITTED` is false for an absent input.
    """

    def __init__(self, known: Mapping[Var, Truth]) -> None:
        self._done: dict[Expr, Expr] = {var: value for var, value in known.items()}

    def __call__(self, term: Expr) -> Expr:
        """Return the folded term."""
        for node in in_order([term], self._done):
            parts = tuple(self._done[child] for child in children(node))
            self._done[node] = _chosen(*parts) if isinstance(node, (Choose, ChooseBool)) else _compared(node, parts)
        return self._done[term]


def _compared(node: Node, parts: tuple[Expr, ...]) -> Expr:
    both = isinstance(node, Compare) and all(isinstance(part, Lit) for part in parts)
    return _constant(rebuilt(node, parts)) if both else rebuilt(node, parts)


def settled(term: Bool) -> Bool:
    """Evaluate the constant parts of the term, and leave the rest unchanged."""
    done: dict[Expr, Expr] = {}
    for node in in_order([term]):
        done[node] = _settled(node, tuple(done[child] for child in children(node)))
    left = done[term]
    assert isinstance(left, Bool)
    return left


def _settled(node: Node, parts: tuple[Expr, ...]) -> Expr:
    if isinstance(node, (Choose, ChooseBool)) and any(isinstance(part, Truth) for part in parts):
        return _chosen(*parts)
    constant = parts and all(isinstance(part, (Lit, Truth)) for part in parts) and not isinstance(node, Past)
    return _constant(rebuilt(node, parts)) if constant else rebuilt(node, parts)


def _constant(term: Expr) -> Expr:
    (value,) = Program([term])({})
    return Truth(bool(value)) if isinstance(term, Bool) else Lit(int(value), term.unit)


def _chosen(condition: Expr, then: Expr, other: Expr) -> Expr:
    assert isinstance(condition, Bool)
    if isinstance(then, Num):
        assert isinstance(other, Num)
        return ite(condition, then, other)
    assert isinstance(then, Bool)
    assert isinstance(other, Bool)
    return ite(condition, then, other)
