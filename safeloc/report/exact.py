"""Terms written in full, whatever their size: parts that occur more than once are named and written once.

A term is a graph. As single lines of text, the updates of a machine would fill books; shortened, they would be no evidence.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count, product
from string import ascii_lowercase

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
    """The given terms as text; `lines` are the named parts, each before its first use.

    names   for parts to which `definitions` gives no name; by default #1, #2, ...
    """

    def __init__(
        self, terms: Mapping[str, Expr], definitions: Mapping[str, Expr], names: Iterator[str] | None = None
    ) -> None:
        names = numbers() if names is None else names
        share = Sharing()
        given = {share(term): name for name, term in definitions.items()}
        roots = [share(term) for term in terms.values()]
        order = in_order([*given, *roots])
        uses = Counter(id(child) for child in (*roots, *(child for node in order for child in children(node))))
        named: dict[Expr, str] = {}
        lines: list[Line] = []
        for node in order:
            if isinstance(node, (Lit, NumVar, BoolVar, Truth)) or (node not in given and uses[id(node)] < 2):
                continue
            text = infix(node, _UNBOUNDED, named, deepest=_UNBOUNDED)
            if node in given or len(text) > _SHORT:
                named[node] = given[node] if node in given else next(names)
                lines.append(Line(named[node], text))
        self.lines = tuple(lines)
        self.texts = {
            name: infix(root, _UNBOUNDED, named, deepest=_UNBOUNDED) for name, root in zip(terms, roots, strict=True)
        }


def spelled_alone(terms: Sequence[Expr], definitions: Mapping[str, Expr]) -> tuple[list[str], tuple[Line, ...]]:
    """Return terms in full with the named parts that they use; parts that the model does not name are a, b, c, ...

    Nothing but these lines is needed to read them. A term of a few lines is written without letters.
    """
    share = Sharing()
    shared = [share(term) for term in terms]
    inside = set(in_order(shared))
    own = {name: one for name, one in definitions.items() if share(one) in inside}
    given = {share(one): name for name, one in own.items()}
    exact = Exact({str(number): term for number, term in enumerate(terms)}, own, letters(shared))
    found = [infix(term, _A_FEW_LINES, given, deepest=_UNBOUNDED) for term in shared]
    found = [exact.texts[str(number)] if text.endswith("…") else text for number, text in enumerate(found)]
    return found, _used("\n".join(found), exact.lines)


def _used(text: str, lines: Sequence[Line]) -> tuple[Line, ...]:
    """Return the lines whose names occur in the text, or in a line that is used."""
    used: list[Line] = []
    reading = text
    for line in reversed(lines):  # each part stands before its first use
        if re.search(rf"(?<![\w.]){re.escape(line.name)}(?![\w.])", reading):
            used.append(line)
            reading += f"\n{line.text}"
    return tuple(reversed(used))


def letters(terms: Sequence[Expr]) -> Iterator[str]:
    """Yield a, b, c, ..., aa, ab, ... without the names of variables in the terms."""
    taken = {node.name for node in in_order(terms) if isinstance(node, (NumVar, BoolVar))}
    for length in count(1):
        yield from (name for name in map("".join, product(ascii_lowercase, repeat=length)) if name not in taken)


def numbers() -> Iterator[str]:
    """Yield #1, #2, ..."""
    return (f"#{number}" for number in count(1))
