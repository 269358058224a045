"""A machine and its world: modes, inputs, state, transitions and outputs, and the physical environment.

In one step the machine reads the inputs and takes the first transition, in declared order, whose source is the current
mode and whose guard holds; otherwise it stays. All updates read the values before the step. Outputs are terms over the
state after it.

A `World` describes the environment. Its ghosts are variables that no device can read, such as the true position. They
move in every step. Transitions and outputs must not read them; the world, `initially`, lemmas and properties may.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Generic, TypeVar

from safeloc.errors import ModelError, UnknownNameError, declared_at
from safeloc.language.checks.machine import check, check_shape
from safeloc.language.expr import TRUE, Bool, Expr, Lit, Num, NumVar, Optional, Var
from safeloc.language.first_values import ANY, Any_, Initial
from safeloc.language.renamed import check_keywords, hint
from safeloc.language.transition_table import STAY_NAME, Modes, Transition, current_mode, modes
from safeloc.language.units import Enumeration
from safeloc.language.world import World

__all__ = ["ANY", "STAY_NAME", "Any_", "Initial", "Machine", "Model", "Modes", "Transition", "current_mode", "modes"]

_IN_THE_WORLD: Final = {
    "ghosts": "world=World(ghosts=...)",
    "ghost_inputs": "world=World(choices=...)",
    "ghost_moves": "world=World(moves=...)",
    "assumption": "world=World(clauses={name: ...})",
    "clauses": "world=World(clauses={name: ...})",
}
_OF_THE_MODES: Final = {
    "mode_variable": "modes=table alone: current_mode(table) is the variable of every machine with these modes"
}


@check_keywords(ModelError, {**_IN_THE_WORLD, **_OF_THE_MODES})
@dataclass(frozen=True, eq=False)
class Machine:
    """A state machine, and the world around it. It is checked when built; a ModelError lists all errors.

    name         used in catalogue, files and reports
    modes        the result of the function `modes`; the first one is the initial mode
    inputs       variables that the machine reads in each step; `Optional` ones may be absent
    state        variable -> initial value (int, bool, member, or ANY in range)
    outputs      name -> term over state and mode, evaluated after the step
    transitions  the table, in order of priority
    world        ghosts, and assumptions on the inputs; a machine without a world is proved for all inputs in range
    initially    condition on the initial values (over state and ghosts)
    lemmas       auxiliary invariants over state and ghosts that help induction; proved themselves, never assumed
    definitions  names for terms of guards and updates, shown in tables; they change neither the machine nor any proof
    doc          one paragraph for the reader of the report
    """

    name: str
    modes: Sequence[Lit]
    inputs: Sequence[Var | Optional]
    state: Mapping[Var, Initial]
    outputs: Mapping[str, Expr]
    transitions: Sequence[Transition]
    world: World = field(default_factory=World)
    initially: Bool = TRUE
    lemmas: Mapping[str, Bool] = field(default_factory=dict)
    definitions: Mapping[str, Expr] = field(default_factory=dict)
    doc: str = ""
    src: str = field(default_factory=declared_at)
    mode: NumVar = field(init=False)
    fired_name: NumVar = field(init=False)

    def __post_init__(self) -> None:
        check_shape(self)
        fired = Enumeration(f"{self.name}.fired", (STAY_NAME, *(t.name for t in self.transitions)))
        object.__setattr__(self, "mode", current_mode(self.modes))
        object.__setattr__(self, "fired_name", NumVar("fired", fired, 0, len(fired.members) - 1, None, self.src))
        check(self)

    def _repr_html_(self) -> str:
        from safeloc.language.html_views import machine_html  # it reads runs, which know machines

        return machine_html(self)

    def fired(self, *names: str) -> Bool:
        """Return, for use in a property, that one of these transitions fired in this step; UnknownNameError if there is no such
        transition."""
        table = self.fired_name.unit
        assert isinstance(table, Enumeration)
        unknown = [name for name in names if name not in table.members]
        if unknown:
            raise UnknownNameError(
                f"{declared_at()}: {self.name} has no transition {unknown}; it has {list(table.members[1:])}."
                f"{hint(unknown[0], table.members[1:])}"
            )
        return self.fired_name.one_of(*(Lit(table.index(name), table) for name in names))

    def stayed(self) -> Bool:
        """Return, for use in a property, that no transition fired in this step."""
        return self.fired_name.eq(Lit(0, self.fired_name.unit))

    def output(self, name: str) -> Num:
        """Return a numeric output by name; UnknownNameError if there is none, TypeError if it is a truth value."""
        term = self._output(name)
        if not isinstance(term, Num):
            raise TypeError(f"{declared_at()}: output {name!r} of {self.name} is a truth value; use flag().")
        return term

    def flag(self, name: str) -> Bool:
        """Return a truth-valued output by name; UnknownNameError if there is none, TypeError if it is a number."""
        term = self._output(name)
        if not isinstance(term, Bool):
            raise TypeError(f"{declared_at()}: output {name!r} of {self.name} is a number; use output().")
        return term

    def _output(self, name: str) -> Expr:
        if name not in self.outputs:
            has = ", ".join(self.outputs) or "none"
            raise UnknownNameError(
                f"{declared_at()}: {self.name} has no output {name!r}; it has {has}.{hint(name, self.outputs)}"
            )
        return self.outputs[name]


_Parts = TypeVar("_Parts", covariant=True)


@dataclass(frozen=True, eq=False)
class Model(Generic[_Parts]):
    """A machine together with its own variables, `own`, which properties of it read."""

    machine: Machine
    own: _Parts

    def in_mode(self, *labels: str) -> Bool:
        """Return that the machine is in one of the named modes; UnknownNameError if it has no such mode."""
        mode = self.machine.mode
        table = mode.unit
        assert isinstance(table, Enumeration)
        unknown = [label for label in labels if label not in table.members]
        if unknown:
            raise UnknownNameError(
                f"{declared_at()}: {self.machine.name} has no mode {unknown[0]!r}; it has {list(table.members)}."
                f"{hint(unknown[0], table.members)}"
            )
        return mode.one_of(*(Lit(table.index(label), table) for label in labels))
