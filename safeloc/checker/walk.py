"""Runs of one system in the interpreter; what runs have in common from their beginning on is taken once.

Many results of a report are shown by beginnings of the same recordings, and a step of a large machine takes 10 ms.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping

from safeloc.expr import Var
from safeloc.interpret import Program, read_inputs, start, step
from safeloc.nodes import Value
from safeloc.streams.steps import Cell
from safeloc.system import TransitionSystem, environment

State = Mapping[Var, Value]


class Walk:
    """All states that were come to, each by number, and which one follows which by which inputs."""

    def __init__(self, system: TransitionSystem) -> None:
        self._system = system  # kept, so that no other system gets its identity
        self._allowed = Program([environment(system)])
        self._states: list[State] = []
        self._first: dict[Hashable, int] = {}
        self._after: dict[Hashable, int | None] = {}

    def states(self, first: Mapping[str, Value], stream: Iterable[Mapping[str, Cell]]) -> Iterator[State]:
        """The states of a run as long as it keeps the system's assumption; InputError for no inputs of the system."""
        now = self._begun(first)
        yield self._states[now]
        for record in stream:
            after = self._moved(now, record)
            if after is None:
                return
            now = after
            yield self._states[now]

    def _begun(self, first: Mapping[str, Value]) -> int:
        key = frozenset(first.items())
        if key not in self._first:
            self._first[key] = self._kept(start(self._system, first))
        return self._first[key]

    def _moved(self, now: int, record: Mapping[str, Cell]) -> int | None:
        key = (now, tuple((name, type(cell), cell) for name, cell in record.items()))
        if key not in self._after:
            state, inputs = self._states[now], read_inputs(self._system, record)
            allowed = self._allowed({**state, **inputs})[0]
            self._after[key] = self._kept(step(self._system, state, inputs)[0]) if allowed else None
        return self._after[key]

    def _kept(self, state: State) -> int:
        self._states.append(state)
        return len(self._states) - 1
