"""Terms of a declaration that count as the same term: written at one place, in one form.

A claim that calls the function which a guard calls gets a term of its own, and often one that looks back at the state before
the step. Both are written by the same expression, and an edit of it changes both. Terms of one form that are written
at different places are different terms: an edit of one leaves the other as it is.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from safeloc.assurance.mutation.declared import ON_BOARD, Root
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.source_places import Place
from safeloc.language.nodes import BoolVar, Compare, Expr, FloorDiv, Lit, NumVar, Past, Truth
from safeloc.language.terms import children, in_order

_Form = int
_Key = tuple[Place | None, _Form]


@dataclass(frozen=True, eq=False)
class Term:
    """One term: a node of it to look at, all its nodes, and the roots that it stands below."""

    place: Place | None
    node: Expr
    nodes: tuple[Expr, ...]
    roots: tuple[Root, ...]

    @property
    def on_board(self) -> tuple[Root, ...]:
        """Return the roots of the machine itself."""
        return tuple(root for root in self.roots if root.part in ON_BOARD)

    @property
    def beyond(self) -> tuple[Root, ...]:
        """The roots that the machine is held against."""
        return tuple(root for root in self.roots if root.part not in ON_BOARD)


def terms_of(roots: Iterable[Root], places: Places, forms: Forms) -> list[Term]:
    """The terms of a declaration that are made of others, in the order of the roots."""
    nodes: dict[_Key, dict[Expr, None]] = defaultdict(dict)
    below: dict[_Key, dict[Root, None]] = defaultdict(dict)
    for root in roots:
        for node in in_order([root.term]):
            if children(node):
                key = (places.of(node), forms.of(node))
                nodes[key][node] = None
                below[key][root] = None
    return [Term(key[0], next(iter(nodes[key])), tuple(nodes[key]), tuple(below[key])) for key in nodes]


class Forms:
    """Numbers the forms of terms; a rewritten term has the form of the one that it was rewritten from."""

    def __init__(self, places: Places) -> None:
        self._places = places
        self._numbers: dict[tuple[object, ...], int] = {}
        self._of: dict[Expr, int] = {}

    def of(self, term: Expr) -> _Form:
        """The number of the term's form."""
        first = self._places.origin(term)
        for node in in_order([first], self._of):
            told = _told(node, self._of)
            self._of[node] = self._numbers.setdefault(told, len(self._numbers))
        return self._of[first]


def _told(node: Expr, of: Mapping[Expr, int]) -> tuple[object, ...]:
    """What tells a form from another one."""
    match node:
        case NumVar() | BoolVar():
            return (id(node if node.before is None else node.before),)
        case Lit(value, unit):
            return (Lit, value, unit)
        case Truth(value):
            return (Truth, value)
        case Compare(op, _, _) | Past(op, _):
            return (type(node), op, *(of[part] for part in children(node)))
        case FloorDiv(_, divisor, unit):
            return (FloorDiv, divisor, unit, of[node.left])
        case _:
            return (type(node), *(of[part] for part in children(node)))
