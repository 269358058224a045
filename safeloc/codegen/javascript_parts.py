"""The parts by which a JavaScript machine explains a step: guards, named terms, laws and claims, as terms that it
evaluates and writes.

A term is stored once, as a list of its kind and of the places of its operands; machine_terms.js evaluates it, writes it, and takes
it apart. Guards are the machine's own, over its own variables. In a composition a wired input therefore leads to a term of the
whole, mostly the value of an earlier machine's variable after the step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, assert_never

from safeloc.codegen.stages import is_cut
from safeloc.language.machine import Machine
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
    Var,
)
from safeloc.language.render import names_of_outputs
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Sharing, Substitution, in_order, variables
from safeloc.language.units import ONE, Enumeration, Unit

(_LITERAL, _VARIABLE, _TRUTH, _NOT, _AND, _OR, _CHOICE, _COMPARED, _SUM, _DIFFERENCE, _PRODUCT, _QUOTIENT, _LEAST, _MOST, _PAST) = range(15)  # fmt: skip
_BEFORE, _INPUT, _AFTER, _FIRED, _WIRED = range(5)
_OPERATORS = {"==": 0, "<=": 1, "<": 2}
_JOINED: dict[type[Expr], int] = {Add: _SUM, Sub: _DIFFERENCE, Min: _LEAST, Max: _MOST}
_LARGEST = 2**53 - 1
_Leaf = tuple[int, int]
"""Which list of values has a variable (`_BEFORE`, ...), and its place there."""


@dataclass(frozen=True, eq=False)
class Member:
    """One machine of the system, and how its terms read in a step of the whole. `prefix` begins its names in the whole."""

    machine: Machine
    prefix: str
    in_a_step: Callable[[Expr], Expr]
    wired: tuple[Var, ...] = ()


def members(system: TransitionSystem) -> list[Member]:
    """Return the machines of the system in the order of the step."""
    if not system.parts:
        return [Member(machine, "", lambda term: term) for machine in system.machines]
    own = {*system.state, *system.inputs}
    return [
        Member(
            part.machine,
            f"{part.name}.",
            part.in_a_step,
            tuple(var for var in part.alone.inputs if part.in_a_step(var) not in own),
        )
        for part in system.parts
    ]


def laws(system: TransitionSystem) -> dict[str, Bool]:
    """Return the laws of the world that a step has to keep, each with its machine; none where the system has no ghosts."""
    if not system.ghosts:
        return {}
    if not system.parts:
        [machine] = system.machines
        return {f"{machine.name}: {name}": term for name, term in machine.world.terms.items()}
    return {f"{part.name}: {name}": term for part in system.parts for name, term in part.assumed.items()}


@dataclass(eq=False)
class Parts:
    """All terms of a script, and what they refer to.

    texts  every text once
    units  every unit once: its name, nothing for a plain number, or the members of an enumeration
    nodes  the terms, operands first
    names  pairs of a term's place and the place of its name
    slots  how many past operators keep a value from step to step
    """

    system: TransitionSystem
    texts: dict[str, int] = field(default_factory=dict)
    nodes: list[list[Any]] = field(default_factory=list)
    names: list[tuple[int, int]] = field(default_factory=list)
    slots: int = 0
    _units: dict[str | tuple[str, ...], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        system = self.system
        twins: dict[Var, Var] = {var: replace(var, name=f"{var.name} after") for var in system.state}
        moved = reversed(list(system.next.items()))
        self.cut = Substitution({}, [(term, twins[var]) for var, term in moved if is_cut(var, term)])
        self.before: dict[Var, _Leaf] = {var: (_BEFORE, place) for place, var in enumerate(system.state)}
        self.inputs: dict[Var, _Leaf] = {var: (_INPUT, place) for place, var in enumerate(system.inputs)}
        self.after: dict[Var, _Leaf] = {var: (_AFTER, place) for place, var in enumerate(system.state)}
        cut = {twins[var]: leaf for var, leaf in self.after.items()}
        self.whole = Terms(self, {**self.before, **self.inputs, **cut}, {})

    @property
    def units(self) -> list[str | list[str]]:
        """The units in order."""
        return [one if isinstance(one, str) else list(one) for one in self._units]

    def place(self, term: Expr) -> int:
        """Return the place of a term over the state before the step and the inputs."""
        return self.whole.place(self.cut(term))

    def knows(self, term: Expr) -> bool:
        """Return whether the term has a value in this system: on board no term over ghosts has."""
        return self.whole.knows(self.cut(term))

    def text(self, text: str) -> int:
        """Return the place of a text."""
        return self.texts.setdefault(text, len(self.texts))

    def unit(self, unit: Unit | Enumeration) -> int:
        """Return the place of a unit."""
        shown = unit.members if isinstance(unit, Enumeration) else "" if unit.same(ONE) else unit.name
        return self._units.setdefault(shown, len(self._units))


class Terms:
    """Terms over some variables, with names of their own: those of a machine, of the whole, or of the claims.

    leaves  where the variables have their values
    names   terms that have a name
    """

    def __init__(self, parts: Parts, leaves: Mapping[Var, _Leaf], names: Mapping[str, Expr]) -> None:
        self._parts, self._leaves = parts, leaves
        self._share, self._made = Sharing(), dict[Expr, int]()
        self._names = {self._share(term): name for name, term in names.items()}

    def knows(self, term: Expr) -> bool:
        """Return whether every variable of the term has a value."""
        return all(var in self._leaves for var in variables([term]))

    def place(self, term: Expr) -> int:
        """Return the place of a term among the nodes, with its operands before it."""
        shared = self._share(term)
        for node in in_order([shared], self._made):
            self._made[node] = len(self._parts.nodes)
            self._parts.nodes.append(self._node(node))
            if node in self._names:
                self._parts.names.append((self._made[node], self._parts.text(self._names[node])))
        return self._made[shared]

    def _node(self, term: Node) -> list[Any]:
        at, unit = self._made, self._parts.unit
        match term:
            case Lit(value, measure):
                return [_LITERAL, unit(measure), value if abs(value) <= _LARGEST else str(value)]
            case NumVar() | BoolVar():
                return [
                    _VARIABLE,
                    unit(term.unit) if isinstance(term, NumVar) else -1,
                    self._parts.text(term.name),
                    *self._leaves[term],
                ]
            case Truth(value):
                return [_TRUTH, int(value)]
            case Not(inner):
                return [_NOT, at[inner]]
            case And(parts) | Or(parts):
                return [_AND if isinstance(term, And) else _OR, *(at[part] for part in parts)]
            case Choose(condition, then, other) | ChooseBool(condition, then, other):
                return [_CHOICE, at[condition], at[then], at[other]]
            case Compare(operator, left, right):
                return [_COMPARED, _OPERATORS[operator], at[left], at[right]]
            case Add(left, right) | Sub(left, right) | Min(left, right) | Max(left, right):
                return [_JOINED[type(term)], at[left], at[right]]
            case Mul(left, right, measure):
                return [_PRODUCT, unit(measure), at[left], at[right]]
            case FloorDiv(left, divisor, measure):
                return [_QUOTIENT, unit(measure), at[left], divisor if divisor <= _LARGEST else str(divisor)]
            case Past(operator, parts):
                self._parts.slots += 1
                return [_PAST, operator, self._parts.slots - 1, *(at[part] for part in parts)]
            case _:
                assert_never(term)


def terms_of(parts: Parts, member: Member) -> Terms:
    """Return the terms of a machine over its own variables, with the names that it gives to some of them."""
    machine = member.machine
    terms = [one.when for one in machine.transitions]
    every = variables([machine.mode, *terms, *machine.definitions.values(), *member.wired])
    return Terms(parts, {var: _leaf(parts, member, var) for var in every if parts.knows(member.in_a_step(var))}, machine.definitions)  # fmt: skip


def _leaf(parts: Parts, member: Member, var: Var) -> _Leaf:
    term = member.in_a_step(var)
    if isinstance(term, (NumVar, BoolVar)):
        own = parts.before.get(term) or parts.inputs.get(term)
        if own is not None:
            return own
    return (_WIRED, parts.place(term))


def claims(parts: Parts, properties: tuple[Property, ...]) -> list[dict[str, Any]]:
    """Return the claims about steps that have a value in this system, ready to be monitored.

    Terms read the state after the step; a further assumption reads that before it. Outputs that are computed are shown by name.
    """
    system, first = parts.system, dict[Var, Var]()
    every = variables([term for prop in properties for term in (prop.term, prop.response)])
    earlier: dict[Var, Expr] = {var: first.setdefault(var.before, var) for var in every if var.before is not None}
    settled = Substitution(earlier)
    before = {var: parts.before[state] for state, var in first.items() if state in parts.before}
    fired: dict[Var, _Leaf] = {var: (_FIRED, place) for place, var in enumerate(system.fired)}
    outputs = {name: one for one, name in names_of_outputs(system.outputs, Sharing()).items()}
    terms = Terms(parts, {**parts.after, **parts.inputs, **before, **fired}, outputs)
    asked = [prop for prop in properties if prop.kind != "reachable"]
    known = [prop for prop in asked if all(terms.knows(settled(term)) for term in (prop.term, prop.response))]
    state = set(system.state)
    return [
        {
            "name": prop.name,
            "statement": prop.statement,
            "steps": prop.steps if prop.kind == "within" else -1,
            "term": terms.place(settled(prop.term)),
            "response": terms.place(settled(prop.response)),
            "first": _reads_only(prop.term, state),
            "assumed": [parts.place(term) for term in _assumed(system, prop)],
        }
        for prop in known
        if parts.knows(prop.further_assumption)
    ]


def _assumed(system: TransitionSystem, prop: Property) -> list[Bool]:
    return [prop.further_assumption] if prop.unconditional else [system.assume, prop.further_assumption]


def _reads_only(term: Bool, state: set[Var]) -> bool:
    """Return whether the term reads the state after the step alone, so that the first state has to keep it too."""
    nodes = in_order([term])
    return all(var in state for var in variables([term])) and not any(isinstance(node, Past) for node in nodes)
