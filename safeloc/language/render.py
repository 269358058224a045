"""Terms as text for a person: infix, with units on constants, and bounded in length."""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from safeloc.language.expr import BoolVar, Expr, Lit, NumVar
from safeloc.language.nodes import (
    Add,
    And,
    Choose,
    ChooseBool,
    Compare,
    FloorDiv,
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
from safeloc.language.terms import Sharing
from safeloc.language.units import ONE, Enumeration

_DEEPEST = 7


def infix(term: Expr, most: int = 160, names: Mapping[Expr, str] | None = None, *, deepest: int = _DEEPEST) -> str:
    """Return the term in infix notation, with an ellipsis for parts nested deeper than `deepest` and beyond `most` characters.

    names  terms that are shown by a name of their own
    """
    text = _Writer(names or {}, deepest).write(term, 0)
    if text.startswith("(") and text.endswith(")") and _closes_at_end(text):
        text = text[1:-1]
    return text if len(text) <= most else text[: most - 1] + "…"


def names_of_outputs(outputs: Mapping[str, Expr], share: Sharing) -> dict[Expr, str]:
    """Return the names of the outputs that are computed, by their terms after sharing; equal terms have all their names."""
    names: dict[Expr, str] = {}
    for name, term in outputs.items():
        if not isinstance(term, (NumVar, BoolVar)):
            one = share(term)
            names[one] = f"{names[one]}, {name}" if one in names else name
    return names


def _closes_at_end(text: str) -> bool:
    depth = 0
    for index, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if depth == 0:
            return index == len(text) - 1
    return False


class _Writer:
    def __init__(self, names: Mapping[Expr, str], deepest: int) -> None:
        self._names = names
        self._deepest = deepest

    def write(self, term: Expr, depth: int) -> str:
        if term in self._names:
            return self._names[term]
        assert isinstance(term, Node)
        if depth > self._deepest and not isinstance(term, (Lit, NumVar, BoolVar, Truth)):
            return "…"
        inner = depth + 1
        match term:
            case Lit(_, unit):
                plain = isinstance(unit, Enumeration) or unit.same(ONE)
                return term.label if plain else f"{term.label} {unit.name}"
            case NumVar(name=name) | BoolVar(name=name):
                return name
            case Truth(value):
                return "true" if value else "false"
            case Add(a, Lit(0, _), _):
                return self.write(a, depth)
            case Add(a, b) | Sub(a, b) | Mul(a, b):
                sign = {Add: "+", Sub: "−", Mul: "×"}[type(term)]
                return f"({self.write(a, inner)} {sign} {self.write(b, inner)})"
            case FloorDiv(a, divisor, _):
                return f"⌊{self.write(a, inner)} / {divisor}⌋"
            case Max(a, Sub(Lit(0, _), b, _), _) if a is b:
                return f"|{self.write(a, inner)}|"
            case Min(a, b) | Max(a, b):
                return f"{type(term).__name__.lower()}({self.write(a, inner)}, {self.write(b, inner)})"
            case Choose(c, a, b, _) | ChooseBool(c, a, b):
                return f"({self.write(a, inner)} if {self.write(c, inner)} else {self.write(b, inner)})"
            case Not(Compare("==", a, b)):
                return f"({self.write(a, inner)} ≠ {self.write(b, inner)})"
            case Not(inside):
                return f"not {self.write(inside, inner)}"
            case And(parts):
                return "(" + " and ".join(self.write(part, inner) for part in parts) + ")"
            case Or(parts):
                return "(" + " or ".join(self.write(part, inner) for part in parts) + ")"
            case Compare(op, a, b):
                return f"({self.write(a, inner)} {'=' if op == '==' else '≤' if op == '<=' else op} {self.write(b, inner)})"
            case Past(op, parts):
                return f"{op}({', '.join(self.write(part, inner) for part in parts)})"
            case _:
                assert_never(term)
