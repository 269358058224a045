"""Terms written in full, whatever their size: parts that occur more than once are named and written once.

A term is a graph. As single lines of text, the updates of a machine would fill books; shortened, they would be no evidence.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.nodes import BoolVar, Expr, Lit, NumVar, Truth
from safeloc.language.render import infix
from safeloc.language.terms import Sharing, children, in_order

_UNBOUNDED = 10**9
_A_FEW_LINES = 600
_SHORT = 24
"""A part of at most so many characters is not named, but written in place."""


@dataclass(frozen=True)
class Line:
    """A named part of a term."""

    name: str
    text: str


class Exact:
    """The given terms as text; `lines` are the named parts, each before its first use."""

    def __init__(self, terms: Mapping[str, Expr], definitions: Mapping[str, Expr]) -> None:
        share = Sharing()
        given = {share(term): name for name, term in definitions.items()}
        roots = [share(term) for term in terms.values()]
        order = in_order([*given, *roots])
        uses = Counter(id(child) for child in (*roots, *(child for node in order for child in children(node))))
        self._given = given
        self._share = share
        self._names: dict[Expr, str] = {}
        lines: list[Line] = []
        for node in order:
            if isinstance(node, (Lit, NumVar, BoolVar, Truth)) or (node not in given and uses[id(node)] < 2):
                continue
            text = infix(node, _UNBOUNDED, self._names, deepest=_UNBOUNDED)
            if node in given or len(text) > _SHORT:
                self._names[node] = given.get(node, f"#{len(lines) + 1}")
                lines.append(Line(self._names[node], text))
        self.lines = tuple(lines)
        self.texts = {
            name: infix(root, _UNBOUNDED, self._names, deepest=_UNBOUNDED)
            for name, root in zip(terms, roots, strict=True)
        }

    def spelled(self, term: Expr) -> str:
        """Return a term in which only the definitions of the model are named; other parts too if it fills many lines."""
        whole = self._share(term)
        text = infix(whole, _A_FEW_LINES, self._given, deepest=_UNBOUNDED)
        return infix(whole, _UNBOUNDED, self._names, deepest=_UNBOUNDED) if text.endswith("…") else text
