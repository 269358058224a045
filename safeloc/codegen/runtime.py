"""Embedding through the `transitions` package: a host's own object becomes a state machine it can subscribe to.

The host calls one trigger a step, `tick(**inputs)`. States are the mode labels; callbacks such as
`on_enter_DELOCALIZED` (or `on_enter_delocalized`) on the host's object are called as in any `transitions` machine, also with awaitable
ones in the asynchronous variant. There are no `to_X` triggers: no mode is entered except through its guards.

A row of the transition table from a mode to itself is an internal step: it changes values, but nothing is left or
entered, so no callback runs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from transitions import Machine as Fsm
from transitions.core import EventData
from transitions.extensions.asyncio import AsyncMachine

from safeloc.codegen.compiled import Compiled, Row, compile_system
from safeloc.errors import InputError
from safeloc.language.machine import Machine
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts

TRIGGER = "tick"


class Embedded:
    """The values behind a host's state machine: what the last tick read, did and reports.

    fsm     the `transitions` machine
    model   the host's object, which got `tick`, `state` and `is_<MODE>`
    """

    def __init__(self, machine: Machine, model: object, chosen: Mapping[str, Value] | None, asynchronous: bool) -> None:
        self.machine, self.model = machine, model
        self._code: Compiled = compile_system(without_ghosts(lower(machine)))
        self._labels = tuple(mode.label for mode in machine.modes)
        self._now: Row = self._code.first(chosen)
        self._next: Row = self._now
        self._fired = 0
        _refuse_clash(model, self._labels)
        kind = AsyncMachine if asynchronous else Fsm
        self.fsm = kind(
            model=model,
            states=_states(self._labels, model),
            initial=self._labels[0],
            auto_transitions=False,
            ignore_invalid_triggers=False,
            send_event=True,
        )
        for number, label in enumerate(self._labels):
            self._add(number, label)

    def _add(self, number: int, label: str) -> None:
        """From each mode: stay without leaving it, or go to another mode."""
        self.fsm.add_transition(TRIGGER, label, None, conditions=self._reads_and_stays(number), after=self._commit)
        for target, other in enumerate(self._labels):
            if target != number:
                self.fsm.add_transition(TRIGGER, label, other, conditions=self._goes_to(target), before=self._commit)

    def _reads_and_stays(self, number: int) -> Callable[[EventData], bool]:
        """Takes the step's inputs and computes the step; nothing is changed yet. Whether the mode stays."""

        def reads_and_stays(event: EventData) -> bool:
            if event.args:
                raise InputError(f"{self.machine.name}: tick takes inputs by name, got {event.args!r}.")
            self._next, fired = self._code.step(self._now, self._code.read(event.kwargs))
            self._fired = fired[0]
            return self._next[0] == number

        return reads_and_stays

    def _goes_to(self, target: int) -> Callable[[EventData], bool]:
        return lambda _event: self._next[0] == target

    def _commit(self, _event: EventData) -> None:
        self._now = self._next

    @property
    def values(self) -> dict[str, Value]:
        """State variables after the last tick, by name."""
        return dict(zip(self._code.state_names, self._now, strict=True))

    @property
    def outputs(self) -> dict[str, Value]:
        """Outputs after the last tick, by name."""
        return self._code.named_outputs(self._now)

    @property
    def fired(self) -> str:
        """The row of the transition table that the last tick took."""
        return self._code.fired([self._fired])["fired"]


def to_fsm(machine: Machine, model: object, *, first: Mapping[str, Value] | None = None) -> Embedded:
    """Make `model` a state machine with the trigger `tick(**inputs)`.

    first   values for state variables declared ANY
    Raises InputError where `model` already has an attribute that a mode or the trigger needs; `tick` raises it for
    inputs that the interpreter refuses, and nothing is changed then.
    """
    return Embedded(machine, model, first, asynchronous=False)


def to_async_fsm(machine: Machine, model: object, *, first: Mapping[str, Value] | None = None) -> Embedded:
    """The same with an awaitable `tick`; callbacks may be coroutines."""
    return Embedded(machine, model, first, asynchronous=True)


FOLLOW = "follow_machine"


class Follower:
    """A host's object that follows a machine which runs elsewhere: entering and leaving modes calls its callbacks."""

    def __init__(self, machine: Machine, model: object) -> None:
        self._labels = tuple(mode.label for mode in machine.modes)
        self._wanted = self._labels[0]
        _refuse_clash(model, self._labels, FOLLOW)
        self._model = model
        self._fsm = Fsm(
            model=model,
            states=_states(self._labels, model),
            initial=self._labels[0],
            auto_transitions=False,
            ignore_invalid_triggers=False,
            send_event=True,
        )
        for label in self._labels:
            others: list[Any] = [other for other in self._labels if other != label]
            self._fsm.add_transition(FOLLOW, others, label, conditions=self._goes_to(label))

    def _goes_to(self, label: str) -> Callable[[EventData], bool]:
        return lambda _event: self._wanted == label

    def enter(self, label: str, **told: object) -> None:
        """Go to another mode; callbacks find `told` in their event's kwargs. In the mode already: nothing happens."""
        self._wanted = label
        if self._model.state != label:  # type: ignore[attr-defined] # `transitions` gave it the attribute
            getattr(self._model, FOLLOW)(**told)

    def place(self, label: str) -> None:
        """Stand in a mode without having entered it: no callback is called."""
        self._fsm.set_state(label)


def _states(labels: tuple[str, ...], model: object) -> list[dict[str, Any]]:
    """States with the host's callbacks in either spelling. `transitions` by itself finds bound methods only."""
    states = []
    for label in labels:
        state: dict[str, Any] = {"name": label}
        for moment in ("on_enter", "on_exit"):
            spellings = dict.fromkeys((f"{moment}_{label.lower()}", f"{moment}_{label}"))
            state[moment] = [name for name in spellings if callable(getattr(model, name, None))]
        states.append(state)
    return states


def _refuse_clash(model: object, labels: tuple[str, ...], trigger: str = TRIGGER) -> None:
    taken = [name for name in (trigger, "state", *(f"is_{label}" for label in labels)) if hasattr(model, name)]
    if taken:
        raise InputError(f"the host object already has {taken}; they would be replaced. Give it other names.")
