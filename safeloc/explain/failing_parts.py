"""The parts of a property's term that make it fail in a step, each with its value: a tree, from the whole term to what it reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from safeloc.errors import PropertyError
from safeloc.language.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Var
from safeloc.language.interpret import Program, start, step
from safeloc.language.nodes import And, ChooseBool, Compare, Node, Not, Or, Value
from safeloc.language.render import infix
from safeloc.language.spec import Property, StepReading, step_reading
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Sharing, in_order, variables
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration

_LONGEST = 200
"""Most characters of a term."""
_MOST_VALUES = 12
"""Most variables of a comparison whose values are shown."""


@dataclass(frozen=True)
class Part:
    """A part of the term: its depth in the tree, the part as text, whether it holds, and the values that it reads.

    left_out  number of further variables that it reads
    """

    depth: int
    text: str
    holds: bool
    values: Mapping[str, str]
    left_out: int = 0


def failing_parts(trace: Trace, prop: Property) -> list[Part]:
    """Return why the property fails in the last step of the run.

    Of `within`, the parts are those of the response that did not come. Outputs are shown by their names. PropertyError for `reachable`, which no run violates.
    """
    if prop.kind == "reachable":
        raise PropertyError(f"{prop.src}: {prop.name!r} is reachable in some run; no run violates it.")
    prop, names = with_outputs(trace.system, prop)
    term = prop.response if prop.kind == "within" else prop.term
    return list(_Tree(_values(trace, prop, term), names).parts(term, wanted=True, depth=0))


def with_outputs(system: TransitionSystem, prop: Property) -> tuple[Property, dict[Expr, str]]:
    """Return the property, and the names of the computed outputs by the terms in it that are equal to them."""
    share = Sharing()
    names = {share(term): name for name, term in system.outputs.items() if not isinstance(term, (NumVar, BoolVar))}
    return replace(prop, term=share.bool(prop.term), response=share.bool(prop.response)), names


def parts_of(
    term: Bool, known: Mapping[Expr, Value], *, wanted: bool, names: Mapping[Expr, str] = MappingProxyType({})
) -> list[Part]:
    """Return the parts that keep a term from being what is wanted; the whole term alone if it is that.

    known  the values of the term and of all terms in it
    names  terms that are shown by a name, and not taken apart
    """
    tree = _Tree(known, names)
    return [tree.part(term, 0)] if bool(known[term]) == wanted else list(tree.parts(term, wanted=wanted, depth=0))


def _values(trace: Trace, prop: Property, term: Bool) -> dict[Expr, Value]:
    """Return the value of each part of the term in the last step, or in the first state of a run without steps."""
    nodes = list(in_order([term]))
    if not trace.steps:
        return dict(zip(nodes, Program(nodes)(_first(trace)), strict=True))
    reading = step_reading(trace.system, prop)
    return dict(zip(nodes, Program([reading.of[node] for node in nodes])(_last(trace, reading)), strict=True))


def _first(trace: Trace) -> dict[Var, Value]:
    return {var: trace.initial[var.name] for var in trace.system.state}


def _last(trace: Trace, reading: StepReading) -> dict[Var, Value]:
    """Return the state before the last step, and its inputs."""
    system = reading.system
    state = start(system, {var.name: trace.initial[var.name] for var in trace.system.state})
    inputs: dict[Var, Value] = {}
    for one in trace.steps:
        state = state if not inputs else step(system, state, inputs)[0]
        inputs = {var: one.inputs[var.name] for var in system.inputs}
    return {**state, **inputs}


@dataclass(frozen=True)
class _Tree:
    values: Mapping[Expr, Value]
    names: Mapping[Expr, str]

    def parts(self, term: Expr, *, wanted: bool, depth: int) -> Iterator[Part]:
        """Yield the part and those below it that keep it from being what is wanted."""
        if isinstance(term, Not):
            yield from self.parts(term.inner, wanted=not wanted, depth=depth)
            return
        yield self.part(term, depth)
        below = self._below(term)
        for part in below:
            yield from self.parts(part, wanted=wanted, depth=depth + 1)

    def _below(self, term: Expr) -> list[Expr]:
        """Return the parts that give the term its value."""
        value = self.values[term]
        if term in self.names:
            return []
        match term:
            case And() | Or():
                parts = list(_joined(term, type(term)))
                return [part for part in parts if self.values[part] == value] if _one_is_enough(term, value) else parts
            case ChooseBool(condition, then, otherwise):
                return [condition, then if self.values[condition] else otherwise]
            case _:
                return []

    def part(self, term: Expr, depth: int) -> Part:
        """Return the part itself, with the values that it reads if it is a comparison."""
        reads = self._reads(term)
        few = dict(list(reads.items())[:_MOST_VALUES])
        return Part(depth, infix(term, _LONGEST, self.names), bool(self.values[term]), few, len(reads) - len(few))

    def _reads(self, term: Expr) -> dict[str, str]:
        """Return the values of a comparison's two sides, and of the variables in them; of another part nothing."""
        if not isinstance(term, Compare):
            return {}
        sides = [side for side in (term.left, term.right) if not isinstance(side, Lit)]
        plain = [side for side in sides if side not in self.names]
        named: dict[str, str] = {}
        for one in dict.fromkeys([*sides, *variables(plain)]):
            assert isinstance(one, Node)
            named[infix(one, _LONGEST, self.names)] = value_text(one, self.values[one])
        return named


def value_text(term: Expr, value: Value) -> str:
    """Return the value of a term as text for a person: a member's label, true or false, or the number."""
    if isinstance(term, Num) and isinstance(term.unit, Enumeration):
        return term.unit.members[int(value)]
    return str(value).lower() if isinstance(value, bool) else str(value)


def _joined(term: Expr, kind: type[And | Or]) -> Iterator[Expr]:
    """Yield the parts of a conjunction or disjunction, with those of the same kind inside it in their place."""
    if not isinstance(term, kind):
        yield term
        return
    for part in term.parts:
        yield from _joined(part, kind)


def _one_is_enough(term: And | Or, value: Value) -> bool:
    """A conjunction is false by one part, a disjunction true."""
    return bool(value) == isinstance(term, Or)
