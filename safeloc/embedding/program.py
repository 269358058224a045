"""A target made ready to run: generated code, the inputs that records stand for, and what identifies it.

A program holds no state: any number of controllers, in any threads, share one.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from safeloc.backends.compiled import Compiled, Row, compile_system
from safeloc.border import Channel, Fault, Reason
from safeloc.digest import declaration_digest
from safeloc.embedding.report import Interval, Move, Report
from safeloc.errors import InputError
from safeloc.expr import BoolVar, Num, NumVar, Var
from safeloc.machine import Machine
from safeloc.nodes import Value
from safeloc.system import TransitionSystem, canonical, without_ghosts
from safeloc.target import Target
from safeloc.units import Enumeration


@dataclass(frozen=True, eq=False)
class Part:
    """One machine of the program: where its mode stands in the state, and its labels."""

    machine: Machine
    name: str
    mode_at: int
    modes: tuple[str, ...]
    moves: Mapping[tuple[int, int, int], Move]

    def move(self, fired: int, before: Row, after: Row) -> Move:
        """The transition of that number (from 1), with the modes it went between."""
        return self.moves[fired, int(before[self.mode_at]), int(after[self.mode_at])]


class Program:
    """What runs on board of a target: no ghosts, no assumption."""

    def __init__(self, target: Target) -> None:
        self.target = target
        self.system: TransitionSystem = without_ghosts(target.system)
        self.code: Compiled = compile_system(self.system)
        self.routes: Mapping[str, tuple[Var, ...]] = _routes(self.system, target.said)
        self.channels: Sequence[Channel] = [
            limit for name, variables in self.routes.items() if (limit := _limits(name, variables)) is not None
        ]
        self.channel_names = frozenset(part for name in self.routes for part in _beginnings(name))
        self.parts = tuple(_part(self.system, machine) for machine in self.system.machines)
        self.labels: Mapping[str, tuple[str, ...]] = {
            name: term.unit.members
            for name, term in self.system.outputs.items()
            if isinstance(term, Num) and isinstance(term.unit, Enumeration)
        }
        self._at = {var: number for number, var in enumerate(self.system.inputs)}
        self._present: dict[Var, Var] = {option.value: option.present for option in self.system.optionals}
        self._places = {
            var: (at, self._at[self._present[var]] if var in self._present else None) for var, at in self._at.items()
        }
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
    def by_name(self) -> Mapping[str, Var]:
        """Inputs by their full names, presence flags apart: these follow from the values."""
        flags = set(self._present.values())
        return {var.name: var for var in self.system.inputs if var not in flags}

    @cached_property
    def named(self) -> Mapping[str, tuple[Var, ...]]:
        """Name in a record -> those of its inputs that are truth values or members."""
        return {name: tuple(var for var in routed if _is_named(var)) for name, routed in self.routes.items()}

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """Inputs that must be there in every cycle: the machine has no way of being told that they are missing."""
        return tuple(name for name, var in self.by_name.items() if var not in self._present)

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of what the declaration means on board: variables, first values, moves and outputs."""
        return declaration_digest(self.system)

    @cached_property
    def config(self) -> Mapping[str, Any]:
        """The configuration as plain data; empty for a machine without one."""
        return {} if self.target.config is None else self.target.config.model_dump(mode="json")

    @cached_property
    def silent(self) -> Mapping[str, tuple[frozenset[Var], frozenset[Var]]]:
        """Machine that may be told nothing -> its inputs, and those of them that cannot be absent one by one."""
        needed = {self.by_name[name] for name in self.needed}
        several = len(self.system.machines) > 1
        own = {
            name: frozenset(var for var in self._at if not several or var.name.startswith(f"{name}."))
            for name in self.target.silent
        }
        return {name: (inputs, inputs & needed) for name, inputs in own.items() if inputs & needed}

    def heard(self, values: Mapping[Var, Value]) -> tuple[Mapping[Var, Value], tuple[Fault, ...]]:
        """Without the machines of which something needed is missing, where they may be told nothing.

        A fault tells of each that was told something, and not enough; of one that was told nothing there is nothing to tell.
        """
        faults: list[Fault] = []
        for name, (inputs, needed) in self.silent.items():
            missing = [var.name for var in needed if var not in values]
            told = [var for var in inputs if var in values]
            if missing and told:
                faults.append(Fault(name, Reason.MISSING, f"{min(missing)}; nothing else of {name} is used"))
                values = {var: value for var, value in values.items() if var not in inputs}
        return values, tuple(faults)

    def require_known(self, inputs: Iterable[str]) -> None:
        """InputError for a name that is no input."""
        unknown = [name for name in inputs if name not in self.by_name]
        if unknown:
            close = difflib.get_close_matches(str(unknown[0]), self.by_name, 1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise InputError(f"{self.name} has no input {unknown[0]!r}; it has {', '.join(self.by_name)}.{hint}")

    def missing(self, values: Mapping[Var, Value]) -> list[str]:
        """Needed inputs that are not given, of machines that cannot be told nothing."""
        return [name for name, var in self._always_needed if var not in values]

    @cached_property
    def _always_needed(self) -> list[tuple[str, Var]]:
        spared = {var.name for _, needed in self.silent.values() for var in needed}
        return [(name, self.by_name[name]) for name in self.needed if name not in spared]

    def held(self, var: Var, value: int | str) -> Value:
        """An admitted value as the variable holds it: a member's number instead of its label."""
        if isinstance(value, str):
            assert isinstance(var, NumVar) and isinstance(var.unit, Enumeration)
            return var.unit.index(value)
        return value

    def row(self, values: Mapping[Var, Value]) -> Row:
        """The inputs of one step; what is not given is absent, or neutral where it cannot be absent."""
        row = list(self._absent)
        for var, value in values.items():
            at, present_at = self._places[var]
            row[at] = value
            if present_at is not None:
                row[present_at] = True
        return tuple(row)

    def moves(self, fired: Sequence[int], before: Row, after: Row) -> tuple[Move, ...]:
        """The transitions that fired."""
        return tuple(part.move(number, before, after) for part, number in zip(self.parts, fired, strict=True) if number)

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


def _routes(system: TransitionSystem, said: Mapping[str, str]) -> dict[str, tuple[Var, ...]]:
    """Name in a record -> inputs: its own, or in a composition those of every machine that has one of that name.

    said   further names for inputs
    """
    flags = {option.present for option in system.optionals}
    routes: dict[str, tuple[Var, ...]] = {}
    for var in system.inputs:
        if var not in flags:
            for name in dict.fromkeys((var.name, var.name.rpartition(".")[2])):
                routes[name] = (*routes.get(name, ()), var)
    for name, other in said.items():
        routes[name] = (*routes.get(name, ()), *routes[other])
    return routes


def _is_named(var: Var) -> bool:
    return isinstance(var, BoolVar) or isinstance(var.unit, Enumeration)


def _limits(name: str, variables: Sequence[Var]) -> Channel | None:
    """The range that all of these inputs have in common; None where they are no plain numbers."""
    numbers = [var for var in variables if isinstance(var, NumVar) and not isinstance(var.unit, Enumeration)]
    if len(numbers) < len(variables):
        return None
    low, high = max(var.low for var in numbers), min(var.high for var in numbers)
    if low > high or not all(var.unit.same(numbers[0].unit) for var in numbers):
        raise InputError(f"inputs {[var.name for var in variables]} share the name {name!r} but no range and unit.")
    return Channel(name, numbers[0].unit.name, low, high, 0)


def _beginnings(name: str) -> list[str]:
    """`front_marker_since_mm` is said by the channel of that name, or by front_marker_since, front_marker, front."""
    parts = name.split("_")
    return ["_".join(parts[:count]) for count in range(1, len(parts) + 1)]


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
