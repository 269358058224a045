"""A machine and its world: modes, inputs, state, transitions and outputs, and the physical environment.

One step: read the inputs, take the first transition in declared order whose source is the current mode and whose
guard holds, else stay. All updates read the values before the step. Outputs are terms over the state after it.

A `World` describes the environment. Its ghosts are variables that no device can read, such as the true position. They
move in every step. No transition and no output reads them; only the world's clauses and properties do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Generic, TypeVar

from safeloc.errors import ModelError, declared_at
from safeloc.language.expr import TRUE, Bool, Expr, Lit, Num, NumVar, Optional, Var, members
from safeloc.language.nodes import Value
from safeloc.language.renamed import hint, refuse_old_keywords
from safeloc.language.units import Enumeration
from safeloc.language.world import World


class Any_:
    """Marks an initial value that may be anything in range."""

    def __repr__(self) -> str:
        return "ANY"

    def __reduce__(self) -> str:
        return "ANY"


ANY: Final = Any_()
Initial = Value | Lit | Any_
STAY_NAME: Final = "(stay)"


@refuse_old_keywords(ModelError, {"trace": "requirements"})
@dataclass(frozen=True, eq=False)
class Transition:
    """One row of the transition table.

    Transitions of one `rank` must have disjoint guards (an obligation proves it); of two different ranks the lower
    is tried first. `requirements` holds the ids of the requirements that it implements.
    """

    name: str
    source: Lit | tuple[Lit, ...]
    target: Lit
    when: Bool = TRUE
    set: Mapping[Var, Expr | Value] = field(default_factory=dict)
    requirements: tuple[str, ...] = ()
    rank: int = 0
    src: str = field(default_factory=declared_at)

    @property
    def sources(self) -> tuple[Lit, ...]:
        """The source modes, always as a tuple."""
        return (self.source,) if isinstance(self.source, Lit) else self.source


@dataclass(frozen=True, slots=True)
class Modes(Enumeration):
    """The modes of a machine, with the one variable that holds the current mode."""

    current: NumVar = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        current = NumVar(self.name, self, 0, len(self.members) - 1, None, declared_at())
        object.__setattr__(self, "current", current)


IN_THE_WORLD: Final = {
    "ghosts": "world=World(ghosts=...)",
    "ghost_inputs": "world=World(choices=...)",
    "ghost_moves": "world=World(moves=...)",
    "assumption": "world=World(clauses={name: ...})",
    "clauses": "world=World(clauses={name: ...})",
}
OF_THE_MODES: Final = {
    "mode_variable": "modes=table alone: current_mode(table) is the variable of every machine with these modes"
}


@refuse_old_keywords(ModelError, {**IN_THE_WORLD, **OF_THE_MODES})
@dataclass(frozen=True, eq=False)
class Machine:
    """A state machine, and the world around it. `check`ed when built; a ModelError lists all errors.

    name         used in catalogue, files and reports
    modes        what `modes` made; the first one is the initial mode
    inputs       variables read each step; `Optional` ones may be absent
    state        variable -> initial value (int, bool, member, or ANY in range)
    outputs      name -> term over state and mode, evaluated after the step
    transitions  the table, in order of priority
    world        ghosts, and assumptions on the inputs; a machine without a world is proved for all inputs in range
    initially    condition on the initial values (over state and ghosts)
    lemmas       facts over state and ghosts that help induction; proved themselves, never assumed
    definitions  names for terms that guards and updates are made of, for the reader of tables; no meaning of their own
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
        from safeloc.language.checks.machine import check, check_shape

        check_shape(self)
        fired = Enumeration(f"{self.name}.fired", (STAY_NAME, *(t.name for t in self.transitions)))
        object.__setattr__(self, "mode", current_mode(self.modes))
        object.__setattr__(self, "fired_name", NumVar("fired", fired, 0, len(fired.members) - 1, None, self.src))
        check(self)

    def fired(self, *names: str) -> Bool:
        """In a property: one of the named transitions fired in this step; KeyError for an unknown name."""
        table = self.fired_name.unit
        assert isinstance(table, Enumeration)
        unknown = [name for name in names if name not in table.members]
        if unknown:
            raise KeyError(
                f"{declared_at()}: {self.name} has no transition {unknown}; it has {list(table.members[1:])}."
            )
        return self.fired_name.one_of(*(Lit(table.index(name), table) for name in names))

    def stayed(self) -> Bool:
        """In a property: no transition fired in this step."""
        return self.fired_name.eq(Lit(0, self.fired_name.unit))

    def output(self, name: str) -> Num:
        """Return a numeric output by name; KeyError if there is none, TypeError if it is a truth value."""
        term = self._output(name)
        if not isinstance(term, Num):
            raise TypeError(f"{declared_at()}: output {name!r} of {self.name} is a truth value; use flag().")
        return term

    def flag(self, name: str) -> Bool:
        """Return a truth-valued output by name; KeyError if there is none, TypeError if it is a number."""
        term = self._output(name)
        if not isinstance(term, Bool):
            raise TypeError(f"{declared_at()}: output {name!r} of {self.name} is a number; use output().")
        return term

    def _output(self, name: str) -> Expr:
        if name not in self.outputs:
            has = ", ".join(self.outputs) or "none"
            raise KeyError(
                f"{declared_at()}: {self.name} has no output {name!r}; it has {has}.{hint(name, self.outputs)}"
            )
        return self.outputs[name]


Parts_ = TypeVar("Parts_", covariant=True)


@dataclass(frozen=True, eq=False)
class Model(Generic[Parts_]):
    """A machine together with the variables it was built from, for properties to speak about."""

    machine: Machine
    own: Parts_


def modes(*labels: str) -> tuple[Lit, ...]:
    """Create the modes of a machine, as constants to write transitions with; the first one is the initial mode.

    The variable of the current mode comes with them: `current_mode`. ModelError if two have one label.
    """
    constants, table = members("mode", *labels), Modes("mode", labels)
    return tuple(Lit(constant.value, table) for constant in constants)


def current_mode(modes_: Sequence[Lit]) -> NumVar:
    """Return the mode variable of the machine with these modes, built or yet to be built; ModelError for other constants."""
    table = modes_[0].unit
    if not isinstance(table, Modes):
        raise ModelError(f"{declared_at()}: {modes_[0].label} is no mode; make modes with modes(...).")
    return table.current


MachineFunction = Callable[..., Machine]
