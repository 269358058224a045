"""A recorded run: the first state, then the inputs, fired transitions, state and outputs of every step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

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

    @property
    def length(self) -> int:
        """The number of steps."""
        return len(self.steps)

    def stream(self) -> list[dict[str, Value]]:
        """Return the inputs of every step, without absent optional inputs, as `interpret.run` takes them."""
        return [present_inputs(self.system, step.inputs) for step in self.steps]

    def _repr_html_(self) -> str:
        from safeloc.language.html_views import trace_html  # it reads traces

        return trace_html(self)

    def table(self, limit: int = 60) -> str:
        """Return the run as plain text, one line a step, with what changed since the line before.

        The first state and the last step are shown in full, the last one with the inputs that came before and are absent in it. Of a run longer than `limit`, the first steps, those that fire
        something else than the step before, and the last ones are shown; a line tells how many are left out between.
        """
        lines = [f"   0  start  {_row(self.system, self.initial)}"]
        inputs, state, before, came_before = dict[str, Value](), self.initial, 0, dict[str, Value]()
        for number in self.shown_steps(limit):
            step, full = self.steps[number - 1], number == len(self.steps)
            if number > before + 1:
                lines.append(_left_out(self.steps[before : number - 1]))
            came = present_inputs(self.system, step.inputs)
            both = ((came, inputs), (step.state, state))
            new_inputs, new_state = (_row(self.system, new if full else _changed(new, old)) for new, old in both)
            gone = "".join(f" no {name}" for name in (came_before if full else inputs) if name not in came)
            lines.append(f"{number:4}  {_fired(step)}  [{f'{new_inputs}{gone}'.strip()}]  {new_state}".rstrip())
            inputs, state, before, came_before = came, step.state, number, came_before | came
        return "\n".join(lines)

    def shown_steps(self, limit: int) -> list[int]:
        """Return the numbers of the steps that a table shows."""
        count = len(self.steps)
        if count <= limit:
            return list(range(1, count + 1))
        first, last = max(1, limit // 10), max(1, limit // 5)
        ends = [*range(1, 1 + first), *range(count + 1 - last, count + 1)]
        other = [
            number
            for number, (before, step) in enumerate(pairwise(self.steps), 2)
            if step.fired != before.fired and number not in ends
        ]
        room = max(0, limit - len(ends))
        return sorted([*ends, *other[max(0, len(other) - room) :]])


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


def _fired(step: Step) -> str:
    return ", ".join(step.fired.values())


def _left_out(steps: Sequence[Step]) -> str:
    """Return a line for steps that a table does not show: their number, and what they fire if all fire the same."""
    fired = {_fired(step) for step in steps}
    return f"      ... {len(steps)} more steps{f': {fired.pop()}' if len(fired) == 1 else ''}"


def _changed(values: Mapping[str, Value], before: Mapping[str, Value]) -> dict[str, Value]:
    return {name: value for name, value in values.items() if name not in before or before[name] != value}


def _row(system: TransitionSystem, values: Mapping[str, Value]) -> str:
    return " ".join(f"{name}={shown(system.variable(name), value)}" for name, value in values.items())
