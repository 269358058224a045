"""Generated Python: one step, a fused loop over a stream, and the outputs.

The text follows the transition table: terms that are chosen by the same condition become one if/else, and a
sub-term is computed once, in the innermost block that needs it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, assert_never

from safeloc.errors import InputError
from safeloc.expr import (
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
    children,
    in_order,
)
from safeloc.interpret import fired_names, read_inputs, start
from safeloc.system import TransitionSystem

Row = tuple[Value, ...]
Assignment = tuple[str, Expr]
Group = tuple[Expr | None, list[Assignment]]
LONGEST_INLINE = 12
DEEPEST_INDENT = 4 * 40  # Python itself refuses more than 100 levels


@dataclass(frozen=True)
class Compiled:
    """A system as Python functions. State and inputs are tuples in the order of `state_names` and `input_names`.

    step     (state, inputs) -> (state after, fired transition numbers)
    run      (rows of inputs, state) -> last state: the fused loop
    history  (rows of inputs, state) -> states after every step
    outputs  state -> outputs, in the order of `output_names`

    Inputs are taken as they are: whoever has raw data uses `read` first, which refuses what the interpreter refuses.
    """

    system: TransitionSystem
    source: str
    state_names: tuple[str, ...]
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    step: Callable[[Row, Row], tuple[Row, tuple[int, ...]]]
    run: Callable[[Iterable[Row], Row], Row]
    history: Callable[[Iterable[Row], Row], list[Row]]
    outputs: Callable[[Row], Row]

    def first(self, chosen: Mapping[str, Value] | None = None) -> Row:
        """The first state; InputError as in `interpret.start`."""
        return tuple(start(self.system, chosen).values())

    def read(self, record: Mapping[str, object]) -> Row:
        """One step's inputs by name, checked as the interpreter checks them."""
        values = read_inputs(self.system, record)
        return tuple(values[var] for var in self.system.inputs)

    def named_outputs(self, state: Row) -> dict[str, Value]:
        """The outputs by name."""
        return dict(zip(self.output_names, self.outputs(state), strict=True))

    def fired(self, numbers: Sequence[int]) -> dict[str, str]:
        """Names of the transitions that fired, by fired variable."""
        return fired_names(dict(zip(self.system.fired, numbers, strict=True)))


def compile_system(system: TransitionSystem) -> Compiled:
    """Generate and load the functions. For what runs on board, pass `without_ghosts(system)`."""
    source = to_python(system)
    space: dict[str, Any] = {}
    exec(compile(source, f"<safeloc {system.name}>", "exec"), space)  # noqa: S102 # our own text, made from checked terms
    return Compiled(
        system,
        source,
        tuple(var.name for var in system.state),
        tuple(var.name for var in system.inputs),
        tuple(system.outputs),
        space["step"],
        space["run"],
        space["history"],
        space["outputs"],
    )


