"""A declaration's terms as nodes, to compare certificates with, translated independently of the writer of certificates."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from safeloc.checker.dag import BOOL, INT, Dag
from safeloc.language.expr import Expr, NumVar, Var
from safeloc.language.nodes import (
    Add,
    And,
    BoolVar,
    Choose,
    ChooseBool,
    Compare,
    FloorDiv,
    Lit,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Or,
    Past,
    Sub,
    Truth,
)
from safeloc.language.terms import children, in_order


class Translation:
    """Writes terms into a Dag; each term once."""

    def __init__(self, dag: Dag) -> None:
        self.dag = dag
        self._done: dict[Expr, int] = {}

    def __call__(self, term: Expr) -> int:
        """Return the term's node; TypeError for a past operator, which has none."""
        for node in in_order([term], self._done):
            self._done[node] = self._made(node, [self._done[child] for child in children(node)])
        return self._done[term]

    def conjuncts(self, terms: Iterable[Expr]) -> frozenset[int]:
        """Return the conjuncts of these terms."""
        return self.dag.conjuncts(map(self, terms))

    def named(self, var: Var, name: str) -> int:
        """Return the node of a variable with this name and the sort of `var`."""
        return self.dag.variable(name, INT if isinstance(var, NumVar) else BOOL)

    def _made(self, node: Node, of: list[int]) -> int:
        make = self.dag.make
        match node:
            case Lit(value, _):
                return self.dag.number(value)
            case Truth(value):
                return self.dag.truth[value]
            case NumVar(name=name) | BoolVar(name=name):
                return self.named(node, name)
            case Add():
                return make("+", of)
            case Sub():
                return make("-", of)
            case Mul():
                return make("*", of)
            case FloorDiv(_, divisor, _):
                return make("div", [*of, self.dag.number(divisor)])
            case Min():
                return make("ite", [make("<=", of), *of])
            case Max():
                return make("ite", [make(">=", of), *of])
            case Choose() | ChooseBool():
                return make("ite", of)
            case Not():
                return make("not", of)
            case And():
                return make("and", of)
            case Or():
                return make("or", of)
            case Compare(op, _, _):
                return make("=" if op == "==" else op, of)
            case Past():
                raise TypeError("a past operator is no term of one step; observe the property first")
            case _:
                assert_never(node)
