"""Terms of a declaration that count as one term: written at one place, in one form.

If a claim and a guard call the same function, each gets nodes of its own, and those of the claim often read the state before the
step. One expression wrote both, so an edit of it changes both. Terms of equal form that are written at different places count as
different: an edit of one does not change the other.
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
    """One term: its place, one of its nodes, all of them, and the roots that contain it."""

    place: Place | None
    node: Expr
    nodes: tuple[Expr, ...]
    roots: tuple[Root, ...]

    @property
    def on_board(self) -> tuple[Root, ...]:
        """The roots that belong to the machine itself."""
        return tuple(root for root in self.roots if root.part in ON_BOARD)

    @property
    def beyond(self) -> tuple[Root, ...]:
        """The roots that belong to the world, the first state, lemmas or claims."""
        return tuple(root for root in self.roots if root.part not in ON_BOARD)


def terms_of(roots: Iterable[Root], places: Places, forms: Forms) -> list[Term]:
    """Return the terms that have parts, in the order of the roots."""
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
    """A numbering of the forms of terms. A rewritten term has the form of its original."""

    def __init__(self, places: Places) -> None:
        self._places = places
        self._numbers: dict[tuple[object, ...], int] = {}
        self._of: dict[Expr, int] = {}

    def of(self, term: Expr) -> _Form:
        """Return the number of the term's form."""
        first = self._places.origin(term)
        for node in in_order([first], self._of):
            key = _key(node, self._of)
            self._of[node] = self._numbers.setdefault(key, len(self._numbers))
        return self._of[first]


def _key(node: Expr, of: Mapping[Expr, int]) -> tuple[object, ...]:
    """Return the key of a form: operator, constants, and the forms of the parts. Reading before the step does not matter."""
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
