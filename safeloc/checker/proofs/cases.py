"""Validity by exhaustive cases: every truth value, and every position of every linear form relative to its bounds.

The forms count as independent of each other, so the check covers more cases than can occur: every claim found valid is valid.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, floor

from safeloc.checker.proofs.polynomials import (
    Direction,
    Polynomial,
    as_constant,
    constant,
    direction,
    minus,
    polynomial,
    single,
)
from safeloc.checker.proofs.terms import Term

MOST_TERMS = 200_000  # evaluated in all cases of one claim together: about a second
Bound = tuple[Fraction | float, int]  # (v, -1): below v; (v, 0): v itself; (v, 1): above v
Interval = tuple[Bound, Bound]
_EVERYTHING: Interval = ((float("-inf"), 0), (float("inf"), 0))
_SIGNS: Mapping[str, frozenset[int]] = {
    "<": frozenset({-1}),
    "<=": frozenset({-1, 0}),
    "=": frozenset({0}),
    "distinct": frozenset({-1, 1}),
    ">=": frozenset({0, 1}),
    ">": frozenset({1}),
}


@dataclass(frozen=True)
class _World:
    """One case: the truth values and the intervals of linear forms that are decided in it."""

    truths: Mapping[Term, bool] = field(default_factory=dict)
    places: Mapping[Direction, Interval] = field(default_factory=dict)


class _Open(Exception):
    """The evaluation of a case needs a decision: the case has to be split into these."""

    def __init__(self, worlds: Iterable[_World]) -> None:
        super().__init__()
        self.worlds = list(worlds)


def valid(claim: Term, premises: Collection[Term] = (), opaque: Collection[Term] = ()) -> bool:
    """Return whether the claim is shown to follow from the premises for any meaning of the opaque terms."""
    waiting, left = [_World()], MOST_TERMS
    hidden = frozenset(opaque)
    while waiting:
        reading = _Reading(hidden, waiting.pop(), left)
        try:
            if not reading.true(claim) and all(map(reading.true, premises)):
                return False
        except _Open as question:
            waiting += question.worlds
        except (_Exhausted, RecursionError):
            return False
        left = reading.left
    return True


class _Exhausted(Exception):
    """The limit of evaluated terms is exceeded."""


class _Reading:
    """The evaluation of terms in one case: opaque terms count as variables, and each term is evaluated once."""

    def __init__(self, opaque: frozenset[Term], world: _World, left: int) -> None:
        self.opaque, self.world, self.left = opaque, world, left
        self.truths: dict[Term, bool] = {}
        self.forms: dict[Term, Polynomial] = {}

    def true(self, term: Term) -> bool:
        """Return the truth value in this case; raise _Open if it is not decided."""
        if term not in self.truths:
            self._count()
            self.truths[term] = _decided(term, self.world) if term in self.opaque else self._truth(term)
        return self.truths[term]

    def _count(self) -> None:
        self.left -= 1
        if self.left < 0:
            raise _Exhausted

    def _truth(self, term: Term) -> bool:
        args = term.args
        match term.op:
            case "true" | "false":
                return term.op == "true"
            case "not":
                return not self.true(args[0])
            case "and":
                return all(map(self.true, args))
            case "or":
                return any(map(self.true, args))
            case "=>":
                return not self.true(args[0]) or self.true(args[1])
            case "ite":
                return self.true(args[1] if self.true(args[0]) else args[2])
            case "=" | "xor" | "distinct" if args[0].sort == "Bool":
                return (args[0] is args[1] or self.true(args[0]) == self.true(args[1])) == (term.op == "=")
            case op if op in _SIGNS:
                return _compared(minus(self.linear(args[0]), self.linear(args[1])), op, self.world)
            case _:
                return _decided(term, self.world)

    def linear(self, term: Term) -> Polynomial:
        """Return the polynomial of a term in this case, with every choice decided."""
        return polynomial(term, self._leaf, self.opaque)

    def _leaf(self, term: Term) -> Polynomial:
        if term not in self.forms:
            self._count()
            self.forms[term] = self._form(term)
        return self.forms[term]

    def _form(self, term: Term) -> Polynomial:
        if term.op == "ite":
            return self.linear(term.args[1] if self.true(term.args[0]) else term.args[2])
        if term.op in _FOLDED:
            values = [as_constant(self.linear(arg)) for arg in term.args]
            known = [value for value in values if value is not None]
            if len(known) == len(values) and (folded := _FOLDED[term.op](known)) is not None:
                return constant(folded)
        return single(term)


def _divided(values: list[Fraction]) -> Fraction | None:
    """Return the quotient as in SMT-LIB, where the remainder is never negative; None for a division by 0."""
    value, by = values
    if not by:
        return None
    return Fraction(floor(value / by) if by > 0 else ceil(value / by))


def _remainder(values: list[Fraction]) -> Fraction | None:
    quotient = _divided(values)
    return None if quotient is None else values[0] - quotient * values[1]


_FOLDED: Mapping[str, Callable[[list[Fraction]], Fraction | None]] = {
    "div": _divided,
    "div_total": _divided,
    "mod": _remainder,
    "mod_total": _remainder,
    "to_int": lambda values: Fraction(floor(values[0])),
    "abs": lambda values: abs(values[0]),
}


def _decided(term: Term, world: _World) -> bool:
    if term not in world.truths:
        raise _Open(_World({**world.truths, term: truth}, world.places) for truth in (False, True))
    return world.truths[term]


def _compared(part: Polynomial, op: str, world: _World) -> bool:
    """Return whether the comparison of the polynomial with 0 holds; raise _Open if it is not decided."""
    value = as_constant(part)
    if value is not None:
        return (value > 0) - (value < 0) in _SIGNS[op]
    line, factor, rest = direction(part)
    bound, turn = -rest / factor, 1 if factor > 0 else -1
    places = [
        (place, turn * sign in _SIGNS[op])
        for place, sign in _places(bound, line.integer, world.places.get(line, _EVERYTHING))
    ]
    truths = {truth for _, truth in places}
    if len(truths) == 1:
        return truths.pop()
    raise _Open(_World(world.truths, {**world.places, line: place}) for place, _ in places)


def _places(bound: Fraction, integer: bool, within: Interval) -> list[tuple[Interval, int]]:
    """Return the non-empty parts of the interval below, at and above the bound, each with its sign relative to the bound."""
    low, high = within
    below: Bound = (Fraction(ceil(bound) - 1), 0) if integer else (bound, -1)
    above: Bound = (Fraction(floor(bound) + 1), 0) if integer else (bound, 1)
    cut: list[tuple[Interval, int]] = [((low, min(high, below)), -1), ((max(low, above), high), 1)]
    if not integer or bound.denominator == 1:
        cut.append(((max(low, (bound, 0)), min(high, (bound, 0))), 0))
    return [(place, sign) for place, sign in cut if place[0] <= place[1]]
