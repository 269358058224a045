"""`safeloc mutate`: wrong machines, made on purpose, and what notices them."""

from __future__ import annotations

import time
from typing import Annotated

import typer

from safeloc.assurance.mutation.declared import declared
from safeloc.assurance.mutation.mutants import mutants, sample
from safeloc.assurance.mutation.places import noted
from safeloc.assurance.mutation.results import SCHEMA, as_data
from safeloc.assurance.mutation.table import lines
from safeloc.assurance.mutation.work import Plan, judge_all
from safeloc.cli.console import out, print_json
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.show import Progressing
from safeloc.cli.verify import ConfigOption, JobsOption, TargetArgument
from safeloc.proof.provers.limits import Limits


def mutate(
    target: TargetArgument,
    config: ConfigOption = None,
    most: Annotated[
        int | None, typer.Option("--sample", help="judge so many, of each kind in its share", min=1)
    ] = None,
    seed: Annotated[int, typer.Option(help="seed of the sample and of drawn runs")] = 0,
    seconds: Annotated[
        float, typer.Option(help="limit for each question to a solver, as solvers count", min=0.1)
    ] = 2.0,
    jobs: JobsOption = 2,
    only: Annotated[list[str] | None, typer.Option("--mutant", help="only this mutant (repeatable)")] = None,
    machine_only: Annotated[
        bool, typer.Option("--machine-only", help="tell of the machine alone wrong, not of the term wrong everywhere")
    ] = False,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    as_json: Annotated[bool, typer.Option("--json", help=f"print JSON only (schema {SCHEMA})")] = False,
) -> None:
    """Make a machine wrong on purpose, term by term, and say which proof notices, and which wrong machines nothing notices.

    Exit code 0, whatever is noticed: a mutant that survives is a question to whoever wrote the claims.
    """
    began = time.monotonic()
    with noted() as places:
        loaded, whole = declared(target, config)
    every = mutants(whole, places)
    chosen = [one for one in every if one.id in only] if only else sample(every, most or len(every), seed)
    if only and len(chosen) < len(set(only)):
        missing = sorted(set(only) - {one.id for one in chosen})
        raise typer.BadParameter(f"{loaded.name} has no mutant {missing[0]!r}; --json lists them.")
    store = store_in(cache)
    with Progressing(len(chosen), quiet=as_json) as progress:
        progress.say(f"mutants of {loaded.name}", len(chosen))

        judged = judge_all(
            loaded,
            whole,
            chosen,
            Plan(Limits(seconds=seconds, seed=seed), seed, jobs),
            on_judged=lambda one: progress.tick(f"{one.everywhere.fate:32} {one.id}"),
            look_in=None if fresh else store,
            keep_in=store,
        )
    took = time.monotonic() - began
    if as_json:
        print_json(as_data(loaded.name, judged, of=len(every), seed=seed, seconds=took))
        return
    for line in lines(loaded.name, judged, of=len(every), machine_only=machine_only):
        out.print(line, markup=False)
