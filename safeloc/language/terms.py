"""Functions over terms: traversal in order, variables, rewriting, sharing of equal parts, and text."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from operator import attrgetter
from typing import TYPE_CHECKING, Any, assert_never

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
    Num,
    NumVar,
    Or,
    Past,
    Sub,
    Truth,
    Var,
    all_of,
    any_of,
)


def children(node: Expr) -> tuple[Expr, ...]:
    """Return the operands of a node."""
    return CHILDREN[type(node)](node)


def _none(_: Expr) -> tuple[Expr, ...]:
    return ()


_OPERANDS, _CHOICE, _PARTS = attrgetter("left", "right"), attrgetter("condition", "then", "other"), attrgetter("parts")
CHILDREN: dict[type[Expr], Callable[[Any], tuple[Expr, ...]]] = {  # a table, since no function is called more often
    **dict.fromkeys((Lit, NumVar, Truth, BoolVar), _none),
    **dict.fromkeys((Choose, ChooseBool), _CHOICE),
    **dict.fromkeys((And, Or, Past), _PARTS),
    **dict.fromkeys((Compare, Add, Sub, Max, Min, Mul), _OPERANDS),
    Not: lambda node: (node.inner,),
    FloorDiv: lambda node: (node.left,),
}


def in_order(roots: Iterable[Expr], done: Container[Expr] = frozenset()) -> list[Node]:
    """Return every node below `roots` once, operands first; without recursion, so that terms may be deep.

    done  nodes to leave out, with all nodes below them
    """
    return [node for node, _ in _with_parts(roots, done)]


def _with_parts(roots: Iterable[Expr], done: Container[Expr]) -> list[tuple[Node, tuple[Expr, ...]]]:
    """Return every node below `roots` once, operands first, each node with its operands."""
    seen: set[Expr] = set()
    order: list[Any] = []
    stack: list[Any] = [*reversed(list(roots))]
    below = CHILDREN
    while stack:
        node = stack.pop()
        kind = type(node)
        if kind is tuple:  # a node whose operands were pushed before: all of them are done
            order.append(node)
        elif node not in seen and node not in done:
            seen.add(node)
            parts = below[kind](node)
            if parts:
                stack.append((node, parts))
                stack += parts[::-1]
            else:
                order.append((node, parts))
    return order


def conjuncts(term: Bool) -> Iterator[Bool]:
    """Yield the parts of nested conjunctions, in order; the term itself if it is no conjunction."""
    stack = [term]
    while stack:
        part = stack.pop()
        if isinstance(part, And):
            stack.extend(reversed(part.parts))
        else:
            yield part


def variables(roots: Iterable[Expr]) -> list[Var]:
    """Return the distinct variables below `roots`, in order of first use."""
    return [node for node in in_order(roots) if isinstance(node, Var)]


class Substitution:
    """Replaces variables by terms; shared sub-terms stay shared across all terms to which it is applied.

    terms  pairs of a term and its replacement: such a term is replaced as a unit, and its parts are not visited
    """

    def __init__(self, replacements: Mapping[Var, Expr], terms: Iterable[tuple[Expr, Expr]] = ()) -> None:
        self._done: dict[Expr, Expr] = {var: term for var, term in replacements.items()}
        self._done |= dict(terms)

    def num(self, term: Num) -> Num:
        """Return the numeric term after replacement."""
        result = self(term)
        assert isinstance(result, Num)
        return result

    def bool(self, term: Bool) -> Bool:
        """Return the truth-valued term after replacement."""
        result = self(term)
        assert isinstance(result, Bool)
        return result

    def __call__(self, term: Expr) -> Expr:
        """Return the term after replacement."""
        done = self._done
        for node, parts in _with_parts([term], done):
            done[node] = _made_of(node, parts, tuple([done[part] for part in parts]))
        return done[term]


class Sharing:
    """Makes equal sub-terms the same node, so that every back end computes each of them once."""

    def __init__(self) -> None:
        self._kept: dict[tuple[object, ...], Expr] = {}
        self._done: dict[Expr, Expr] = {}

    def __call__(self, term: Expr) -> Expr:
        """Return the term with equal parts shared, also with all terms of earlier calls."""
        done = self._done
        for node, parts in _with_parts([term], done):
            now = tuple([done[part] for part in parts])
            shape = _shape(node, now)
            kept = self._kept.get(shape)
            if kept is None:  # otherwise an equal node exists already, and no other one is made
                kept = _made_of(node, parts, now)
                if kept is not node:
                    shape = _shape(kept, children(kept))
                kept = self._kept.setdefault(shape, kept)
            done[node] = done[kept] = kept
        return done[term]

    def num(self, term: Num) -> Num:
        """Return the numeric term with equal parts shared."""
        return numeric(self(term))

    def bool(self, term: Bool) -> Bool:
        """Return the truth-valued term with equal parts shared."""
        return logical(self(term))


def alike(left: Expr, right: Expr) -> bool:
    """Return whether two terms have the same structure; variables are compared by identity, values before the step by
    the variable that they belong to."""
    share = Sharing()
    twins: dict[Var, Expr] = {}
    for var in variables([left, right]):
        if var.before is not None:
            twins[var] = next((twin for twin in twins if twin.before is var.before), var)
    settle = Substitution(twins)
    return share(settle(left)) is share(settle(right))


def _shape(term: Expr, parts: tuple[Expr, ...]) -> tuple[object, ...]:
    """Return the key of a node: two nodes with shared parts are equal exactly if their keys are."""
    if TYPE_CHECKING:
        assert isinstance(term, Node)
    match term:
        case Choose() | ChooseBool() | And() | Or() | Add() | Sub() | Not() | Max() | Min() | Mul():
            return (type(term), *map(id, parts))
        case NumVar() | BoolVar():
            return (id(term),)
        case Lit(value, unit):
            return (Lit, value, unit)
        case Compare(op, _, _) | Past(op, _):
            return (type(term), op, *map(id, parts))
        case Truth(value):
            return (Truth, value)
        case FloorDiv(_, divisor, unit):
            return (FloorDiv, divisor, unit, *map(id, parts))
        case _:
            assert_never(term)


def _made_of(node: Node, parts: tuple[Expr, ...], now: tuple[Expr, ...]) -> Expr:
    """Return the node with the operands `now` in place of `parts`; the node itself if they are the same."""
    return node if [*map(id, now)] == [*map(id, parts)] else rebuilt(node, now)


def rebuilt(node: Node, parts: tuple[Expr, ...]) -> Expr:
    """Return the node with other operands of the same kinds; the node itself if they are the same."""
    if [*map(id, parts)] == [*map(id, children(node))]:
        return node
    match node:
        case Choose():
            return Choose(logical(parts[0]), numeric(parts[1]), numeric(parts[2]), node.unit)
        case And():
            return all_of(logical(part) for part in parts)
        case Compare(op, _, _):
            return Compare(op, numeric(parts[0]), numeric(parts[1]))
        case ChooseBool():
            return ChooseBool(logical(parts[0]), logical(parts[1]), logical(parts[2]))
        case Add() | Sub() | Max() | Min() | Mul():
            return type(node)(numeric(parts[0]), numeric(parts[1]), node.unit)
        case Or():
            return any_of(logical(part) for part in parts)
        case Not():
            return ~logical(parts[0])
        case FloorDiv(_, divisor, unit):
            return FloorDiv(numeric(parts[0]), divisor, unit)
        case Past(op, _):
            return Past(op, tuple(logical(part) for part in parts))
        case Lit() | NumVar() | Truth() | BoolVar():
            return node
        case _:
            assert_never(node)


def numeric(term: Expr) -> Num:
    """Return the term itself, which has to be a number."""
    assert isinstance(term, Num)
    return term


def logical(term: Expr) -> Bool:
    """Return the term itself, which has to be a truth value."""
    assert isinstance(term, Bool)
    return term


def text(term: Expr, most: int = 200) -> str:
    """Return an S-expression of the term, with "..." after `most` nodes, since it writes shared parts out each time."""
    return _Writer(most).write(term)


class _Writer:
    def __init__(self, most: int) -> None:
        self._left = most

    def write(self, term: Expr) -> str:
        self._left -= 1
        if self._left < 0:
            return "..."
        parts = children(term)
        return f"({_head(term)} {' '.join(self.write(part) for part in parts)}{_tail(term)})" if parts else _head(term)


def _head(term: Expr) -> str:
    assert isinstance(term, Node)
    match term:
        case Lit():
            return term.label
        case NumVar(name=name) | BoolVar(name=name):
            return name
        case Truth(value):
            return "true" if value else "false"
        case Compare(op, _, _) | Past(op, _):
            return op
        case Add() | Sub() | Mul() | FloorDiv() | Min() | Max() | Choose() | ChooseBool() | Not() | And() | Or():
            return _WORDS[type(term)]
        case _:
            assert_never(term)


def _tail(term: Expr) -> str:
    return f" {term.divisor}" if isinstance(term, FloorDiv) else ""


_WORDS: dict[type[Expr], str] = {
    Add: "+",
    Sub: "-",
    Mul: "*",
    FloorDiv: "floor_div",
    Min: "min",
    Max: "max",
    Choose: "ite",
    ChooseBool: "ite",
    Not: "not",
    And: "and",
    Or: "or",
}
