"""Names of terms in generated code: terms that have a name, and terms that need one before they are used."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from safeloc.codegen.merge_choices import is_magnitude
from safeloc.language.nodes import Expr, Lit, Max, Min, Truth, Var
from safeloc.language.terms import children

LONGEST_INLINE = 12


@dataclass(frozen=True)
class Text:
    """Code of the language that is generated, and the names that it reads or calls."""

    code: str
    uses: frozenset[str] = frozenset()

    def within(self, before: str, after: str = "") -> Text:
        """The text between others that read nothing."""
        return Text(f"{before}{self.code}{after}", self.uses)


class Writing(ABC):
    """Writes terms in one language; knows which ones have a name."""

    def __init__(self, names: Mapping[Var, str]) -> None:
        self.named: dict[Expr, str] = dict[Expr, str](names.items())
        self._uses: set[str] = set()

    def text(self, term: Expr) -> Text:
        """The term as an expression that may stand alone, as a value or as a test."""
        self._uses = set()
        code = self.code(term)
        return Text(code, frozenset(self._uses))

    @abstractmethod
    def code(self, term: Expr) -> str:
        """The term's code; it takes every name that it reads or calls from `used`."""

    def used(self, name: str) -> str:
        """The name, which the code being written reads or calls."""
        self._uses.add(name)
        return name

    def parts(self, node: Expr) -> tuple[Expr, ...]:
        """Return the operands as they are written for the node: for max(x, 0 - x) only x."""
        return (node.left,) if isinstance(node, Max) and is_magnitude(node) else children(node)

    def twice(self, node: Expr) -> tuple[Expr, ...]:
        """Return parts that the node's text holds twice; a language that can name them in passing has none."""
        return self.parts(node) if isinstance(node, (Min, Max)) else ()

    def unnamed(self, roots: Iterable[Expr]) -> list[Expr]:
        """Return nodes below `roots` that are no constants and have no name yet, parts before wholes."""
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
        """List the sub-terms that need a name before the term is written: used twice, compared twice, or nested too
        deep."""
        below = self.unnamed([term])
        uses = Counter(part for node in below for part in self.parts(node))
        twice = {node for node, count in uses.items() if count > 1}
        depth: dict[Expr, int] = {}
        for node in below:
            twice.update(self.twice(node))
            depth[node] = 1 + max((depth.get(part, 0) for part in self.parts(node)), default=0)
            if depth[node] > LONGEST_INLINE:
                twice.add(node)
                depth[node] = 0
        return [node for node in below if node in twice and node is not term]
