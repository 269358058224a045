"""Terms as C expressions, over terms that already have a name.

Every number is an `int64_t`, and `to_c` refuses systems whose terms might exceed 64 bits, so no expression can overflow. A
constant is a plain number beside an operand of 64 bits, and INT64_C(...) where it determines the width itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
    INT64_MIN,
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
from safeloc.language.units import Enumeration

_INT32_MAX = 2**31 - 1
_OPPOSITE = {"<": ">=", "<=": ">", "==": "!="}
_MIRRORED = {"<": ">", "<=": ">=", "==": "==", ">=": "<=", ">": "<", "!=": "!="}


FLOOR_DIV = """/* left / divisor, rounded towards minus infinity; the divisor is positive. */
static inline int64_t floor_div(int64_t left, int64_t divisor)
{
    return left / divisor - (left % divisor < 0);
}
"""
CEIL_DIV = """/* left / divisor, rounded towards plus infinity; the divisor is positive. */
static inline int64_t ceil_div(int64_t left, int64_t divisor)
{
    return left / divisor + (left % divisor > 0);
}
"""


def constant(value: int, *, wide: bool = False) -> str:
    """Return a whole number in C; with `wide`, of 64 bits also beside narrower operands."""
    if value == INT64_MIN:
        return "INT64_MIN"
    return f"INT64_C({value})" if wide or abs(value) > _INT32_MAX else str(value)


class CTerms(Bracketing):
    """Writes terms as C; `members` maps each enumeration to the constants of its members."""

    def __init__(self, names: Mapping[Var, str], members: Mapping[Enumeration, Sequence[str]]) -> None:
        super().__init__(names)
        self._members = members

    def _written(self, term: Expr) -> tuple[str, int]:
        """Return the term's text, and the precedence of its outermost operator."""
        if term in self.named:
            return self.used(self.named[term]), ATOM
        assert isinstance(term, Node)
        match term:
            case Lit(value, unit):
                text = self._members[unit][value] if isinstance(unit, Enumeration) else constant(value)
                return text, UNARY if text.startswith("-") else ATOM
            case Truth(value):
                return str(value).lower(), ATOM
            case Add() | Sub() | Mul() | FloorDiv():
                return self._arithmetic(term)
            case Min(a, b):
                x, y = self._part(a, SUM), self._part(b, SUM)
                return f"{x} < {y} ? {x} : {y}", CHOICE
            case Max(a, _) if is_magnitude(term):
                x = self._part(a, ATOM)
                return f"{x} >= 0 ? {x} : -{x}", CHOICE
            case Max(a, b):
                x, y = self._part(a, SUM), self._part(b, SUM)
                return f"{x} > {y} ? {x} : {y}", CHOICE
            case Choose(c, a, b, _):
                return f"{self._part(c, OR)} ? {self._branch(a)} : {self._branch(b)}", CHOICE
            case ChooseBool(c, p, q):
                return f"{self._part(c, OR)} ? {self._part(p, OR)} : {self._part(q, OR)}", CHOICE
            case Not(Compare(op, a, b) as inner) if not self._known(inner):
                return self._comparison(_OPPOSITE[op], a, b), COMPARED
            case Not(inner):
                return f"!{self._part(inner, UNARY)}", UNARY
            case And(parts):
                return " && ".join(self._part(part, COMPARED) for part in parts), AND
            case Or(parts):
                return " || ".join(self._part(part, COMPARED) for part in parts), OR
            case Compare(op, a, b):
                return self._comparison(op, a, b), COMPARED
            case Past() | NumVar() | BoolVar():
                raise KeyError(f"{term!r} has no value here")
            case _:
                assert_never(term)

    def _arithmetic(self, term: Add | Sub | Mul | FloorDiv) -> tuple[str, int]:
        match term:
            case Add(a, Lit(value, _)) if INT64_MIN < value < 0:
                return f"{self._part(a, SUM)} - {constant(-value)}", SUM
            case Add(a, b):
                return f"{self._part(a, SUM)} + {self._part(b, PRODUCT)}", SUM
            case Sub(Lit(0, _), FloorDiv(Sub(Lit(0, _), a) as inner, k, _) as down) if not self._known(inner, down):
                return f"{self.used('ceil_div')}({self.code(a)}, {constant(k)})", ATOM
            case Sub(Lit(0, _), b):
                return f"-{self._part(b, ATOM)}", UNARY
            case Sub(a, b):
                return f"{self._part(a, SUM)} - {self._part(b, PRODUCT)}", SUM
            case Mul(a, b):
                return f"{self._part(a, PRODUCT)} * {self._part(b, UNARY)}", PRODUCT
            case FloorDiv(a, divisor, _):
                return f"{self.used('floor_div')}({self.code(a)}, {constant(divisor)})", ATOM
            case _:
                assert_never(term)

    def _known(self, *terms: Expr) -> bool:
        """Return whether one of the terms has a name."""
        return any(term in self.named for term in terms)

    def _branch(self, term: Expr) -> str:
        """Return a branch of a choice, with 64 bits, since users of the choice rely on that width."""
        plain = isinstance(term, Lit) and term not in self.named and not isinstance(term.unit, Enumeration)
        return constant(term.value, wide=True) if plain and isinstance(term, Lit) else self._part(term, OR)

    def _comparison(self, op: str, left: Num, right: Num) -> str:
        """Return a comparison, with a constant on the right."""
        if isinstance(left, Lit):
            left, op, right = right, _MIRRORED[op], left
        return f"{self._part(left, SUM)} {op} {self._part(right, SUM)}"
