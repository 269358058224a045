"""Values of terms along known runs, a column a term: what was worked out for the machine as it is serves every mutant of it.

A mutant shares nearly all of its terms with the machine (`Canon`), so that only what is above the wrong term is worked out anew. The
numbers are exact, as in the interpreter.
"""

from __future__ import annotations

import operator
from array import array
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeAlias, assert_never

from safeloc.language.nodes import (
    Add,
    And,
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
    NumVar,
    Or,
    Past,
    Sub,
    Truth,
    Value,
    Var,
)
from safeloc.language.terms import in_order

Row = tuple[Value, ...]
Column: TypeAlias = Sequence[int]
"""A value a row: truth values as bytes 0 and 1, numbers as 64 bits each, or as they are where these do not hold them."""
_COMPARED: Mapping[str, Callable[[Any, Any], Any]] = {"<": operator.lt, "<=": operator.le, "==": operator.eq}
_OF_TWO: Mapping[type[Expr], Callable[[Any, Any], Any]] = {
    Add: operator.add,
    Sub: operator.sub,
    Mul: operator.mul,
    Min: min,
    Max: max,
}
_TURNED = bytes([1, 0]) + bytes(254)


class Columns:
    """Terms over a state and the inputs that come in it, along paths that stand one behind the other.

    The last state of a path has no inputs: what stands there of a term that reads inputs means nothing.
    """

    def __init__(
        self, state: Sequence[Var], inputs: Sequence[Var], paths: Sequence[tuple[Sequence[Row], Sequence[Row]]]
    ) -> None:
        nothing = tuple(0 for _ in inputs)
        states = [row for before, _ in paths for row in before]
        told = [row for before, rows in paths for row in _as_many(rows, len(before), nothing)]
        self._kept: dict[Expr, Column] = {}
        self._length = len(states)
        self._ends: list[tuple[int, int]] = []
        begin = 0
        for before, _ in paths:
            self._ends.append((begin, begin + len(before)))
            begin += len(before)
        for own, rows in ((state, states), (inputs, told)):
            for number, var in enumerate(own):
                self._kept[var] = _column(var, [row[number] for row in rows])

    def keep(self, terms: Iterable[Expr]) -> None:
        """Work out the columns of these terms, and of all below them, for good."""
        self._made(terms, self._kept)

    def first_different(self, moves: Mapping[Var, Expr], goods: Sequence[Expr]) -> list[int | None]:
        """By path, before which step something is otherwise; None where nothing is.

        moves  variable of the state -> term: otherwise where it does not give what the next state has there
        goods  otherwise where one of them does not hold
        """
        found: dict[Expr, Column] = {}
        self._made([*moves.values(), *goods], found)
        moved = [self._moved(self._kept[var], self._of(term, found)) for var, term in moves.items()]
        broken = [bytes(self._of(term, found)).translate(_TURNED) for term in goods]
        return [_least(moved, broken, begin, end) for begin, end in self._ends]

    def _moved(self, was: Column, term: Column) -> bytes:
        """Where the term does not give the value that stands one row further down."""
        return bytes(map(operator.ne, term, was[1:]))

    def _of(self, term: Expr, found: Mapping[Expr, Column]) -> Column:
        column = found.get(term)
        return self._kept[term] if column is None else column

    def _made(self, terms: Iterable[Expr], found: dict[Expr, Column]) -> None:
        for node in in_order(terms, self._kept):
            found[node] = _column(node, _values(node, lambda part: self._of(part, found), self._length))


def _as_many(rows: Sequence[Row], length: int, nothing: Row) -> list[Row]:
    return [*rows[:length], *[nothing] * (length - len(rows))]


def _least(moved: Sequence[bytes], broken: Sequence[bytes], begin: int, end: int) -> int | None:
    """The first row of a path that is marked; its last state does not move."""
    found = [one.find(1, begin, end - 1) for one in moved] + [one.find(1, begin, end) for one in broken]
    return min((place - begin for place in found if place >= 0), default=None)


def _column(node: Expr, values: Iterable[Any]) -> Column:
    if isinstance(node, (Truth, BoolVar, Not, And, Or, ChooseBool, Compare)):
        return bytes(values)
    listed = list(values)
    try:
        return array("q", listed)
    except OverflowError:
        return listed


def _values(node: Node, of: Callable[[Expr], Any], length: int) -> Iterable[Any]:
    """The value of a node in each row, from those of its parts."""
    match node:
        case Lit(value, _) | Truth(value):
            return [value] * length
        case Add(a, b) | Sub(a, b) | Mul(a, b) | Min(a, b) | Max(a, b):
            return map(_OF_TWO[type(node)], of(a), of(b))
        case FloorDiv(a, divisor):
            return [value // divisor for value in of(a)]
        case Compare(op, a, b):
            return map(_COMPARED[op], of(a), of(b))
        case Choose(c, a, b, _) | ChooseBool(c, a, b):
            return [then if chosen else other for chosen, then, other in zip(of(c), of(a), of(b), strict=True)]
        case Not(inner):
            return bytes(of(inner)).translate(_TURNED)
        case And(parts):
            return _bits(operator.and_, [of(part) for part in parts], length)
        case Or(parts):
            return _bits(operator.or_, [of(part) for part in parts], length)
        case Past() | NumVar() | BoolVar():
            raise KeyError(f"{node!r} has no value here")
        case _:
            assert_never(node)


def _bits(join: Callable[[int, int], int], columns: Sequence[bytes], length: int) -> bytes:
    """Columns of truth values, joined as two great numbers."""
    joined = int.from_bytes(columns[0], "little")
    for column in columns[1:]:
        joined = join(joined, int.from_bytes(column, "little"))
    return joined.to_bytes(length, "little")
