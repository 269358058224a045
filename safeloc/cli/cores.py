"""`safeloc cores`: the clauses, lemmas and rows that each proof needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated

import typer

from safeloc.assurance.evidence.core_work import SCHEMA, as_data, cores_of, needed_by_none
from safeloc.catalogue import Target, load_target
from safeloc.cli.console import out, print_json
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.options import ConfigOption, JobsOption, SecondsOption, TargetArgument
from safeloc.cli.show import Progressing
from safeloc.proof.cores.cores import Core
from safeloc.proof.provers.limits import Limits

KINDS = {"clause": "clauses", "contract": "contracts", "lemma": "lemmas", "range": "ranges of ghosts", "row": "rows"}
_UNUSED = {
    "clause": "clauses that no claim needs (obligations, such as ranges, may need them)",
    "row": "rows whose effect no claim needs (when they fire is kept, and may be needed)",
}
_MANY_ROWS = 4
"""More rows than that are given by their number only; --json has their names."""


def cores(
    target: TargetArgument,
    config: ConfigOption = None,
    names: Annotated[list[str] | None, typer.Option("--property", help="only this property (repeatable)")] = None,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    as_json: Annotated[bool, typer.Option("--json", help=f"print JSON only (schema {SCHEMA})")] = False,
) -> None:
    """Find a smallest set of clauses, lemmas and rows for each proved claim, and say which of them no claim needs.

    Of a row its effect is left out, never its condition. Exit code 0: a clause that no claim needs is no error, but its author should know why it is there.
    """
    loaded = load_target(target, config)
    known = {prop.name: prop for prop in loaded.properties}
    if unknown := sorted(set(names or ()) - set(known)):
        raise typer.BadParameter(f"{loaded.name} has no property {unknown[0]!r}; `safeloc list properties` lists them.")
    chosen = [known[name] for name in dict.fromkeys(names or known)]
    store = store_in(cache)
    with Progressing(len(chosen), quiet=as_json) as progress:
        progress.say(f"proof cores of {loaded.name}", len(chosen))
        found = cores_of(
            loaded,
            chosen,
            Limits(seconds=seconds),
            jobs=jobs,
            on_core=lambda one: progress.tick(f"{len(one.rests_on):3} elements  {one.claim}"),
            look_in=None if fresh else store,
            keep_in=store,
        )
    if as_json:
        print_json(as_data(loaded, found, complete=names is None))
        return
    for line in _lines(loaded, found, complete=names is None):
        out.print(line, markup=False, soft_wrap=True)


def _lines(target: Target, found: Sequence[Core], *, complete: bool) -> Iterator[str]:
    for one in found:
        yield from _of_claim(one, _row_count(target, one))
    if complete:
        unused = needed_by_none(target, found)
        for kind, words in _UNUSED.items():
            names = [f"{one.machine}: {one.name}" for one in unused if one.kind == kind]
            yield f"{words}: {'; '.join(names) or 'none'}"
    others = sum(1 for one in found if one.why_none and one.why_none != "shown by a run")
    missing = f"; no smallest set was found for {others}" if others else ""
    yield f"{len(found)} {'claim' if len(found) == 1 else 'claims'}{missing}"


def _row_count(target: Target, one: Core) -> int:
    """Return the number of rows of the machine on which the claim was proved."""
    return sum(len(made.transitions) for made in target.machines if one.kept_by in ("", made.name))


def _of_claim(one: Core, rows: int) -> Iterator[str]:
    by = f" (proved on {one.kept_by} alone)" if one.kept_by else ""
    if one.why_none:
        yield f"{one.claim}{by}: {one.why_none}"
        return
    yield f"{one.claim}{by}: {one.steps}-induction" + ("" if one.rests_on else ", rests on no clause, lemma or row")
    for kind, words in KINDS.items():
        names = [element.name for element in one.rests_on if element.kind == kind]
        if names:
            many = kind == "row" and len(names) > _MANY_ROWS
            shown = f"{len(names)} of {rows}" if many else "; ".join(names)
            yield f"    {words}: {shown}"
    if one.open_:
        yield f"    perhaps not needed, undecided within the limits: {'; '.join(x.name for x in one.open_)}"
