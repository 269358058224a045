"""Judge the mutants of a composition: first by the claims of each machine, then by those of the composition."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any

from safeloc.assurance.kept_work import Batch, Keeping, kept_or_done
from safeloc.assurance.mutation.judge_composition_mutant import CompositionBench, composition_bench, of_member, of_wire
from safeloc.assurance.mutation.judge_machine_mutant import with_outcome
from safeloc.assurance.mutation.members import Composed, member_mutants
from safeloc.assurance.mutation.mutants import Mutant, sample
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.mutation.results import BY_PROOF, SET_ASIDE, Judged, Outcome, from_data
from safeloc.assurance.mutation.wires import WireEdit, wire_edits
from safeloc.assurance.mutation.work import Judging, OnJudged, Plan, lost
from safeloc.errors import InputError
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.proof.provers.limits import CLOCK
from safeloc.proof.provers.workers import Lost, Task

_KIND = "mutants of the whole"
_AT_ONCE = 4
_QUESTIONS = 40
"""Solver questions per mutant that may use their full limit before its process is stopped."""


@dataclass(frozen=True, eq=False)
class Parts:
    """Mutants of a composition to judge, of its machines and of its wires. `existing` has the ids of all mutants, chosen or not."""

    members: Sequence[Mutant]
    wires: Mapping[str, WireEdit]
    existing: frozenset[str]

    @property
    def of(self) -> int:
        """The number of all mutants, chosen or not."""
        return len(self.existing)

    @property
    def number(self) -> int:
        """The number of mutants to judge."""
        return len(self.members) + len(self.wires)


def parts(composed: Composed, places: Places, *, most: int | None, seed: int, only: Sequence[str] = ()) -> Parts:
    """Return all mutants, a sample of at most `most`, or those with the ids in `only`; InputError for an unknown id."""
    wires = {edit.mutant.id: edit for edit in wire_edits(composed, places)}
    every = [*member_mutants(composed, places), *(edit.mutant for edit in wires.values())]
    chosen = [one for one in every if one.id in only] if only else sample(every, most or len(every), seed)
    missing = sorted(set(only) - {one.id for one in chosen})
    if missing:
        raise InputError(f"{composed.target.name} has no mutant {missing[0]!r}; --json lists them.")
    members = [one for one in chosen if one.id not in wires]
    existing = frozenset(one.id for one in every)
    return Parts(members, {one.id: wires[one.id] for one in chosen if one.id in wires}, existing)


@dataclass(frozen=True, eq=False)
class JudgingComposed:
    """A job that judges mutants of one composition; its fields are those of `Judging`."""

    composed: Composed
    plan: Plan
    on_judged: OnJudged
    look_in: Store | None = None
    keep_in: Store | None = None

    def all(self, some: Parts) -> list[Judged]:
        """Judge the chosen mutants; return the results machine by machine, then those of wires."""
        alone = {one.id: one for name in self.composed.members for one in self._by_itself(name, some.members)}
        left = [one for one in some.members if _is_left(alone[one.id])]
        together = self._in_the_composition([*left, *(edit.mutant for edit in some.wires.values())], alone, some.wires)
        return [together.get(one, alone.get(one)) or together[one] for one in (*alone, *some.wires)]

    def _by_itself(self, name: str, every: Sequence[Mutant]) -> list[Judged]:
        of_name = [one for one in every if one.machine == name]
        if not of_name:
            return []
        target, declared = self.composed.alone(name), self.composed.members[name]
        judging = Judging(target, declared, self.plan, self._closed, self.look_in, self.keep_in, searched=False)
        return judging.of_machine(of_name)

    def _closed(self, one: Judged) -> None:
        """Report the result if the machine's own claims have decided it; otherwise it is reported after the composition."""
        if not _is_left(one):
            self.on_judged(one)

    def _in_the_composition(
        self, mutants: Sequence[Mutant], alone: Mapping[str, Judged], wires: Mapping[str, WireEdit]
    ) -> dict[str, Judged]:
        by_id, found = {one.id: one for one in mutants}, dict[str, Judged]()
        key = asked(self.composed.target, _KIND, self.plan.limits, self.plan.seed).key

        def work(left: Sequence[str]) -> list[Batch]:
            on = self._bench
            chunks = [left[number : number + _AT_ONCE] for number in range(0, len(left), _AT_ONCE)]
            return [self._batch([_piece(on, by_id[one], alone, wires) for one in chunk], chunk) for chunk in chunks]

        for name, data in kept_or_done([*by_id], work, Keeping(_KIND, key, self.look_in, self.keep_in), self.plan.jobs):
            found[name] = lost(by_id[name], data) if isinstance(data, Lost) else from_data(data)
            self.on_judged(found[name])
        return found

    def _batch(self, pieces: Sequence[Callable[[], dict[str, Any]]], names: Sequence[str]) -> Batch:
        seconds = CLOCK * _QUESTIONS * _AT_ONCE * self.plan.limits.seconds
        task = Task(f"{self.composed.target.name}: mutants", lambda: [piece() for piece in pieces], seconds)
        return Batch(tuple(names), task)

    @cached_property
    def _bench(self) -> CompositionBench:
        """The bench, made only if a result is not stored."""
        return composition_bench(self.composed, self.plan.limits)


def _is_left(one: Judged) -> bool:
    """Return whether the machine's own claims leave the mutant undecided, in at least one of the two ways of making it."""
    return _is_open(one.everywhere) or _is_open(one.alone)


def _is_open(outcome: Outcome) -> bool:
    """Return whether the outcome is undecided: neither killed by a proof nor set aside."""
    return outcome.fate not in (*BY_PROOF, *SET_ASIDE)


def _piece(
    on: CompositionBench, mutant: Mutant, alone: Mapping[str, Judged], wires: Mapping[str, WireEdit]
) -> Callable[[], dict[str, Any]]:
    if mutant.id in wires:
        return lambda: asdict(_wired(on, wires[mutant.id]))
    return lambda: asdict(_together(on, mutant, alone[mutant.id]))


def _wired(on: CompositionBench, edit: WireEdit) -> Judged:
    started = time.monotonic()
    outcome = of_wire(on, edit)
    return with_outcome(edit.mutant, outcome, outcome, time.monotonic() - started)


def _together(on: CompositionBench, mutant: Mutant, alone: Judged) -> Judged:
    """Judge in the composition each way of making the mutant that the machine's own claims left undecided."""
    started = time.monotonic()
    only = of_member(on, mutant, everywhere=False) if _is_open(alone.alone) else alone.alone
    if mutant.everywhere is None:
        everywhere = only
    else:
        everywhere = of_member(on, mutant, everywhere=True) if _is_open(alone.everywhere) else alone.everywhere
    seconds = round(alone.seconds + time.monotonic() - started, 3)
    return replace(alone, alone=only, everywhere=everywhere, seconds=seconds)
