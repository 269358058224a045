"""A host's object as a state machine of the `transitions` package that follows a controller's machine.

States are the mode labels; callbacks such as `on_enter_DELOCALIZED` (or `on_enter_delocalized`) on the host's object are
called as in any `transitions` machine. There are no `to_X` triggers: the object enters a mode only because the controller's
machine, whose inputs passed the border, entered it.

A transition from a mode to itself changes values, but leaves and enters nothing, so no callback runs.
"""

from __future__ import annotations

from collections.abc import Callable
from inspect import iscoroutinefunction
from typing import Any

from transitions import Machine as Fsm
from transitions.core import EventData

from safeloc.errors import InputError
from safeloc.language.machine import Machine
from safeloc.language.renamed import hint

_FOLLOW = "follow_machine"
"""The only trigger that the host's object gets; only its follower uses it."""
_MOMENTS = ("on_enter", "on_exit")


class Follower:
    """A host's object that follows a machine: entering and leaving a mode calls the object's callbacks.

    InputError if the object already has an attribute that a mode or the trigger needs, and for callbacks that would have to
    be awaited.
    """

    def __init__(self, machine: Machine, model: object) -> None:
        self._labels = tuple(mode.label for mode in machine.modes)
        self._wanted = self._labels[0]
        _refuse_clash(model, self._labels)
        _refuse_strange_callbacks(model, self._labels)
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
            self._fsm.add_transition(_FOLLOW, others, label, conditions=self._goes_to(label))

    def _goes_to(self, label: str) -> Callable[[EventData], bool]:
        return lambda _event: self._wanted == label

    def enter(self, label: str, **details: object) -> None:
        """Enter a mode; callbacks find `details` in their event's kwargs. Do nothing if the object is in this mode."""
        self._wanted = label
        if self._model.state != label:  # type: ignore[attr-defined] # `transitions` gave it the attribute
            getattr(self._model, _FOLLOW)(**details)

    def place(self, label: str) -> None:
        """Set the mode without calling callbacks."""
        self._fsm.set_state(label)


def _states(labels: tuple[str, ...], model: object) -> list[dict[str, Any]]:
    """Return the states with the host's callbacks in either spelling; `transitions` alone would find bound methods only."""
    states = []
    for label in labels:
        state: dict[str, Any] = {"name": label}
        for moment in _MOMENTS:
            spellings = dict.fromkeys((f"{moment}_{label.lower()}", f"{moment}_{label}"))
            state[moment] = [name for name in spellings if _is_callback(model, name)]
        states.append(state)
    return states


def _is_callback(model: object, name: str) -> bool:
    callback = getattr(model, name, None)
    if iscoroutinefunction(callback) or iscoroutinefunction(getattr(callback, "__call__", None)):  # noqa: B004
        raise InputError(
            f"{name} of the host object is a coroutine function, but a step does not await callbacks. Make it a plain "
            "function that starts a task, or let a listener put each report into a queue."
        )
    return callable(callback)


def _refuse_strange_callbacks(model: object, labels: tuple[str, ...]) -> None:
    """Refuse a callback of no mode: it would never be called."""
    known = {f"{moment}_{name}" for moment in _MOMENTS for label in labels for name in (label, label.lower())}
    for name in dir(model):
        if (
            name.startswith(tuple(f"{moment}_" for moment in _MOMENTS))
            and name not in known
            and _is_callback(model, name)
        ):
            modes = ", ".join(labels)
            raise InputError(f"{name} of the host object belongs to no mode; the modes are {modes}.{hint(name, known)}")


def _refuse_clash(model: object, labels: tuple[str, ...]) -> None:
    taken = [name for name in (_FOLLOW, "state", *(f"is_{label}" for label in labels)) if hasattr(model, name)]
    if taken:
        raise InputError(f"the host object already has {taken}, which would be replaced; rename them.")
