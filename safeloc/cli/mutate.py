"""`safeloc mutate`: make a machine wrong on purpose, in many ways, and report what notices each."""

from __future__ import annotations

import time
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from safeloc.assurance.mutation.analysis import Analysis
from safeloc.assurance.mutation.kept_score import keep_score
from safeloc.assurance.mutation.places import noted
from safeloc.assurance.mutation.reasons import Reasons, read_reasons, shipped_reasons
from safeloc.assurance.mutation.results import SCHEMA, Of, as_data
from safeloc.assurance.mutation.strength import keep_strengths
from safeloc.assurance.mutation.table import lines
from safeloc.assurance.mutation.work import Plan
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.cli.console import print_json, print_line
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.options import ConfigOption, JobsOption, TargetArgument
from safeloc.cli.show import Progressing
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.other_figures import refused_recordings, with_fitting_recordings
from safeloc.runtime.streams.gzipped import name_of


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
        for path, why in refused_recordings(loaded).items():
            progress.say(f"leaving out {name_of(path)}, recorded with other figures: {why}", 0)
        loaded = with_fitting_recordings(loaded)
        known = _reasons(loaded, reasons, changed=config is not None)
        analysis = Analysis(
            loaded,
            places,
            plan,
            known,
            on_begin=lambda number: progress.say(f"mutants of {loaded.name}", number),
            on_judged=lambda one: progress.tick(f"{one.everywhere.fate:32} {one.id}"),
            most=most,
            only=only or (),
            look_in=None if fresh else store,
            keep_in=store,
        )
        found = analysis.of(parts)
    if not only:
        keep_strengths(store, loaded, found.judged, found.of)
    if not only and parts == ["machine"]:
        keep_score(store, loaded, found.judged, found.of, found.reasons)
    took = time.monotonic() - began
    if as_json:
        print_json(as_data(loaded.name, found.judged, of=found.of, seed=seed, seconds=took, reasons=found.reasons))
        return
    for line in lines(loaded.name, found.judged, of=found.of, machine_only=machine_only, reasons=found.reasons):
        print_line(line)


def _reasons(target: Target, given: Path | None, *, changed: bool) -> Reasons:
    """Return the reasons of the given file; else those that ship, which apply to the shipped configuration only."""
    if given is not None:
        return read_reasons(given)
    return Reasons() if changed or target.spec not in ENTRIES else shipped_reasons(target.name)
