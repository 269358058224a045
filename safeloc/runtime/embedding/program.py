"""A target ready to run: generated code, the mapping from records to inputs, and a fingerprint.

A program has no state: any number of controllers, in any threads, can share one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from safeloc.codegen.compiled import Compiled, Row, compile_system
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.digest import declaration_digest
from safeloc.language.expr import Num
from safeloc.language.machine import Machine
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.units import Enumeration
from safeloc.runtime.border import Fault
from safeloc.runtime.breaches import Breach
from safeloc.runtime.embedding.laws import ObservableLaws
from safeloc.runtime.embedding.report import Interval, Move, Report, Track
from safeloc.runtime.embedding.snapshot import text_of
from safeloc.runtime.embedding.target_inputs import TargetInputs
from safeloc.target import Target


@dataclass(frozen=True, eq=False)
class _Part:
    """One machine of the program: the place of its mode in the state, the labels of its modes, and its moves.

    moves   number of a transition (from 1), mode before, mode after -> the transition's entry in the report
    """

    machine: Machine
    name: str
    mode_at: int
    modes: tuple[str, ...]
    moves: Mapping[tuple[int, int, int], Move]


class Program(TargetInputs):
    """The compiled on-board part of a target, without ghosts and assumption."""

    def __init__(self, target: Target) -> None:
        super().__init__(target)
        self.code: Compiled = compile_system(self.system)
        self._stand_ins = stand_ins(self.system)
        self.parts = tuple(_part(self.system, machine) for machine in self.system.machines)
        self.labels: Mapping[str, tuple[str, ...]] = {
            name: term.unit.members
            for name, term in self.system.outputs.items()
            if isinstance(term, Num) and isinstance(term.unit, Enumeration)
        }

    def first(self, chosen: Mapping[str, Value] | None = None) -> Row:
        """Return the first state, with the chosen values of variables declared ANY; InputError as `interpret.start`."""
        return self.code.first(chosen) if chosen else self._first

    @cached_property
    def _first(self) -> Row:
        return self.code.first()

    @cached_property
    def laws(self) -> ObservableLaws:
        """The laws of the target's worlds that can be checked on board; made when first used."""
        return ObservableLaws(self.target.system, self.system)

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the on-board meaning of the declaration: variables, first values, moves and outputs."""
        return declaration_digest(self.system)

    @cached_property
    def config(self) -> Mapping[str, Any]:
        """The configuration as plain data; empty for a machine without one."""
        return {} if self.target.config is None else self.target.config.model_dump(mode="json")

    @cached_property
    def identity(self) -> Mapping[str, str]:
        """The fields of a snapshot that tell this program from others, as text."""
        fields = {"machine": self.name, "config": self.config, "program": self.fingerprint}
        return {name: text_of(value) for name, value in fields.items()}

    def moves(self, fired: Sequence[int], before: Row, after: Row) -> tuple[Move, ...]:
        """Return the transitions that fired."""
        return tuple(
            [
                part.moves[number, before[part.mode_at], after[part.mode_at]]
                for part, number in zip(self.parts, fired, strict=True)
                if number
            ]
        )

    def modes(self, state: Row) -> dict[str, str]:
        """Return the label of each machine's mode."""
        return {part.name: part.modes[int(state[part.mode_at])] for part in self.parts}

    def interval(self, values: Mapping[str, Value]) -> Interval | None:
        """Return the interval that these outputs report; None if they report none."""
        if self.target.reported is None:
            return None
        ends = self.target.reported.interval_mm(values)
        return None if ends is None else Interval(*ends)

    def track(self, values: Mapping[str, Value]) -> Track | None:
        """Return the track that these outputs tell; None for a machine whose interval lies along the line."""
        tracks = None if self.target.reported is None else self.target.reported.tracks
        if tracks is None:
            return None
        there = [one for one in tracks.possible if values[one.edge]]
        possible = tuple((int(values[one.edge]), Interval(values[one.low], values[one.high])) for one in there)
        return Track(int(values[tracks.edge]) or None, possible)

    def quiet(self, first: Row) -> bool:
        """Return whether this initial state reports no position, so that a restart is always safe."""
        return self.target.reported is not None and self.interval(self.code.named_outputs(first)) is None

    def report(
        self, state: Row, moves: tuple[Move, ...], number: int, end_ms: int, faults: tuple[Fault, ...], anew: str,
        truth_mm: int | None, breaches: tuple[Breach, ...] = (),
    ) -> Report:  # fmt: skip
        """Make the report for this state at the end of that cycle."""
        values = self.code.named_outputs(state)
        reported = self.target.reported
        standing = None if reported is None or truth_mm is None else reported.standing(values, truth_mm)
        interval, outputs = self.interval(values), without_absent(values, self._stand_ins)
        return Report(
            self.name, number, end_ms, self.modes(state), moves, outputs, self.labels, interval, faults,
            anew, standing, breaches, self.track(values),
        )  # fmt: skip


def _part(system: TransitionSystem, machine: Machine) -> _Part:
    names = [var.name for var in system.state]
    prefixed = f"{machine.name}.mode"
    assert isinstance(machine.mode.unit, Enumeration)
    labels = machine.mode.unit.members
    moves = {
        (number, source.value, one.target.value): Move(
            machine.name, one.name, source.label, one.target.label, one.requirements
        )
        for number, one in enumerate(machine.transitions, 1)
        for source in one.sources
    }
    return _Part(machine, machine.name, names.index(prefixed if prefixed in names else "mode"), labels, moves)
