"""Values of terms along known runs, one column for each term. Columns of the unchanged machine are used for all its mutants.

A mutant shares nearly all of its terms with the machine (`Canon`). A term that contains the wrong one is evaluated again only in
the rows in which one of its parts has another value. The numbers are exact, as in the interpreter.
"""

from __future__ import annotations

import operator
from array import array
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import compress
from typing import TYPE_CHECKING, Any, TypeAlias, assert_never

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
    NumVar,
    Or,
    Past,
    Sub,
    Truth,
    Value,
    Var,
)
from safeloc.language.terms import children, in_order

Row = tuple[Value, ...]
_Column: TypeAlias = Sequence[int]
"""One value per row: truth values as bytes 0 and 1, numbers as 64-bit integers, or as a list if one does not fit."""
_COMPARED: Mapping[str, Callable[[Any, Any], Any]] = {"<": operator.lt, "<=": operator.le, "==": operator.eq}
_OF_TWO: Mapping[type[Expr], Callable[[Any, Any], Any]] = {
    Add: operator.add,
    Sub: operator.sub,
    Mul: operator.mul,
    Min: min,
    Max: max,
}
_TURNED = bytes([1, 0]) + bytes(254)


Along: TypeAlias = tuple[Sequence[Row], Sequence[Row]]
"""The states of a path, and the inputs of the steps between them."""


Pair: TypeAlias = tuple[Expr, Expr]
"""A term of the mutant, and the term of the machine that it replaces."""


class Columns:
    """The columns of terms over state and inputs. A row is a state with the inputs of its step; paths follow one another.

    The last state of a path has no inputs, so the value of a term that reads inputs is meaningless there.
    """

    def __init__(self, state: Sequence[Var], inputs: Sequence[Var], paths: Sequence[Along]) -> None:
        nothing = tuple(0 for _ in inputs)
        states = [row for before, _ in paths for row in before]
        told = [row for before, rows in paths for row in _as_many(rows, len(before), nothing)]
        self._length = len(states)
        self._kept: dict[Expr, _Column] = {}
        self._ends: list[tuple[int, int]] = []
        begin = 0
        for before, _ in paths:
            self._ends.append((begin, begin + len(before)))
            begin += len(before)
        for variables, rows in ((state, states), (inputs, told)):
            for number, var in enumerate(variables):
                self._kept[var] = _column(var, [row[number] for row in rows])

    def keep(self, terms: Iterable[Expr]) -> None:
        """Compute and store the columns of these terms, and of all their parts."""
        self._make(terms, self._kept)

    def first_different(self, moves: Iterable[Pair], goods: Iterable[Pair]) -> list[int | None]:
        """Return for each path the number of steps before the first difference; None for a path without one.

        moves  next values, which decide the state after the row; the last row of a path does not count
        goods  claims, which are compared in every row
        """
        seen = _Differences(self)
        moved, broken = (sorted({row for pair in pairs for row in seen.of(*pair)}) for pairs in (moves, goods))
        return [_least(moved, broken, begin, end) for begin, end in self._ends]

    def column(self, term: Expr, besides: dict[Expr, _Column]) -> _Column:
        """Return the column of a term; columns that are not stored yet are computed into `besides`."""
        self._make([term], besides)
        found = self._kept.get(term)
        return besides[term] if found is None else found

    def _make(self, terms: Iterable[Expr], besides: dict[Expr, _Column]) -> None:
        def of(part: Expr) -> _Column:
            return besides[part] if part in besides else self._kept[part]

        for node in in_order(terms, self._kept):
            if node not in besides:
                besides[node] = _column(node, _values(node, of, self._length))


class _Differences:
    """The rows in which a term of a mutant differs from that of the machine, with the new values.

    Terms of the same kind are compared part by part: they are evaluated only in rows in which a part differs.
    """

    def __init__(self, known: Columns) -> None:
        self._known = known
        self._besides: dict[Expr, _Column] = {}
        self._found: dict[Pair, dict[int, Value]] = {}

    def of(self, now: Expr, was: Expr) -> Mapping[int, Value]:
        """Return the new value for each row in which it differs."""
        waiting: list[Pair] = [(now, was)]
        while waiting:
            pair = waiting[-1]
            before = [part for part in _parts(*pair) if part not in self._found]
            if before:
                waiting += before
            else:
                waiting.pop()
                if pair not in self._found:
                    self._found[pair] = self._worked_out(*pair)
        return self._found[now, was]

    def _worked_out(self, now: Expr, was: Expr) -> dict[int, Value]:
        if now is was:
            return {}
        old = self._known.column(was, self._besides)
        parts = _parts(now, was)
        if not parts:
            new = self._known.column(now, self._besides)
            return {row: new[row] for row in compress(range(len(new)), map(operator.ne, new, old))}
        rows = sorted(set().union(*(self._found[part] for part in parts)))
        some = {part: self._in_rows(part, other, rows) for part, other in parts}
        values = _values(now, some.__getitem__, len(rows))
        return {row: value for row, value in zip(rows, values, strict=True) if value != old[row]}

    def _in_rows(self, now: Expr, was: Expr, rows: Sequence[int]) -> _Column:
        changed, old = self._found[now, was], self._known.column(was, self._besides)
        values = [changed[row] if row in changed else old[row] for row in rows]
        return bytes(values) if isinstance(now, Bool) else values


def _parts(now: Expr, was: Expr) -> list[Pair]:
    """Return the pairs of parts of two terms with the same operator; none for other terms, or without parts."""
    if now is was or type(now) is not type(was):
        return []
    match now, was:
        case Compare(op, _, _), Compare(other, _, _) if op != other:
            return []
        case FloorDiv(_, divisor, _), FloorDiv(_, other_divisor, _) if divisor != other_divisor:
            return []
    new, old = children(now), children(was)
    return [*zip(new, old, strict=True)] if len(new) == len(old) else []


def _as_many(rows: Sequence[Row], length: int, nothing: Row) -> list[Row]:
    return [*rows[:length], *[nothing] * (length - len(rows))]


def _least(moved: Sequence[int], broken: Sequence[int], begin: int, end: int) -> int | None:
    """Return the first of these rows on a path, counted from its beginning; its last row has no step and cannot move."""
    first = [*_first_within(moved, begin, end - 1), *_first_within(broken, begin, end)]
    return min(first) - begin if first else None


def _first_within(rows: Sequence[int], begin: int, end: int) -> Sequence[int]:
    place = bisect_left(rows, begin)
    return [row for row in rows[place : place + 1] if row < end]


def _column(node: Expr, values: Iterable[Any]) -> _Column:
    if isinstance(node, Bool):
        return bytes(values)
    listed = list(values)
    try:
        return array("q", listed)
    except OverflowError:
        return listed


def _values(node: Expr, of: Callable[[Expr], Any], length: int) -> Iterable[Any]:
    """Return the value of a node in each row, computed from the columns of its parts."""
    if TYPE_CHECKING:
        assert isinstance(node, Node)
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
    """Return the and (or the or) of columns of truth values, each taken as one large integer."""
    joined = int.from_bytes(columns[0], "little")
    for column in columns[1:]:
        joined = join(joined, int.from_bytes(column, "little"))
    return joined.to_bytes(length, "little")
