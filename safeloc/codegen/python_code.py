"""A system's moves as Python text, with branches as in its transition table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from safeloc.codegen.case_splitting import moves
from safeloc.codegen.nested_statements import Bind, Block, Blocks, Choice, End, Test
from safeloc.codegen.python_terms import PythonTerms
from safeloc.codegen.stages import Stage, stages
from safeloc.errors import InputError
from safeloc.language.nodes import Expr, Past, Var
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import in_order, variables


def to_python(system: TransitionSystem) -> str:
    """Return the source text: functions step, begin (with moving, which stores the state), run, history and outputs."""
    if any(isinstance(node, Past) for node in in_order(system.next.values())):
        raise InputError(f"{system.name}: past operators cannot run; `observe` the property first.")
    names = _names([*system.state, *system.inputs])
    held, read = [names[var] for var in system.state], [names[var] for var in system.inputs]
    body = _Body(system, names)
    state = _tuple(held)
    return (
        f'"""Generated from machine {system.name}; do not edit."""\n\n\n'
        f"def step(state, inputs):\n    {state} = state\n    {_tuple(read)} = inputs\n"
        f"{body.text(_Returned(held, body.at_once), '    ')}\n\n"
        f"def moving(state):\n    {state} = state\n    row = yield\n    while True:\n        while row is None:\n"
        f"            row = yield {state}\n        {_tuple(read)} = row\n{body.text(_Ticked(held), '        ')}\n\n"
        "def begin(state):\n    machine = moving(state)\n    next(machine)\n    tick = machine.send\n\n"
        "    def now():\n        return tick(None)\n\n    return tick, now\n\n\n"
        f"def run(rows, state):\n    {state} = state\n    for row in rows:\n        {_tuple(read)} = row\n"
        f"{body.text(_Moved(held), '        ')}    return {state}\n\n\n"
        "def history(rows, state):\n    tick, now = begin(state)\n    states = []\n    for row in rows:\n"
        "        tick(row)\n        states.append(now())\n    return states\n\n\n"
        f"{_outputs(names, list(system.state), list(system.outputs.values()))}"
    )


def terms_to_python(reads: Sequence[Var], terms: Sequence[Expr]) -> str:
    """Return the source text of a function of one row of values of `reads`, without branches: every repeated term is computed once.

    It is generated five times as quickly as nested statements, and takes some 1.3 times as long to run: right for what a search or a
    replay runs some thousand times.
    """
    names = _names(reads)
    writing, text = PythonTerms(names), f"def terms(state):\n    {_tuple(names[var] for var in reads)} = state\n"
    for number, term in enumerate(writing.repeated(terms)):
        text += f"    t{number} = {writing.code(term)}\n"
        writing.named[term] = f"t{number}"
    return f"{text}    return {_tuple(writing.code(term) for term in terms)}\n"


def rows_to_python(rows: Mapping[str, Sequence[Var]], terms: Sequence[Expr]) -> str:
    """Return the source text of a function of several rows of values; it unpacks only the values that the terms read."""
    names = _names(var for row in rows.values() for var in row)
    read = set(variables(terms))
    given = "".join(
        f"    {names[var]} = {name}[{place}]\n"
        for name, row in rows.items()
        for place, var in enumerate(row)
        if var in read
    )
    shown = Blocks(PythonTerms(names)).ending([(f"out_{number}", term) for number, term in enumerate(terms)])
    return f"def terms({', '.join(rows)}):\n{given}{_lines(shown, _shown, '    ')}"


def _outputs(names: Mapping[Var, str], state: Sequence[Var], outputs: Sequence[Expr]) -> str:
    shown = Blocks(PythonTerms(names)).ending([(f"out_{number}", term) for number, term in enumerate(outputs)])
    given = f"    {_tuple(names[var] for var in state)} = state\n" if state else ""
    return f"def outputs(state):\n{given}{_lines(shown, _shown, '    ')}"


Leaf = Callable[[Sequence[str]], list[str]]
"""A function from the targets' values to the statements at the end of a branch."""


