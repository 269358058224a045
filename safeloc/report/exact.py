"""Terms written out in full, however large: parts that occur more than once are named and written once.

A term is a graph. As one line of text, the updates of a machine would fill books; shortened, they are no evidence.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.nodes import BoolVar, Expr, Lit, NumVar, Truth
from safeloc.language.render import infix
from safeloc.language.terms import Sharing, children, in_order

UNBOUNDED = 10**9
A_FEW_LINES = 600
SHORT = 24
"""A part of no more characters is written where it stands."""


@dataclass(frozen=True)
class Line:
    """`name` stands for `text`."""

    name: str
    text: str


class Exact:
    """Writes the given terms; `lines` are the named parts, each before it is used."""

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
            text = infix(node, UNBOUNDED, self._names, deepest=UNBOUNDED)
            if node in given or len(text) > SHORT:
                self._names[node] = given.get(node, f"#{len(lines) + 1}")
                lines.append(Line(self._names[node], text))
        self.lines = tuple(lines)
        self.texts = {
            name: infix(root, UNBOUNDED, self._names, deepest=UNBOUNDED)
            for name, root in zip(terms, roots, strict=True)
        }

    def spelled(self, term: Expr) -> str:
        """Return the term with nothing but the model's own definitions by name, unless that fills more than a few lines."""
        whole = self._share(term)
        text = infix(whole, A_FEW_LINES, self._given, deepest=UNBOUNDED)
        return infix(whole, UNBOUNDED, self._names, deepest=UNBOUNDED) if text.endswith("…") else text
