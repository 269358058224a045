"""`safeloc faults`: break every clause of the world, alone and in pairs; report the effect on claims, interval and hazard."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer

from safeloc.assurance.evidence.cut_sets import CutSets, cut_sets, to_open_psa
from safeloc.assurance.evidence.effects import Effect
from safeloc.assurance.evidence.fault_data import SCHEMA, cycles, end_in_words, faults_data
from safeloc.assurance.evidence.fault_work import SECONDS_A_CLAIM, Breaking, planned
from safeloc.assurance.evidence.top_event import top_event
from safeloc.assurance.law_ids import ids_of
from safeloc.catalogue import Target, load_target
from safeloc.cli.console import out, print_json
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.options import ConfigOption, JobsOption, TargetArgument
from safeloc.cli.show import EXIT_CODES, Progressing
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses, laws
from safeloc.proof.provers.limits import Limits
from safeloc.report.fault_tree import fault_tree

_HARMLESS = ("contained", "no hazard")
"""End effects of clauses whose breach does no harm."""


def faults(
    target: TargetArgument,
    config: ConfigOption = None,
    clause: Annotated[
        list[str] | None,
        typer.Option(help="only this clause: its id or name in `safeloc list assumptions` (repeatable)"),
    ] = None,
    order: Annotated[
        int,
        typer.Option(help="1: every clause alone; 2: also every pair of clauses that alone do no harm", min=1, max=2),
    ] = 1,
    seconds: Annotated[float, typer.Option(help="limit for each claim, as solvers count", min=0.1)] = SECONDS_A_CLAIM,
    jobs: JobsOption = 2,
    open_psa: Annotated[
        Path | None, typer.Option("--open-psa", help="write the cut sets here, in the Open-PSA format", dir_okay=False)
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", help="write the cut sets here, as SVG", dir_okay=False)
    ] = None,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    as_json: Annotated[bool, typer.Option("--json", help=f"print JSON only (schema {SCHEMA})")] = False,
) -> None:
    """Break every clause of the world, and report the effect on each claim, on the reported interval and on the declared hazard.

    Exit code 0: everything was decided; 3: something is undecided within the limits.
    """
    loaded = load_target(target, config)
    top = top_event(loaded)
    if order > 1 and not top:
        raise typer.BadParameter(f"{loaded.name} reports no interval and declares no hazard; give --order 1.")
    asked = _clauses(loaded, clause) if clause else None
    effects = _broken(loaded, asked, order, Limits(seconds=seconds), jobs, cache, fresh=fresh, quiet=as_json)
    sets, numbers = cut_sets(top, effects), ids_of(loaded)
    if open_psa is not None:
        open_psa.write_text(to_open_psa(loaded.name, sets, numbers), encoding="utf-8")
    if picture is not None:
        picture.write_text(fault_tree(loaded.name, sets, numbers), encoding="utf-8")
    if as_json:
        print_json(faults_data(loaded, effects, sets))
    else:
        for line in _lines(loaded, effects, sets, of="these clauses" if asked else ""):
            out.print(line, markup=False, soft_wrap=True)
    if any(one.open_ or one.end == "undecided" for one in effects):
        raise typer.Exit(EXIT_CODES["unknown"])


def _clauses(target: Target, asked: Sequence[str]) -> list[ClauseId]:
    """Return the clauses of these ids or names, in the order of the target; BadParameter for one that it does not have, or does not assume."""
    ids, assumed = ids_of(target), assumed_clauses(target.system)
    for one in asked:
        if not any(one in (ids[clause], clause.name) for clause in assumed):
            known = [ids[clause] for clause in assumed]
            by_others = any(one in (ids[clause], clause.name) for clause in ids)
            why = "is guaranteed by another machine, and not assumed" if by_others else "is no clause"
            raise typer.BadParameter(
                f"{one!r} {why} of {target.name}; its clauses are {', '.join(known)}. "
                f"`safeloc list assumptions --machine {target.name}` shows them.",
                param_hint="--clause",
            )
    return [clause for clause in assumed if ids[clause] in asked or clause.name in asked]


def _broken(
    target: Target,
    asked: Sequence[ClauseId] | None,
    order: int,
    limits: Limits,
    jobs: int,
    cache: Path | None,
    *,
    fresh: bool,
    quiet: bool,
) -> list[Effect]:
    store = store_in(cache)
    with Progressing(planned(target, asked), quiet=quiet) as progress:
        breaking = Breaking(limits, jobs, progress, None if fresh else store, store)
        cores = breaking.cores(target)
        singles = breaking.singles(target, cores, asked)
        return singles if order == 1 else [*singles, *breaking.pairs(target, cores, singles)]


def _lines(target: Target, effects: Sequence[Effect], sets: CutSets, *, of: str) -> Iterator[str]:
    """Yield the table and the cut sets; `of`: the clauses that were asked, in words, if not all were."""
    numbers, declared = ids_of(target), laws(target.system)
    for one in effects:
        if len(one.broken) > 1 and one.end in _HARMLESS:
            continue
        owners = {declared[clause].owner or "nobody" for clause in one.broken}
        yield f"{' and '.join(numbers[clause] for clause in one.broken)}  {' and '.join(clause.name for clause in one.broken)}"
        yield f"    owner         {', '.join(sorted(owners))}"
        lost = ", ".join(f"{name} (after {cycles(number)})" for name, number in one.lost.items())
        if len(one.broken) == 1:
            yield f"    claims lost   {lost or 'none'}" + (
                f"; not decided: {', '.join(one.open_)}" if one.open_ else ""
            )
        yield f"    end effect    {end_in_words(target, one)}"
        if one.withdrawn_by:
            yield f"    withdrawn by  {', '.join(one.withdrawn_by)}"
    pairs = [one for one in effects if len(one.broken) > 1]
    if pairs:
        kept = sum(one.end in _HARMLESS for one in pairs)
        yield f"{kept} of {len(pairs)} pairs of harmless clauses do no harm together either"
    yield from _cut_set_lines(target, sets, of)


def _cut_set_lines(target: Target, sets: CutSets, of: str) -> Iterator[str]:
    if not sets.top:
        return
    numbers = ids_of(target)
    found = ["+".join(numbers[clause] for clause in one) for one in sets.found]
    among = f" among {of}" if of else ""
    yield f"minimal cut sets of {sets.top!r}{among}: {', '.join(found) or 'none'}"
    if sets.undecided:
        open_ = ["+".join(numbers[clause] for clause in one) for one in sets.undecided]
        yield f"not decided: {', '.join(open_)}"