class _Body:
    """The moves of a system, stage by stage; later stages read the values that earlier ones computed."""

    def __init__(self, system: TransitionSystem, names: Mapping[Var, str]) -> None:
        self._names = names
        self._fired = {var: f"fired_{number}" for number, var in enumerate(system.fired)}
        self._stages = [(stage, self._block(system, stage)) for stage in stages(system)]
        self._state = [names[var] for var in system.state]

    @property
    def at_once(self) -> bool:
        """True if all variables move at the end of the step, False if they move stage by stage."""
        return len(self._stages) == 1

    def text(self, leaf: Leaf, indent: str) -> str:
        """Return the statements; `leaf` gives those that use the state after the step and the fired numbers."""
        if self.at_once:
            return _lines(self._stages[0][1], leaf, indent)
        kept = {var: self._before(var) for stage, _ in self._stages for var in stage.before.values()}
        text = "".join(f"{indent}{name} = {self._names[var]}\n" for var, name in kept.items())
        for stage, block in self._stages:
            text += f"{indent}while True:  # {stage.name}\n{_lines(block, _Left(self._given(stage)), indent + '    ')}"
        return text + "".join(f"{indent}{line}\n" for line in leaf([*self._state, *self._fired.values()]))

    def _given(self, stage: Stage) -> list[str]:
        return [*(self._names[var] for var in stage.moved), *(self._fired[var] for var in stage.fired)]

    def _block(self, system: TransitionSystem, stage: Stage) -> Block:
        names = {
            **self._names,
            **{later: self._names[var] for later, var in stage.after.items()},
            **{earlier: self._before(var) for earlier, var in stage.before.items()},
        }
        moved = [(f"next_{names[var]}", term) for var, term in stage.moved.items()]
        fired = [(f"next_{self._fired[var]}", term) for var, term in stage.fired.items()]
        return moves(system, [*moved, *fired], Blocks(PythonTerms(names)))

    def _before(self, var: Var) -> str:
        return f"before_{self._names[var]}"


def _lines(block: Block, leaf: Leaf, indent: str) -> str:
    """Return the statements as text."""
    text = ""
    for statement in block:
        match statement:
            case Bind(name, value, _):
                text += f"{indent}{name} = {value.code}\n"
            case Test(test, inner):
                text += f"{indent}if {test.code}:\n{_lines(inner, leaf, indent + '    ')}"
            case Choice(branches, otherwise):
                for number, (test, inner) in enumerate(branches):
                    text += f"{indent}{'elif' if number else 'if'} {test.code}:\n{_lines(inner, leaf, indent + '    ')}"
                text += f"{indent}else:\n{_lines(otherwise, leaf, indent + '    ')}"
            case End(values):
                text += "".join(f"{indent}{line}\n" for line in leaf([value.code for value in values]))
            case _:
                assert_never(statement)
    return text


@dataclass(frozen=True)
class _Returned:
    """End of a branch of `step`: returns the state after the step and the fired numbers.

    kept  the names still have their values from before the step, so that an unchanged state is returned as it is
    """

    held: list[str]
    kept: bool

    def __call__(self, values: Sequence[str]) -> list[str]:
        count = len(self.held)
        state = "state" if self.kept and list(values[:count]) == self.held else _tuple(values[:count])
        return [f"return {state}, {_tuple(values[count:])}"]


@dataclass(frozen=True)
class _Left:
    """End of a branch of one stage: assigns all values at once, and leaves the stage."""

    names: list[str]

    def __call__(self, values: Sequence[str]) -> list[str]:
        return [*_assigned(self.names, values), "break"]


@dataclass(frozen=True)
class _Moved:
    """End of a branch of `run`: assigns the changed state variables at once, and continues the loop."""

    held: list[str]

    def __call__(self, values: Sequence[str]) -> list[str]:
        return [*_assigned(self.held, values), "continue"]


@dataclass(frozen=True)
class _Ticked:
    """End of a branch of `moving`: assigns the state, yields the fired numbers, and waits for the next row."""

    held: list[str]

    def __call__(self, values: Sequence[str]) -> list[str]:
        return [*_assigned(self.held, values), f"row = yield {_tuple(values[len(self.held) :])}", "continue"]


def _shown(values: Sequence[str]) -> list[str]:
    return [f"return {_tuple(values)}"]


def _assigned(held: Sequence[str], values: Sequence[str]) -> list[str]:
    changed = [(name, value) for name, value in zip(held, values, strict=False) if name != value]
    return [f"{', '.join(name for name, _ in changed)} = {', '.join(value for _, value in changed)}"] if changed else []


def _names(variables: Iterable[Var]) -> dict[Var, str]:
    """Return a Python name for every variable: its letters and digits, with a number if the name is taken already."""
    names: dict[Var, str] = {}
    taken: set[str] = set()
    for var in variables:
        plain = "v_" + "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in var.name)
        name, number = plain, 1
        while name in taken:
            number += 1
            name = f"{plain}_{number}"
        taken.add(name)
        names[var] = name
    return names


def _tuple(values: Iterable[str]) -> str:
    listed = list(values)
    return f"({listed[0]},)" if len(listed) == 1 else f"({', '.join(listed)})"
