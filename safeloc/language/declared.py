"""The variables of one machine and its world, each declared once: with its role, its range and its first value.

    declared = Declared()
    damped = declared.sensor(boolean("channel_a_damped"))
    axle = declared.state(choice("axle", enumeration(AXLE)), first=NO_AXLE)
    wheel = declared.ghost(number("wheel_um", UM, -BESIDE_UM, BESIDE_UM), first=ANY)
    next_wheel = declared.choice(number("next_wheel_um", UM, -BESIDE_UM, BESIDE_UM))

    Machine(inputs=declared.inputs, state=declared.states, world=World(ghosts=declared.ghosts, choices=declared.choices), ...)

Within a role variables stand in the order in which they were declared. That of inputs and state is the order of the fields in C.
"""

from __future__ import annotations

from typing import TypeVar

from safeloc.errors import ModelError, declared_at
from safeloc.language.expr import BoolVar, NumVar, Optional, Var
from safeloc.language.machine import Initial

Heard = TypeVar("Heard", bound=NumVar | BoolVar | Optional)
Kept = TypeVar("Kept", bound=NumVar | BoolVar)


class Declared:
    """Collects variables by their roles; ModelError for one that has a role already, or the name of another one."""

    def __init__(self) -> None:
        self._inputs: list[Var | Optional] = []
        self._states: dict[Var, Initial] = {}
        self._ghosts: dict[Var, Initial] = {}
        self._choices: list[Var] = []
        self._places: dict[str, str] = {}

    @property
    def inputs(self) -> list[Var | Optional]:
        """What the machine reads in each step."""
        return list(self._inputs)

    @property
    def states(self) -> dict[Var, Initial]:
        """What the machine keeps, with first values."""
        return dict(self._states)

    @property
    def ghosts(self) -> dict[Var, Initial]:
        """What is so in the world and no device reads, with first values."""
        return dict(self._ghosts)

    @property
    def choices(self) -> list[Var]:
        """What the world chooses in each step."""
        return list(self._choices)

    def sensor(self, var: Heard) -> Heard:
        """Give a variable the role of an input: read in each step, of a device, another machine or a person."""
        self._once(var.value if isinstance(var, Optional) else var)
        self._inputs.append(var)
        return var

    def state(self, var: Kept, *, first: Initial) -> Kept:
        """Give a variable the role of state, with its first value: a value in its range, or ANY."""
        self._once(var)
        self._states[var] = first
        return var

    def ghost(self, var: Kept, *, first: Initial) -> Kept:
        """Give a variable the role of a ghost, with its first value; the world's `moves` give it its next ones."""
        self._once(var)
        self._ghosts[var] = first
        return var

    def choice(self, var: Kept) -> Kept:
        """Give a variable the role of a choice: any value in its range, anew in each step, within the world's clauses."""
        self._once(var)
        self._choices.append(var)
        return var

    def _once(self, var: Var) -> None:
        here = declared_at()
        if var.name in self._places:
            raise ModelError(
                f"{here}: {var.name!r} is declared already, at {self._places[var.name]}; a variable has one role and one name."
            )
        self._places[var.name] = here
