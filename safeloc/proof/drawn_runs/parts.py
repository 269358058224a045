"""Parts of a condition that can be repaired one by one: their conjunction is the condition.

    not there or (near and slow)       ->  not there or near;  not there or slow
    near if there else far             ->  not there or near;  there or far
    |x| <= 3 m                         ->  x <= 3 m;  -x <= 3 m

Where `near` and `slow` are broken, no single value mends the whole; each part is mended by one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import prod

from safeloc.language.expr import Bool
from safeloc.language.nodes import And, ChooseBool, Compare, Max, Min, Not, Or, Truth, any_of

_MOST = 24
"""Parts that one disjunction is split into, at most."""


def falsifiable(term: Bool) -> list[Bool]:
    """Return parts whose conjunction is the term, each once and without those that are always true."""
    return list(dict.fromkeys(part for part in _parts(term) if not (isinstance(part, Truth) and part.value)))


def _parts(term: Bool) -> Iterator[Bool]:
    match term:
        case And(parts):
            for part in parts:
                yield from _parts(part)
        case Or():
            yield from _distributed([list(_parts(part)) for part in _disjuncts(term)])
        case ChooseBool(condition, then, other):
            yield from _parts(any_of((~condition, then)))
            yield from _parts(any_of((condition, other)))
        case Not(inner):
            yield from _negated(inner)
        case Compare("<" | "<=" as op, left, Min(one, two)):
            yield from _parts(Compare(op, left, one))
            yield from _parts(Compare(op, left, two))
        case Compare("<" | "<=" as op, Max(one, two), right):
            yield from _parts(Compare(op, one, right))
            yield from _parts(Compare(op, two, right))
        case _:
            yield term


def _negated(inner: Bool) -> Iterator[Bool]:
    match inner:
        case Or(parts):
            for part in parts:
                yield from _parts(~part)
        case And(parts):
            yield from _parts(any_of(~part for part in parts))
        case ChooseBool(condition, then, other):
            yield from _parts(ChooseBool(condition, ~then, ~other))
        case Compare("<", left, right):
            yield from _parts(Compare("<=", right, left))
        case Compare("<=", left, right):
            yield from _parts(Compare("<", right, left))
        case _:
            yield ~inner


def _disjuncts(term: Bool) -> Iterator[Bool]:
    """Yield the parts of nested disjunctions."""
    match term:
        case Or(parts):
            for part in parts:
                yield from _disjuncts(part)
        case Not(And(parts)):
            for part in parts:
                yield from _disjuncts(~part)
        case Not(Not(inner)):
            yield from _disjuncts(inner)
        case _:
            yield term


def _distributed(parts: Sequence[Sequence[Bool]]) -> Iterator[Bool]:
    """Distribute a disjunction over the conjunctions in it, the longest first; one that makes too many stays together."""
    split = list[int]()
    for place in sorted(range(len(parts)), key=lambda place: -len(parts[place])):
        if prod(len(parts[one]) for one in (*split, place)) <= _MOST:
            split.append(place)
    columns = [part if place in split else [_joined(part)] for place, part in enumerate(parts)]
    for choice in product(*columns):
        yield any_of(one for part in choice for one in _disjuncts(part))


def _joined(parts: Sequence[Bool]) -> Bool:
    return parts[0] if len(parts) == 1 else And(tuple(parts))
