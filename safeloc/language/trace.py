"""A recorded run: the first state, then the inputs, fired transitions, state and outputs of every step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.expr import NumVar, Var
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.units import Enumeration


@dataclass(frozen=True)
class Step:
    """One step of a run, with the state and outputs after it. Keys are names; members of enumerations are numbers."""

    inputs: Mapping[str, Value]
    fired: Mapping[str, str]
    state: Mapping[str, Value]
    outputs: Mapping[str, Value]


@dataclass(frozen=True)
class Trace:
    """A run of `system`: the first state and all steps."""

    system: TransitionSystem
    initial: Mapping[str, Value]
    steps: tuple[Step, ...]

    def stream(self) -> list[dict[str, Value]]:
        """Return the inputs of every step, without absent optional inputs, as `interpret.run` takes them."""
        return [present_inputs(self.system, step.inputs) for step in self.steps]

    def table(self, limit: int = 60) -> str:
        """Return the first state and the last `limit` steps as plain text, one line a step."""
        lines = [f"   0  start  {_row(self.system, self.initial)}"]
        for number, step in enumerate(self.steps, 1):
            fired = ", ".join(name for name in step.fired.values())
            inputs = _row(self.system, present_inputs(self.system, step.inputs))
            lines.append(f"{number:4}  {fired}  [{inputs}]  {_row(self.system, step.state)}")
        return "\n".join(lines[:1] + lines[1:][-limit:])


def present_inputs(system: TransitionSystem, inputs: Mapping[str, Value]) -> dict[str, Value]:
    """Return the inputs of one step without presence flags and without absent optional inputs."""
    hidden = {option.present.name for option in system.optionals}
    hidden |= {option.value.name for option in system.optionals if not inputs[option.present.name]}
    return {name: value for name, value in inputs.items() if name not in hidden}


def shown(var: Var, value: Value) -> str:
    """Return a value as text for a person: a member's label, true or false, or the number."""
    if isinstance(var, NumVar) and isinstance(var.unit, Enumeration):
        return var.unit.members[value] if value < len(var.unit.members) else f"{value}, no member"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _row(system: TransitionSystem, values: Mapping[str, Value]) -> str:
    return " ".join(f"{name}={shown(system.variable(name), value)}" for name, value in values.items())
