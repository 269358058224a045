"""`safeloc mutate`: make a machine wrong on purpose, in many ways, and report what notices each."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from safeloc.assurance.mutation.choosing import by_id, chosen, judge
from safeloc.assurance.mutation.composed_work import JudgingComposed
from safeloc.assurance.mutation.composed_work import parts as parts_of
from safeloc.assurance.mutation.declared import whole_of
from safeloc.assurance.mutation.members import composed
from safeloc.assurance.mutation.places import Places, noted
from safeloc.assurance.mutation.reasons import Reasons, read_reasons, shipped_reasons
from safeloc.assurance.mutation.results import SCHEMA, Judged, Of, as_data
from safeloc.assurance.mutation.strength import keep_strengths
from safeloc.assurance.mutation.table import lines
from safeloc.assurance.mutation.work import Judging, Plan
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.cli.console import out, print_json
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.options import ConfigOption, JobsOption, TargetArgument
from safeloc.cli.show import Progressing
from safeloc.errors import InputError
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits


class _Part(Enum):
    """The part of a declaration that is made wrong."""

    MACHINE = "machine"
    WORLD = "world"
    CLAIMS = "claims"


def mutate(
    target: TargetArgument,
    config: ConfigOption = None,
    of: Annotated[
        list[_Part] | None,
        typer.Option("--of", help="what is made wrong: machine (the default), world or claims (repeatable)"),
    ] = None,
    most: Annotated[
        int | None, typer.Option("--sample", help="judge only N mutants, each kind in its share", min=1)
    ] = None,
    seed: Annotated[int, typer.Option(help="seed of the sample and of drawn runs")] = 0,
    seconds: Annotated[
        float, typer.Option(help="limit for each question to a solver, as solvers count", min=0.1)
    ] = 2.0,
    jobs: JobsOption = 2,
    only: Annotated[list[str] | None, typer.Option("--mutant", help="only this mutant (repeatable)")] = None,
    machine_only: Annotated[
        bool,
        typer.Option(
            "--machine-only", help="show results for the term wrong in the machine only, not wherever it is written"
        ),
    ] = False,
    reasons: Annotated[
        Path | None,
        typer.Option(
            "--reasons",
            help="TOML with reasons why no proof needs to notice a mutant; by default the file that ships with the machine",
        ),
    ] = None,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    as_json: Annotated[bool, typer.Option("--json", help=f"print JSON only (schema {SCHEMA})")] = False,
) -> None:
    """Make a machine wrong on purpose, term by term; report which proof notices, and which wrong machines nothing notices.

    With --of also the clauses of its world, and its claims. Exit code 0 in any case: a mutant that survives is no error, but
    the author of the claims should look at it.
    """
    began = time.monotonic()
    with noted() as places:
        loaded = load_target(target, config)
    store, plan = store_in(cache), Plan(Limits(seconds=seconds, seed=seed), seed, jobs)
    parts: list[Of] = [one.value for one in of or [_Part.MACHINE]]
    with Progressing(1, quiet=as_json) as progress:
        known = _reasons(loaded, reasons, changed=config is not None)
        job = _Job(loaded, places, plan, most, tuple(only or ()), known, progress, None if fresh else store, store)
        judged, number, why = job.of_composition(parts) if loaded.system.parts else job.of_machine(parts)
    if not only:
        keep_strengths(store, loaded, judged, number)
    took = time.monotonic() - began
    if as_json:
        print_json(as_data(loaded.name, judged, of=number, seed=seed, seconds=took, reasons=why))
        return
    for line in lines(loaded.name, judged, of=number, machine_only=machine_only, reasons=why):
        out.print(line, markup=False)


def _reasons(target: Target, given: Path | None, *, changed: bool) -> Reasons:
    """Return the reasons of the given file; else those that ship, which apply to the shipped configuration only."""
    if given is not None:
        return read_reasons(given)
    return Reasons() if changed or target.spec not in ENTRIES else shipped_reasons(target.name)


@dataclass(frozen=True, eq=False)
class _Job:
    """One call of the command; its results come with the number of all mutants, and the written reasons by id."""

    target: Target
    places: Places
    plan: Plan
    most: int | None
    only: tuple[str, ...]
    reasons: Reasons
    progress: Progressing
    look_in: Store | None
    keep_in: Store

    def of_machine(self, parts: Sequence[Of]) -> tuple[list[Judged], int, dict[str, str]]:
        whole, seed = whole_of(self.target), self.plan.seed
        some = (
            by_id(whole, self.places, self.only, most=self.most, seed=seed)
            if self.only
            else chosen(whole, self.places, parts, most=self.most, seed=seed)
        )
        why = self.reasons.of(some.existing)
        self._begin(some.number)
        judging = Judging(self.target, whole, self.plan, self._heard, self.look_in, self.keep_in)
        return judge(judging, some), some.of, why

    def of_composition(self, asked: Sequence[Of]) -> tuple[list[Judged], int, dict[str, str]]:
        whole = composed(self.target, self.places)
        if [*asked] != [_Part.MACHINE.value]:
            raise InputError(
                f"{self.target.name} is a composition: only its machines and wires are made wrong. For worlds and claims "
                f"give one of its machines: {', '.join(whole.members)}."
            )
        some = parts_of(whole, self.places, most=self.most, seed=self.plan.seed, only=self.only)
        why = self.reasons.of({"machine": some.existing})
        self._begin(some.number)
        judging = JudgingComposed(whole, self.plan, self._heard, self.look_in, self.keep_in)
        return judging.all(some), some.of, why

    def _begin(self, number: int) -> None:
        self.progress.say(f"mutants of {self.target.name}", number)

    def _heard(self, one: Judged) -> None:
        self.progress.tick(f"{one.everywhere.fate:32} {one.id}")
