"""Terms and moves of a system as Python text.

The text follows the transition table: what is chosen by the same condition becomes one ladder of if and elif, and
a shared term is computed once, in the innermost branch that needs it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import assert_never

from safeloc.backends.shapes import is_magnitude
from safeloc.errors import InputError
from safeloc.expr import BoolVar, Expr, Lit, NumVar, Var
from safeloc.nodes import (
    Add,
    And,
    Choose,
    ChooseBool,
    Compare,
    FloorDiv,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Or,
    Past,
    Sub,
    Truth,
)
from safeloc.system import TransitionSystem
from safeloc.terms import children, in_order

Assignment = tuple[str, Expr]
Group = tuple[Expr | None, list[Assignment]]
LONGEST_INLINE = 12
DEEPEST_INDENT = 4 * 40  # Python itself refuses more than 100 levels


def to_python(system: TransitionSystem) -> str:
    """The source text: functions step, begin, run, history and outputs."""
    if any(isinstance(node, Past) for node in in_order(system.next.values())):
        raise InputError(f"{system.name}: past operators cannot run; observe the property first.")
    names = _names(system)
    held, read = [names[var] for var in system.state], [names[var] for var in system.inputs]
    moves = [(f"next_{names[var]}", system.next[var]) for var in system.state]
    fired = [(f"fired_{number}", term) for number, term in enumerate(system.fired.values())]
    shown = [(f"out_{number}", term) for number, term in enumerate(system.outputs.values())]
    head, take = f"    {_tuple(held)} = state\n", f"{_tuple(read)} = "
    step = _Block(names).lines([*moves, *fired], _Returned(len(held)), "    ")
    tick = _Block(names).lines([*moves, *fired], _Ticked(held), "        ")
    loop = f"        {take}row\n{_Block(names).lines(moves, _Moved(held), '        ')}"
    return (
        f'"""Generated from machine {system.name}; do not edit."""\n\n\n'
        f"def step(state, inputs):\n{head}    {take}inputs\n{step}\n\n"
        f"def begin(state):\n{head}\n    def tick({', '.join(read)}):\n        nonlocal {', '.join(held)}\n{tick}\n"
        f"    def now():\n        return {_tuple(held)}\n\n    return tick, now\n\n\n"
        f"def run(rows, state):\n{head}    for row in rows:\n{loop}    return {_tuple(held)}\n\n\n"
        f"def history(rows, state):\n{head}    states = []\n    for row in rows:\n{loop}"
        f"        states.append({_tuple(held)})\n    return states\n\n\n"
        f"def outputs(state):\n{head}{_Block(names).lines(shown, _Returned(None), '    ')}"
    )


Leaf = Callable[[list[str], str], str]
"""Writes the statements at the end of a branch: (the targets' values as text, indent) -> text."""


@dataclass(frozen=True)
class _Returned:
    """The values are the result: as one tuple, or the first `split` of them and the rest."""

    split: int | None

    def __call__(self, values: list[str], indent: str) -> str:
        if self.split is None:
            return f"{indent}return {_tuple(values)}\n"
        return f"{indent}return {_tuple(values[: self.split])}, {_tuple(values[self.split :])}\n"


@dataclass(frozen=True)
class _Moved:
    """The values become the state, all at once; what does not change is not touched."""

    held: list[str]

    def __call__(self, values: list[str], indent: str) -> str:
        changed = [(name, value) for name, value in zip(self.held, values, strict=True) if name != value]
        if not changed:
            return f"{indent}pass\n"
        return f"{indent}{', '.join(name for name, _ in changed)} = {', '.join(value for _, value in changed)}\n"


@dataclass(frozen=True)
class _Ticked:
    """The first values become the state, the rest are the result."""

    held: list[str]

    def __call__(self, values: list[str], indent: str) -> str:
        moved = _Moved(self.held)(values[: len(self.held)], indent)
        moved = "" if moved.strip() == "pass" else moved
        return f"{moved}{indent}return {_tuple(values[len(self.held) :])}\n"


@dataclass(frozen=True)
class _Kept:
    """The values are kept under the targets' own names."""

    members: list[Assignment]

    def __call__(self, values: list[str], indent: str) -> str:
        return "".join(f"{indent}{name} = {value}\n" for (name, _), value in zip(self.members, values, strict=True))


def _names(system: TransitionSystem) -> dict[Var, str]:
    """A Python name for every variable: its own letters, and a number where another one has that name already."""
    names: dict[Var, str] = {}
    taken: set[str] = set()
    for var in (*system.state, *system.inputs):
        plain = "v_" + "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in var.name)
        name, number = plain, 1
        while name in taken:
            number += 1
            name = f"{plain}_{number}"
        taken.add(name)
        names[var] = name
    return names


def _tuple(names: Iterable[str]) -> str:
    return "(" + "".join(f"{name}, " for name in names) + ")"


class _Block:
    """Writes statements; knows which terms already have a local name."""

    def __init__(self, names: Mapping[Var, str]) -> None:
        self._named: dict[Expr, str] = dict[Expr, str](names.items())
        self._count = 0

    def lines(self, targets: list[Assignment], leaf: Leaf, indent: str) -> str:
        """Statements that compute every target and end, in every branch, with the leaf's."""
        outer = dict(self._named)
        text = self._lines(targets, leaf, indent)
        self._named = outer
        return text

    def _lines(self, targets: list[Assignment], leaf: Leaf, indent: str) -> str:
        groups: list[Group] = [(None, targets)]
        if len(indent) < DEEPEST_INDENT:
            groups = _grouped(targets, self._named)
        text = self._bind(_shared(groups, self._named), indent)
        conditions = [condition for condition, _ in groups if condition is not None]
        if len(conditions) != 1:
            return text + self._apart(targets, groups, leaf, indent)
        text += self._bind([term for condition, members in groups if condition is None for _, term in members], indent)
        return text + self._choice(conditions[0], targets, leaf, indent)

    def _apart(self, targets: list[Assignment], groups: list[Group], leaf: Leaf, indent: str) -> str:
        """Targets that are chosen by different conditions, or by none."""
        text = ""
        values: dict[str, str] = {}
        for condition, members in groups:
            if condition is None:
                text += "".join(self._prepare(term, indent) for _, term in members)
                values |= {name: self._inline(term) for name, term in members}
            else:
                text += self._choice(condition, members, _Kept(members), indent)
                values |= {name: name for name, _ in members}
        return text + leaf([values[name] for name, _ in targets], indent)

    def _choice(self, condition: Expr, members: list[Assignment], leaf: Leaf, indent: str) -> str:
        """One ladder of if and elif, as long as nothing has to be computed before the next rung."""
        text, rung = self._prepare(condition, indent), "if"
        test: Expr | None = condition
        while test is not None:
            then = self.lines(_thens(test, members), leaf, indent + "    ")
            text += f"{indent}{rung} {self._inline(test)}:\n{then}"
            members, rung = _others(test, members), "elif"
            test = self._next_rung(members)
        otherwise = self.lines(members, leaf, indent + "    ")
        return text if otherwise.strip() == "pass" else f"{text}{indent}else:\n{otherwise}"

    def _next_rung(self, members: list[Assignment]) -> Expr | None:
        """The condition that decides all of `members`, if it can be tested as it stands."""
        groups = _grouped(members, self._named)
        conditions = [condition for condition, _ in groups if condition is not None]
        plain = [term for condition, targets in groups if condition is None for _, term in targets]
        if len(conditions) != 1 or self._unnamed(plain):
            return None
        waits = self._to_bind(conditions[0]) or _shared(groups, self._named)
        return None if waits else conditions[0]

    def _prepare(self, term: Expr, indent: str) -> str:
        return self._bind(self._to_bind(term), indent)

    def _to_bind(self, term: Expr) -> list[Expr]:
        """What the term uses more than once, compares twice, or nests too deep."""
        uses = Counter(child for node in self._unnamed([term]) for child in children(node))
        twice = {node for node, count in uses.items() if count > 1}
        for node in self._unnamed([term]):
            if isinstance(node, (Min, Max)):
                twice |= {node.left} if is_magnitude(node) else {node.left, node.right}
        depth: dict[Expr, int] = {}
        for node in self._unnamed([term]):
            depth[node] = 1 + max((depth.get(child, 0) for child in children(node)), default=0)
            if depth[node] > LONGEST_INLINE:
                twice.add(node)
                depth[node] = 0
        return [node for node in self._unnamed([term]) if node in twice and node is not term]

    def _bind(self, nodes: Iterable[Expr], indent: str) -> str:
        text = ""
        for node in nodes:
            if isinstance(node, (Lit, Truth)) or node in self._named:
                continue
            text += self._prepare(node, indent)
            value = self._inline(node)
            self._count += 1
            self._named[node] = f"t{self._count}"
            text += f"{indent}t{self._count} = {value}\n"
        return text

    def _unnamed(self, roots: Iterable[Expr]) -> list[Expr]:
        return unnamed(roots, self._named)

    def _inline(self, term: Expr) -> str:
        if term in self._named:
            return self._named[term]
        assert isinstance(term, Node)
        match term:
            case Lit(value, _):
                return str(value) if value >= 0 else f"({value})"
            case Truth(value):
                return str(value)
            case Add(a, b):
                return f"({self._inline(a)} + {self._inline(b)})"
            case Sub(Lit(0, _), b):
                return f"(-{self._inline(b)})"
            case Sub(a, b):
                return f"({self._inline(a)} - {self._inline(b)})"
            case Mul(a, b):
                return f"({self._inline(a)} * {self._inline(b)})"
            case FloorDiv(a, divisor, _):
                return f"({self._inline(a)} // {divisor})"
            case Min(a, b):
                x, y = self._inline(a), self._inline(b)
                return f"({x} if {x} < {y} else {y})"
            case Max(a, _) if is_magnitude(term):
                x = self._inline(a)
                return f"({x} if {x} >= 0 else -{x})"
            case Max(a, b):
                x, y = self._inline(a), self._inline(b)
                return f"({x} if {x} > {y} else {y})"
            case Choose(c, a, b, _) | ChooseBool(c, a, b):
                return f"({self._inline(a)} if {self._inline(c)} else {self._inline(b)})"
            case Not(inner):
                return f"(not {self._inline(inner)})"
            case And(parts):
                return "(" + " and ".join(map(self._inline, parts)) + ")"
            case Or(parts):
                return "(" + " or ".join(map(self._inline, parts)) + ")"
            case Compare(op, a, b):
                return f"({self._inline(a)} {op} {self._inline(b)})"
            case Past() | NumVar() | BoolVar():
                raise KeyError(f"{term!r} has no value here")
            case _:
                assert_never(term)


def unnamed(roots: Iterable[Expr], named: Mapping[Expr, str]) -> list[Expr]:
    """Nodes below `roots` that are no constants and have no name yet, parts before wholes."""
    seen: set[int] = set()
    order: list[Expr] = []
    stack: list[tuple[Expr, bool]] = [(root, False) for root in roots]
    while stack:
        node, done = stack.pop()
        if done:
            order.append(node)
        elif id(node) not in seen and node not in named and not isinstance(node, (Lit, Truth)):
            seen.add(id(node))
            stack.append((node, True))
            stack.extend((child, False) for child in children(node))
    return order


def _thens(condition: Expr, members: list[Assignment]) -> list[Assignment]:
    return [(name, _decided(condition, term, True)) for name, term in members]


def _others(condition: Expr, members: list[Assignment]) -> list[Assignment]:
    return [(name, _decided(condition, term, False)) for name, term in members]


def _decided(condition: Expr, term: Expr, holds: bool) -> Expr:
    """What is left of a term where it is known whether the condition holds."""
    if isinstance(term, (Choose, ChooseBool)) and term.condition is condition:
        return term.then if holds else term.other
    return term


def _grouped(targets: list[Assignment], named: Mapping[Expr, str]) -> list[Group]:
    """Targets chosen by the same condition together, all others apart; in the order of first appearance."""
    groups: dict[Expr | None, list[Assignment]] = {}
    for name, term in targets:
        chosen = isinstance(term, (Choose, ChooseBool)) and term not in named
        key = term.condition if chosen and isinstance(term, (Choose, ChooseBool)) else None
        groups.setdefault(key, []).append((name, term))
    return list(groups.items())


def _shared(groups: list[Group], named: Mapping[Expr, str]) -> list[Expr]:
    """Terms that more than one place of a block needs: they are computed before it, outermost ones only."""
    sites: list[list[Expr]] = []
    for condition, members in groups:
        if condition is None:
            sites += [[term] for _, term in members]
        else:
            sites.append([condition])
            sites.append([term for _, term in _thens(condition, members)])
            sites.append([term for _, term in _others(condition, members)])
    found = [unnamed(site, named) for site in sites]
    count = Counter(id(node) for site in found for node in site)
    parents: dict[int, set[int]] = {}
    for site in found:
        for node in site:
            for child in children(node):
                parents.setdefault(id(child), set()).add(id(node))
    roots = Counter(id(term) for site in sites for term in site)
    order = unnamed([term for site in sites for term in site], named)
    return [n for n in order if count[id(n)] > 1 and len(parents.get(id(n), ())) + roots[id(n)] > 1]
