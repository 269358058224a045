"""A target made ready to run: generated code, the inputs that records stand for, and what identifies it.

A program holds no state: any number of controllers, in any threads, share one.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from safeloc.backends.compiled import Compiled, Row, compile_system
from safeloc.border import Channel, Fault, Reason
from safeloc.digest import declaration_digest
from safeloc.embedding.entries import Entry, Told, beginnings, entries_of, limits, routes_of
from safeloc.embedding.report import Interval, Move, Report
from safeloc.errors import InputError
from safeloc.expr import Num, NumVar
from safeloc.machine import Machine
from safeloc.nodes import Value
from safeloc.system import TransitionSystem, canonical, without_ghosts
from safeloc.target import Target
from safeloc.units import Enumeration


@dataclass(frozen=True, eq=False)
class Part:
    """One machine of the program: where its mode stands in the state, its labels, and its moves.

    moves   number of a transition (from 1), mode before, mode after -> what is told of it
    """

    machine: Machine
    name: str
    mode_at: int
    modes: tuple[str, ...]
    moves: Mapping[tuple[int, int, int], Move]


class Program:
    """What runs on board of a target: no ghosts, no assumption."""

    def __init__(self, target: Target) -> None:
        self.target = target
        self.system: TransitionSystem = without_ghosts(target.system)
        self.code: Compiled = compile_system(self.system)
        self.entries: Mapping[str, Entry] = entries_of(self.system)
        self.routes: Mapping[str, tuple[Entry, ...]] = routes_of(self.entries, target.said)
        self.named: Mapping[str, tuple[Entry, ...]] = {
            name: tuple(entry for entry in routed if entry.is_named) for name, routed in self.routes.items()
        }
        self.channels: Sequence[Channel] = [
            limit for name, routed in self.routes.items() if (limit := limits(name, routed)) is not None
        ]
        self.channel_names = frozenset(part for name in self.routes for part in beginnings(name))
        self.parts = tuple(_part(self.system, machine) for machine in self.system.machines)
        self.labels: Mapping[str, tuple[str, ...]] = {
            name: term.unit.members
            for name, term in self.system.outputs.items()
            if isinstance(term, Num) and isinstance(term.unit, Enumeration)
        }
        self._flags = {entry.at: entry.present_at for entry in self.entries.values()}
        self._names = frozenset(self.entries)
        self._absent = tuple(canonical(var) if isinstance(var, NumVar) else False for var in self.system.inputs)

    @property
    def name(self) -> str:
        """The target's name."""
        return self.target.name

    def first(self, chosen: Mapping[str, Value] | None = None) -> Row:
        """The first state; InputError as `interpret.start`."""
        return self.code.first(chosen) if chosen else self._first

    @cached_property
    def _first(self) -> Row:
        return self.code.first()

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """Inputs that must be there in every cycle: the machine has no way of being told that they are missing."""
        return tuple(name for name, entry in self.entries.items() if entry.present_at is None)

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of what the declaration means on board: variables, first values, moves and outputs."""
        return declaration_digest(self.system)

    @cached_property
    def config(self) -> Mapping[str, Any]:
        """The configuration as plain data; empty for a machine without one."""
        return {} if self.target.config is None else self.target.config.model_dump(mode="json")

    @cached_property
    def silent(self) -> Mapping[str, tuple[frozenset[int], frozenset[int]]]:
        """Machine that may be told nothing -> places of its inputs, and of those that cannot be absent one by one."""
        needed = {self.entries[name].at for name in self.needed}
        several = len(self.system.machines) > 1
        own = {
            name: frozenset(
                entry.at for full, entry in self.entries.items() if not several or full.startswith(f"{name}.")
            )
            for name in self.target.silent
        }
        return {name: (inputs, inputs & needed) for name, inputs in own.items() if inputs & needed}

    def heard(self, told: Told) -> tuple[Told, tuple[Fault, ...]]:
        """Without the machines of which something needed is missing, where they may be told nothing.

        A fault tells of each that was told something, and not enough; of one that was told nothing there is nothing to tell.
        """
        faults: list[Fault] = []
        for name, (inputs, needed) in self.silent.items():
            if not needed <= told.keys() and not inputs.isdisjoint(told):
                lacking = min(self.system.inputs[at].name for at in needed if at not in told)
                faults.append(Fault(name, Reason.MISSING, f"{lacking}; nothing else of {name} is used"))
                told = {at: value for at, value in told.items() if at not in inputs}
        return told, tuple(faults)

    def require_known(self, inputs: Collection[str]) -> None:
        """InputError for a name that is no input."""
        if self._names.issuperset(inputs):
            return
        unknown = [name for name in inputs if name not in self.entries]
        if unknown:
            close = difflib.get_close_matches(str(unknown[0]), self.entries, 1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise InputError(f"{self.name} has no input {unknown[0]!r}; it has {', '.join(self.entries)}.{hint}")

    def missing(self, told: Told) -> list[str]:
        """Needed inputs that are not given, of machines that cannot be told nothing."""
        return [name for name, at in self._always_needed if at not in told]

    @cached_property
    def _always_needed(self) -> list[tuple[str, int]]:
        spared = {at for _, needed in self.silent.values() for at in needed}
        places = [(name, self.entries[name].at) for name in self.needed]
        return [(name, at) for name, at in places if at not in spared]

    def row(self, told: Told) -> Row:
        """The inputs of one step; what is not given is absent, or neutral where it cannot be absent."""
        row, flags = list(self._absent), self._flags
        for at, value in told.items():
            row[at] = value
            present_at = flags[at]
            if present_at is not None:
                row[present_at] = True
        return tuple(row)

    def moves(self, fired: Sequence[int], before: Row, after: Row) -> tuple[Move, ...]:
        """The transitions that fired."""
        return tuple(
            [
                part.moves[number, before[part.mode_at], after[part.mode_at]]
                for part, number in zip(self.parts, fired, strict=True)
                if number
            ]
        )

    def modes(self, state: Row) -> dict[str, str]:
        """Machine -> label of its mode."""
        return {part.name: part.modes[int(state[part.mode_at])] for part in self.parts}

    def interval(self, values: Mapping[str, Value]) -> Interval | None:
        """What these outputs report."""
        if self.target.reported is None:
            return None
        ends = self.target.reported.interval_mm(values)
        return None if ends is None else Interval(*ends)

    def quiet(self, first: Row) -> bool:
        """Whether this first state claims no place: then beginning anew is always safe."""
        return self.target.reported is not None and self.interval(self.code.named_outputs(first)) is None

    def report(
        self, state: Row, moves: tuple[Move, ...], number: int, end_ms: int, faults: tuple[Fault, ...], anew: str,
        truth_mm: int | None,
    ) -> Report:  # fmt: skip
        """What holds in this state at the end of that cycle."""
        values = self.code.named_outputs(state)
        reported = self.target.reported
        standing = None if reported is None or truth_mm is None else reported.standing(values, truth_mm)
        return Report(
            self.name, number, end_ms, self.modes(state), moves, values, self.labels, self.interval(values), faults,
            anew, standing,
        )  # fmt: skip


def _part(system: TransitionSystem, machine: Machine) -> Part:
    names = [var.name for var in system.state]
    own = f"{machine.name}.mode"
    assert isinstance(machine.mode.unit, Enumeration)
    labels = machine.mode.unit.members
    moves = {
        (number, source.value, one.target.value): Move(
            machine.name, one.name, source.label, one.target.label, one.trace
        )
        for number, one in enumerate(machine.transitions, 1)
        for source in one.sources
    }
    return Part(machine, machine.name, names.index(own if own in names else "mode"), labels, moves)
