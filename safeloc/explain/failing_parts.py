"""The parts of a property's term that make it fail in a step, each with its value: a tree, from the whole term to what it reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from safeloc.errors import PropertyError
from safeloc.language.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Var
from safeloc.language.interpret import Program, start, step
from safeloc.language.nodes import And, Choose, ChooseBool, Compare, Not, Or, Truth, Value
from safeloc.language.render import infix, names_of_outputs
from safeloc.language.spec import Property, StepReading, step_reading
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Sharing, children, in_order
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration

_LONGEST = 200
"""Most characters of a term."""
_MOST_VALUES = 12
"""Most variables of a comparison whose values are shown."""
_SHALLOW, _UNBOUNDED = 3, 10**9
"""Deepest nesting that is written where a part can be unfolded, and no bound on its characters."""


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
    names = names_of_outputs(system.outputs, share)
    return replace(prop, term=share.bool(prop.term), response=share.bool(prop.response)), names


def parts_of(
    term: Bool, known: Mapping[Expr, Value], *, wanted: bool, names: Mapping[Expr, str] = MappingProxyType({})
) -> list[Part]:
    """Return the parts that keep a term from being what is wanted; the whole term alone if it is that.

    known  the values of the term and of all terms in it
    names  terms that are shown by a name, and not taken apart; equal terms are the same node
    """
    tree = _Tree(known, names)
    return [tree.part(term, 0)] if bool(known[term]) == wanted else list(tree.parts(term, wanted=wanted, depth=0))


@dataclass(frozen=True)
class Unfolded:
    """A part of a term one level down.

    name     the name that it has, if it has one
    text     what it is, with names for what has a name, and an ellipsis for what is nested deep
    value    its value as text
    decides  it gives the whole its value: of a false conjunction, a false part
    reads    of a comparison, text and value of its sides
    """

    name: str
    text: str
    value: str
    decides: bool
    reads: tuple[tuple[str, str], ...]
    term: Expr


def unfolded(term: Expr, known: Mapping[Expr, Value], names: Mapping[Expr, str]) -> list[Unfolded]:
    """Return the parts of a term one level down, of a name those of what it stands for. `known` and `names` as in `parts_of`."""
    tree = _Tree(known, names)
    found = _joined(term, names) if isinstance(term, (And, Or)) else children(term)
    return [
        Unfolded(
            names.get(part, ""),
            _meaning(part, names),
            value_text(part, known[part]),
            tree.decides(term, part),
            tuple(
                (infix(side, _UNBOUNDED, names, deepest=_SHALLOW), value_text(side, known[side]))
                for side in _sides(part)
            ),
            part,
        )
        for part in dict.fromkeys(found)
        if not isinstance(part, (Lit, Truth))
    ]


def _meaning(term: Expr, names: Mapping[Expr, str]) -> str:
    """Return the text of a term; of a name that of what it stands for."""
    others = {other: name for other, name in names.items() if other is not term}
    return infix(term, _UNBOUNDED, others, deepest=_SHALLOW)


def _sides(term: Expr) -> list[Num]:
    """Return the sides of a comparison that are no constants."""
    return [side for side in (term.left, term.right) if not isinstance(side, Lit)] if isinstance(term, Compare) else []


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
                parts = list(_joined(term, self.names))
                return [part for part in parts if self.values[part] == value] if _one_is_enough(term, value) else parts
            case ChooseBool(condition, then, otherwise):
                return [condition, then if self.values[condition] else otherwise]
            case _:
                return []

    def decides(self, term: Expr, part: Expr) -> bool:
        """Return whether a part one level down gives the term its value."""
        value = self.values[term]
        match term:
            case And() | Or():
                return not _one_is_enough(term, value) or self.values[part] == value
            case Choose(condition, then, otherwise) | ChooseBool(condition, then, otherwise):
                return part is condition or part is (then if self.values[condition] else otherwise)
            case _:
                return True

    def part(self, term: Expr, depth: int) -> Part:
        """Return the part itself, with the values that it reads if it is a comparison."""
        reads = self._reads(term)
        few = dict(list(reads.items())[:_MOST_VALUES])
        return Part(depth, infix(term, _LONGEST, self.names), bool(self.values[term]), few, len(reads) - len(few))

    def _reads(self, term: Expr) -> dict[str, str]:
        """Return the values of a comparison's two sides, and of the variables in them; of another part nothing."""
        if not isinstance(term, Compare):
            return {}
        sides = _sides(term)
        plain = [side for side in sides if side not in self.names]
        named: dict[str, str] = {}
        for one in dict.fromkeys([*sides, *self._leaves(plain)]):
            named[infix(one, _LONGEST, self.names)] = value_text(one, self.values[one])
        return named

    def _leaves(self, terms: Sequence[Expr]) -> Iterator[Expr]:
        """Yield the variables and names in terms, in order of first use; what a name stands for is not looked into."""
        for node in in_order(terms, self.names):
            if isinstance(node, (NumVar, BoolVar)):
                yield node
            yield from (part for part in children(node) if part in self.names)


def value_text(term: Expr, value: Value) -> str:
    """Return the value of a term as text for a person: a member's label, true or false, or the number."""
    if isinstance(term, Num) and isinstance(term.unit, Enumeration):
        return term.unit.members[int(value)]
    return str(value).lower() if isinstance(value, bool) else str(value)


def _joined(term: And | Or, names: Mapping[Expr, str]) -> Iterator[Expr]:
    """Yield the parts of a conjunction or disjunction, with those of the same kind inside it in their place; a name stays."""
    for part in term.parts:
        if isinstance(part, (And, Or)) and type(part) is type(term) and part not in names:
            yield from _joined(part, names)
        else:
            yield part


def _one_is_enough(term: And | Or, value: Value) -> bool:
    """A conjunction is false by one part, a disjunction true."""
    return bool(value) == isinstance(term, Or)
