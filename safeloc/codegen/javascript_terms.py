"""Terms as JavaScript expressions, over terms that already have a name.

Every number is a BigInt, so it is exact whatever its size: nothing is computed in floating point.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from safeloc.codegen.merge_choices import is_magnitude
from safeloc.codegen.naming_terms import (
    AND,
    ATOM,
    CHOICE,
    COMPARED,
    OR,
    PRODUCT,
    SUM,
    UNARY,
    Bracketing,
)
from safeloc.language.nodes import (
    Add,
    And,
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
    Var,
)

_OPPOSITE = {"<": ">=", "<=": ">", "===": "!=="}


class JavaScriptTerms(Bracketing):
    """Writes terms as JavaScript.

    checked  every sum, difference and product is checked to stay within 64 bits, by the function `fits`
    passing  number of names p1, p2, ... that the text assigns within expressions; whoever uses the text declares them
    """

    def __init__(self, names: Mapping[Var, str], *, checked: bool = False) -> None:
        super().__init__(names)
        self.passing = 0
        self._checked = checked

    def twice(self, node: Expr) -> tuple[Expr, ...]:  # noqa: ARG002 # the same for every node
        """Return no operands: an operand that is read twice gets its name at the first reading, by an assignment."""
        return ()

    def _written(self, term: Expr) -> tuple[str, int]:
        """Return the term's text, and the precedence of its outermost operator."""
        if term in self.named:
            return self.used(self.named[term]), ATOM
        assert isinstance(term, Node)
        match term:
            case Lit(value, _):
                return f"{value}n", UNARY if value < 0 else ATOM
            case Truth(value):
                return str(value).lower(), ATOM
            case Add() | Sub() | Mul():
                return self._fitting(*self._arithmetic(term))
            case FloorDiv(a, divisor, _):
                return f"{self.used('down')}({self.code(a)},{divisor}n)", ATOM
            case Min() | Max():
                return self._extreme(term), CHOICE
            case Choose(c, a, b, _) | ChooseBool(c, a, b):
                return f"{self._part(c, OR)}?{self._part(a, OR)}:{self._part(b, CHOICE)}", CHOICE
            case Not(Compare() as inner) if inner not in self.named:
                left, op, right = self._sides(inner)
                return f"{left}{_OPPOSITE[op]}{right}", COMPARED
            case Not(inner):
                return f"!{self._part(inner, UNARY)}", UNARY
            case And(parts):
                return "&&".join(self._part(part, COMPARED) for part in parts), AND
            case Or(parts):
                return "||".join(self._part(part, AND) for part in parts), OR
            case Compare():
                return "".join(self._sides(term)), COMPARED
            case Past() | NumVar() | BoolVar():
                raise KeyError(f"{term!r} has no value here")
            case _:
                assert_never(term)

    def _arithmetic(self, term: Add | Sub | Mul) -> tuple[str, int]:
        match term:
            case Add(a, b):
                return f"{self._part(a, SUM)}+{self._part(b, PRODUCT)}", SUM
            case Sub(Lit(0, _), b):
                return f"-{self._part(b, ATOM)}", UNARY
            case Sub(a, b):
                right = self._part(b, PRODUCT)  # a minus sign after another one would be a decrement
                return f"{self._part(a, SUM)}-{f'({right})' if right.startswith('-') else right}", SUM
            case Mul(a, b):
                return f"{self._part(a, PRODUCT)}*{self._part(b, UNARY)}", PRODUCT
            case _:
                assert_never(term)

    def _fitting(self, text: str, firmness: int) -> tuple[str, int]:
        """Return the text as it is, or within a call that refuses a value beyond 64 bits."""
        return (f"{self.used('fits')}({text})", ATOM) if self._checked else (text, firmness)

    def _extreme(self, term: Min | Max) -> str:
        if isinstance(term, Max) and is_magnitude(term):
            x, first = self._twice_read(term.left)
            return f"{first}<0n?-{x}:{x}"
        (x, first), (y, second) = self._twice_read(term.left), self._twice_read(term.right)
        return f"{first}{'<' if isinstance(term, Min) else '>'}{second}?{x}:{y}"

    def _twice_read(self, term: Num) -> tuple[str, str]:
        """Return the term's name, and its text for the first reading, which assigns the name."""
        if term in self.named or isinstance(term, Lit):
            text = self._part(term, ATOM)
            return text, text
        self.passing += 1
        name = f"p{self.passing}"
        return name, f"({name}={self.code(term)})"

    def _sides(self, term: Compare) -> tuple[str, str, str]:
        """Return left side, operator and right side of a comparison."""
        op = "===" if term.op == "==" else term.op
        return self._part(term.left, SUM), op, self._part(term.right, SUM)
