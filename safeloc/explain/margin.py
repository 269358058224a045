"""The distance of a run from violating a property: the least margin of the inequalities in its term."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.explain.failing_parts import with_outputs
from safeloc.language.expr import Bool, Expr, Lit, Num
from safeloc.language.interpret import Program, start, step
from safeloc.language.nodes import And, Compare, Not, Or, Value
from safeloc.language.render import infix
from safeloc.language.spec import Property, step_reading
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration

_LONGEST = 200


@dataclass(frozen=True)
class Margin:
    """The least distance of an inequality to its violation, in its unit; 0 still holds.

    step    the first step after which it is so small
    values  of the two sides, by name
    """

    margin: int
    unit: str
    step: int
    text: str
    values: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class _Inequality:
    """A comparison that has to be as `wanted` wherever none of the conditions holds."""

    compare: Compare
    wanted: bool
    unless: tuple[tuple[Bool, bool], ...]

    def margin(self, known: Mapping[Expr, Value]) -> int | None:
        """Return by how much it holds; None where nothing is required."""
        if any(bool(known[term]) == value for term, value in self.unless):
            return None
        left, right = int(known[self.compare.left]), int(known[self.compare.right])
        strict = self.compare.op == "<"
        return right - left - strict if self.wanted else left - right - (not strict)


def least_margin(trace: Trace, prop: Property) -> Margin | None:
    """Return the least margin over the steps of a run that does not violate the property; None if there is no inequality."""
    prop, names = with_outputs(trace.system, prop)
    found = list(_inequalities(prop.term, wanted=True, unless=()))
    terms = list(dict.fromkeys(term for one in found for term in _read(one)))
    least: tuple[int, int, _Inequality, Mapping[Expr, Value]] | None = None
    for number, known in enumerate(_values(trace, prop, terms), 1) if found else ():
        for one in found:
            margin = one.margin(known)
            if margin is not None and (least is None or margin < least[0]):
                least = margin, number, one, known
    return None if least is None else _as_margin(names, *least)


def _as_margin(
    names: Mapping[Expr, str], margin: int, number: int, one: _Inequality, known: Mapping[Expr, Value]
) -> Margin:
    term = one.compare if one.wanted else ~one.compare
    sides = [side for side in (one.compare.left, one.compare.right) if not isinstance(side, Lit)]
    values = {infix(side, _LONGEST, names): str(known[side]) for side in sides}
    return Margin(margin, one.compare.left.unit.name, number, infix(term, _LONGEST, names), values)


def _read(one: _Inequality) -> list[Expr]:
    return [one.compare.left, one.compare.right, *(term for term, _ in one.unless)]


def _inequalities(term: Bool, *, wanted: bool, unless: tuple[tuple[Bool, bool], ...]) -> Iterator[_Inequality]:
    """Yield the inequalities that have to hold in every step, each with what frees it."""
    match term:
        case Not(inner):
            yield from _inequalities(inner, wanted=not wanted, unless=unless)
        case Compare(op="<" | "<=", left=Num(unit=unit)) if not isinstance(unit, Enumeration):
            yield _Inequality(term, wanted, unless)
        case And(parts) | Or(parts) if isinstance(term, And) == wanted:
            for part in parts:
                yield from _inequalities(part, wanted=wanted, unless=unless)
        case And(parts) | Or(parts):
            yield from _of_alternatives(parts, wanted=wanted, unless=unless)
        case _:
            pass


def _of_alternatives(
    parts: Sequence[Bool], *, wanted: bool, unless: tuple[tuple[Bool, bool], ...]
) -> Iterator[_Inequality]:
    """Yield those of the last alternative: the others free it. An implication is such: its condition comes first."""
    *others, last = parts
    yield from _inequalities(last, wanted=wanted, unless=(*unless, *((part, wanted) for part in others)))


def _values(trace: Trace, prop: Property, terms: Sequence[Expr]) -> Iterator[Mapping[Expr, Value]]:
    """Yield the values of terms of the property after each step."""
    reading = step_reading(trace.system, prop)
    system = reading.system
    program = Program([reading.of[term] for term in terms])
    state = start(system, {var.name: trace.initial[var.name] for var in trace.system.state})
    for one in trace.steps:
        inputs = {var: one.inputs[var.name] for var in system.inputs}
        yield dict(zip(terms, program({**state, **inputs}), strict=True))
        state = step(system, state, inputs)[0]