def to_python(system: TransitionSystem) -> str:
    """The source text: functions step, run, history and outputs."""
    if any(isinstance(node, Past) for node in in_order(system.next.values())):
        raise InputError(f"{system.name}: past operators cannot run; observe the property first.")
    names = _names(system)
    after = {var: f"next_{names[var]}" for var in system.state}
    moves = [(after[var], system.next[var]) for var in system.state if system.next[var] is not var]
    fired = [(f"fired_{number}", term) for number, term in enumerate(system.fired.values())]
    state, inputs = _tuple(names[var] for var in system.state), _tuple(names[var] for var in system.inputs)
    moved = _tuple(after[var] if system.next[var] is not var else names[var] for var in system.state)
    body, loop = _Block(names), _Block(names)
    step = body.lines([*moves, *fired], "    ")
    inner = loop.lines(moves, "        ")
    results = _Block(names).lines([(f"out_{n}", term) for n, term in enumerate(system.outputs.values())], "    ")
    outs = _tuple(f"out_{n}" for n in range(len(system.outputs)))
    head = "    " + f"{state} = state\n" if system.state else ""
    take = f"        {inputs} = row\n" if system.inputs else ""
    return (
        f'"""Generated from machine {system.name}; do not edit."""\n\n\n'
        f"def step(state, inputs):\n{head}    {inputs} = inputs\n{step}"
        f"    return {moved}, {_tuple(name for name, _ in fired)}\n\n\n"
        f"def run(rows, state):\n{head}    for row in rows:\n{take}{inner}        {state} = {moved}\n"
        f"    return {state}\n\n\n"
        f"def history(rows, state):\n{head}    states = []\n    for row in rows:\n{take}{inner}"
        f"        {state} = {moved}\n        states.append({state})\n    return states\n\n\n"
        f"def outputs(state):\n{head}{results}    return {outs}\n"
    )


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
    """Writes assignments as statements; knows which terms already have a local name."""

    def __init__(self, names: Mapping[Var, str]) -> None:
        self._named: dict[Expr, str] = {var: name for var, name in names.items()}
        self._count = 0

    def lines(self, targets: list[Assignment], indent: str) -> str:
        """Statements that assign every target, `pass` if there are none."""
        outer = dict(self._named)
        text = self._lines(targets, indent)
        self._named = outer
        return text or f"{indent}pass\n"

    def _lines(self, targets: list[Assignment], indent: str) -> str:
        groups: list[Group] = [(None, targets)]
        if len(indent) < DEEPEST_INDENT:
            groups = _grouped(targets, self._named)
        text = self._bind(_shared(groups, self._named), indent)
        for condition, members in groups:
            if condition is None:
                text += "".join(self._assign(name, term, indent) for name, term in members)
            else:
                text += self._choice(condition, members, indent)
        return text

    def _choice(self, condition: Expr, members: list[Assignment], indent: str) -> str:
        """One ladder of if and elif, as long as nothing has to be computed before the next rung."""
        text, rung = self._prepare(condition, indent), "if"
        test: Expr | None = condition
        while test is not None:
            text += f"{indent}{rung} {self._inline(test)}:\n{self.lines(_thens(members), indent + '    ')}"
            members, rung = _others(members), "elif"
            test = self._next_rung(members)
        return text + f"{indent}else:\n{self.lines(members, indent + '    ')}"

    def _next_rung(self, members: list[Assignment]) -> Expr | None:
        """The condition that decides all of `members`, if it can be tested as it stands."""
        groups = _grouped(members, self._named)
        condition = groups[0][0]
        if len(groups) > 1 or condition is None or self._to_bind(condition) or _shared(groups, self._named):
            return None
        return condition

    def _assign(self, name: str, term: Expr, indent: str) -> str:
        return self._prepare(term, indent) + f"{indent}{name} = {self._inline(term)}\n"

    def _prepare(self, term: Expr, indent: str) -> str:
        return self._bind(self._to_bind(term), indent)

    def _to_bind(self, term: Expr) -> list[Expr]:
        """What the term uses more than once, compares twice, or nests too deep."""
        uses = Counter(child for node in self._unnamed([term]) for child in children(node))
        twice = {node for node, count in uses.items() if count > 1}
        for node in self._unnamed([term]):
            if isinstance(node, (Min, Max)):
                twice |= set(children(node))
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
            case Sub(a, b):
                return f"({self._inline(a)} - {self._inline(b)})"
            case Mul(a, b):
                return f"({self._inline(a)} * {self._inline(b)})"
            case FloorDiv(a, divisor, _):
                return f"({self._inline(a)} // {divisor})"
            case Min(a, b):
                x, y = self._inline(a), self._inline(b)
                return f"({x} if {x} < {y} else {y})"
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


def _thens(members: list[Assignment]) -> list[Assignment]:
    return [(name, term.then) for name, term in members if isinstance(term, (Choose, ChooseBool))]


def _others(members: list[Assignment]) -> list[Assignment]:
    return [(name, term.other) for name, term in members if isinstance(term, (Choose, ChooseBool))]


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
            sites.append([term for _, term in _thens(members)])
            sites.append([term for _, term in _others(members)])
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
