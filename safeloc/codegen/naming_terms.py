"""What every generated text has in common: which terms have a name already, and which need one first."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterable, Mapping

from safeloc.codegen.merge_choices import is_magnitude
from safeloc.language.nodes import Expr, Lit, Max, Min, Truth, Var
from safeloc.language.terms import children

LONGEST_INLINE = 12


class Writing(ABC):
    """Writes terms in one language; knows which ones have a name."""

    def __init__(self, names: Mapping[Var, str]) -> None:
        self.named: dict[Expr, str] = dict[Expr, str](names.items())

    @abstractmethod
    def text(self, term: Expr) -> str:
        """The term as an expression that may stand alone, as a value or as a test."""

    def parts(self, node: Expr) -> tuple[Expr, ...]:
        """What is written where the node is: of max(x, 0 - x) only x."""
        return (node.left,) if isinstance(node, Max) and is_magnitude(node) else children(node)

    def twice(self, node: Expr) -> tuple[Expr, ...]:
        """Parts that the node's text holds twice; a language that can name them in passing has none."""
        return self.parts(node) if isinstance(node, (Min, Max)) else ()

    def unnamed(self, roots: Iterable[Expr]) -> list[Expr]:
        """Nodes below `roots` that are no constants and have no name yet, parts before wholes."""
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
        """What must get a name before the term is written: what it uses twice, compares twice, or nests too deep."""
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
