"""Names of terms in generated code: which terms have a name, and which need one before they are used."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from safeloc.codegen.merge_choices import is_magnitude
from safeloc.language.nodes import Expr, Lit, Max, Min, Truth, Var
from safeloc.language.terms import children

_LONGEST_INLINE = 12


@dataclass(frozen=True)
class Text:
    """A piece of generated code, with the names that it reads or calls."""

    code: str
    uses: frozenset[str] = frozenset()

    def within(self, before: str, after: str = "") -> Text:
        """Return the text with more code before and after it, which reads no names."""
        return Text(f"{before}{self.code}{after}", self.uses)


class Writing(ABC):
    """Writes terms in one language; `named` holds the terms that have a name."""

    def __init__(self, names: Mapping[Var, str]) -> None:
        self.named: dict[Expr, str] = dict[Expr, str](names.items())
        self._uses: set[str] = set()

    def text(self, term: Expr) -> Text:
        """Return the term as an expression that can stand alone, as a value or as a test."""
        self._uses = set()
        code = self.code(term)
        return Text(code, frozenset(self._uses))

    @abstractmethod
    def code(self, term: Expr) -> str:
        """Return the term's code; implementations pass every name that the code reads or calls through `used`."""

    def used(self, name: str) -> str:
        """Record that the code reads or calls a name, and return the name."""
        self._uses.add(name)
        return name

    def parts(self, node: Expr) -> tuple[Expr, ...]:
        """Return the operands that the node's code contains: for max(x, 0 - x) only x."""
        return (node.left,) if isinstance(node, Max) and is_magnitude(node) else children(node)

    def twice(self, node: Expr) -> tuple[Expr, ...]:
        """Return the operands that the node's code contains twice; none in a language that can name them within an expression."""
        return self.parts(node) if isinstance(node, (Min, Max)) else ()

    def unnamed(self, roots: Iterable[Expr]) -> list[Expr]:
        """Return the nodes below `roots` that are no constants and have no name yet, operands first."""
        seen: set[int] = set()
        order: list[Expr] = []
        stack: list[tuple[Expr, bool]] = [(root, False) for root in roots]
        while stack:
            node, done = stack.pop()
            if done:
                order.append(node)
            elif id(node) not in seen and node not in self.named and not isinstance(node, (Lit, Truth)):
                seen.add(id(node))
                stack.append((node, True))
                stack.extend((part, False) for part in self.parts(node))
        return order

    def awaited(self, term: Expr) -> list[Expr]:
        """Return the sub-terms that need a name before the term is written: used twice, contained twice, or nested too deep."""
        return [node for node in self.repeated([term]) if node is not term]

    def repeated(self, roots: Sequence[Expr]) -> list[Expr]:
        """Return the terms that need a name before all of `roots` are written one after another, operands first."""
        below = self.unnamed(roots)
        uses = Counter([*roots, *(part for node in below for part in self.parts(node))])
        twice = {node for node, count in uses.items() if count > 1}
        depth: dict[Expr, int] = {}
        for node in below:
            twice.update(self.twice(node))
            depth[node] = 1 + max((depth.get(part, 0) for part in self.parts(node)), default=0)
            if depth[node] > _LONGEST_INLINE:
                twice.add(node)
                depth[node] = 0
        return [node for node in below if node in twice]


CHOICE, OR, AND, COMPARED, SUM, PRODUCT, UNARY, ATOM = range(8)
"""Precedences of operators: CHOICE binds least, ATOM most."""


class Bracketing(Writing):
    """Writes terms of a language in which an operand stands in brackets if its operator binds less than its user's."""

    def code(self, term: Expr) -> str:
        """Return the term as an expression that can stand alone, as a value or as a test."""
        return self._written(term)[0]

    @abstractmethod
    def _written(self, term: Expr) -> tuple[str, int]:
        """Return the term's text, and the precedence of its outermost operator."""

    def _part(self, term: Expr, least: int) -> str:
        """Return the term as an operand, in brackets if its precedence is below `least`."""
        text, firmness = self._written(term)
        return text if firmness >= least else f"({text})"
