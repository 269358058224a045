"""Terms as Python expressions, over terms that already have a name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from safeloc.codegen.merge_choices import is_magnitude
from safeloc.codegen.naming_terms import Writing
from safeloc.language.nodes import (
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
    Mul,
    Node,
    Not,
    NumVar,
    Or,
    Past,
    Sub,
    Truth,
    Var,
)

_OPPOSITE = {"<": ">=", "<=": ">", "==": "!=", ">": "<=", ">=": "<"}
_MIRRORED = {"<": ">", "<=": ">=", "==": "=="}


class PythonTerms(Writing):
    """Writes terms as Python."""

    def __init__(self, names: Mapping[Var, str]) -> None:
        super().__init__(names)
        self._passing = 0

    def code(self, term: Expr) -> str:
        """Return the term as an expression that can stand alone, as a value or as a test."""
        if term in self.named:
            return self.used(self.named[term])
        assert isinstance(term, Node)
        match term:
            case Lit(value, _):
                return str(value)
            case Truth(value):
                return str(value)
            case Add(a, b):
                return f"{self._part(a)} + {self._part(b)}"
            case Sub(Lit(0, _), b):
                return f"-{self._part(b)}"
            case Sub(a, b):
                return f"{self._part(a)} - {self._part(b)}"
            case Mul(a, b):
                return f"{self._part(a)} * {self._part(b)}"
            case FloorDiv(a, divisor, _):
                return f"{self._part(a)} // {divisor}"
            case Min(a, b):
                (x, first), (y, second) = self._twice_read(a), self._twice_read(b)
                return f"{x} if {first} < {second} else {y}"
            case Max(a, _) if is_magnitude(term):
                x, first = self._twice_read(a)
                return f"{x} if {first} >= 0 else -{x}"
            case Max(a, b):
                (x, first), (y, second) = self._twice_read(a), self._twice_read(b)
                return f"{x} if {first} > {second} else {y}"
            case Choose(c, a, b, _) | ChooseBool(c, a, b):
                return f"{self._part(a)} if {self._part(c)} else {self._part(b)}"
            case Not(Compare() as inner) if inner not in self.named:
                left, op, right = self._sides(inner)
                return f"{left} {_OPPOSITE[op]} {right}"
            case Not(inner):
                return f"not {self._part(inner)}"
            case And(parts):
                return self._conjunction(parts)
            case Or(parts):
                return " or ".join(map(self._part, parts))
            case Compare():
                return " ".join(self._sides(term))
            case Past() | NumVar() | BoolVar():
                raise KeyError(f"{term!r} has no value here")
            case _:
                assert_never(term)

    def twice(self, node: Expr) -> tuple[Expr, ...]:  # noqa: ARG002 # the same for every node
        """Return no operands: an operand that is read twice gets its name at the first reading, by `:=`."""
        return ()

    def _twice_read(self, term: Expr) -> tuple[str, str]:
        """Return the term's name, and its text for the first reading, which assigns the name."""
        if term in self.named or isinstance(term, (Lit, Truth)):
            return self._part(term), self._part(term)
        self._passing += 1
        name = f"p{self._passing}"
        return name, f"({name} := {self.code(term)})"

    def _part(self, term: Expr) -> str:
        """Return the term as an operand, in brackets if necessary."""
        bare = term in self.named or isinstance(term, (Lit, Truth))
        return self.code(term) if bare else f"({self.code(term)})"

    def _sides(self, term: Compare) -> tuple[str, str, str]:
        """Return left side, operator and right side of a comparison, with a constant on the right."""
        if isinstance(term.left, Lit):
            return self._part(term.right), _MIRRORED[term.op], self._part(term.left)
        return self._part(term.left), term.op, self._part(term.right)

    def _conjunction(self, parts: Sequence[Bool]) -> str:
        """Return the conjunction; neighbours low <= x and x <= high become one chained comparison."""
        texts, rest = list[str](), list(parts)
        while rest:
            match rest:
                case [Compare(below, low, x), Compare(above, y, high), *_] if (
                    x is y and x in self.named and "==" not in (below, above) and self.named.keys().isdisjoint(rest[:2])
                ):
                    texts.append(f"({self._part(low)} {below} {self._part(x)} {above} {self._part(high)})")
                    del rest[:2]
                case _:
                    texts.append(self._part(rest.pop(0)))
        return texts[0][1:-1] if len(texts) == 1 else " and ".join(texts)
