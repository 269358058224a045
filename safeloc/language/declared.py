"""The variables of one machine and its world, each declared once: with its role, its range and its first value.

    declared = Declared()
    damped = declared.sensor(boolean("channel_a_damped"))
    axle = declared.state(choice("axle", enumeration(AXLE)), first=NO_AXLE)
    wheel = declared.ghost(number("wheel_um", UM, -BESIDE_UM, BESIDE_UM), first=ANY)
    next_wheel = declared.choice(number("next_wheel_um", UM, -BESIDE_UM, BESIDE_UM))

    world = declared.world({wheel: next_wheel}, clauses)
    declared.machine(name="head", modes=table, outputs=..., transitions=..., world=world)

Machine and world take their variables from here, so none is named twice. Variables of one role are listed in the order of their declarations. For inputs and state this is the order of the fields in C.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from safeloc.errors import ModelError, declared_at
from safeloc.language.expr import TRUE, Bool, BoolVar, Expr, Lit, NumVar, Optional, Var
from safeloc.language.first_values import Initial
from safeloc.language.machine import Machine
from safeloc.language.transition_table import Transition
from safeloc.language.world import Law, World

_Input = TypeVar("_Input", bound=NumVar | BoolVar | Optional)
_Variable = TypeVar("_Variable", bound=NumVar | BoolVar)


class Declared:
    """Collects variables by role; raises ModelError for a second variable of the same name, also for the same one twice."""

    def __init__(self) -> None:
        self._inputs: list[Var | Optional] = []
        self._states: dict[Var, Initial] = {}
        self._ghosts: dict[Var, Initial] = {}
        self._choices: list[Var] = []
        self._places: dict[str, str] = {}

    @property
    def inputs(self) -> list[Var | Optional]:
        """The inputs, which the machine reads in each step."""
        return list(self._inputs)

    @property
    def states(self) -> dict[Var, Initial]:
        """The machine's state variables, with first values."""
        return dict(self._states)

    @property
    def ghosts(self) -> dict[Var, Initial]:
        """The ghosts (variables of the world that no device reads), with first values."""
        return dict(self._ghosts)

    @property
    def choices(self) -> list[Var]:
        """The variables that the world chooses freely in each step."""
        return list(self._choices)

    def sensor(self, var: _Input) -> _Input:
        """Give a variable the role of an input: the machine reads it in each step, from a device, another machine or a person."""
        self._once(var.value if isinstance(var, Optional) else var)
        self._inputs.append(var)
        return var

    def state(self, var: _Variable, *, first: Initial) -> _Variable:
        """Give a variable the role of state, with its first value: a value in its range, or ANY."""
        self._once(var)
        self._states[var] = first
        return var

    def ghost(self, var: _Variable, *, first: Initial) -> _Variable:
        """Give a variable the role of a ghost, with its first value; the world's `moves` define its next values."""
        self._once(var)
        self._ghosts[var] = first
        return var

    def choice(self, var: _Variable) -> _Variable:
        """Give a variable the role of a choice: in each step the world picks any value in range that its clauses allow."""
        self._once(var)
        self._choices.append(var)
        return var

    def world(self, moves: Mapping[Var, Expr], clauses: Mapping[str, Bool | Law], reads_machine: str = "") -> World:
        """Return the world with the ghosts and choices that were declared; the rest as in `World`."""
        return World(self.ghosts, self.choices, moves, clauses, reads_machine)

    def machine(
        self,
        *,
        name: str,
        modes: Sequence[Lit],
        outputs: Mapping[str, Expr],
        transitions: Sequence[Transition],
        world: World | None = None,
        initially: Bool = TRUE,
        lemmas: Mapping[str, Bool] | None = None,
        definitions: Mapping[str, Expr] | None = None,
        doc: str = "",
    ) -> Machine:
        """Return the machine with the inputs and the state that were declared; the rest as in `Machine`."""
        return Machine(
            name,
            modes,
            self.inputs,
            self.states,
            outputs,
            transitions,
            World() if world is None else world,
            initially,
            {} if lemmas is None else lemmas,
            {} if definitions is None else definitions,
            doc,
        )

    def _once(self, var: Var) -> None:
        here = declared_at()
        if var.name in self._places:
            raise ModelError(
                f"{here}: {var.name!r} is already declared at {self._places[var.name]}; declare each variable once, under a "
                "name of its own."
            )
        self._places[var.name] = here
