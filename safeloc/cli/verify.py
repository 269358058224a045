"""The command `safeloc verify`: prove, test and replay machines, and write the report."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from safeloc.assurance.evidence.fault_work import SECONDS_A_CLAIM, Breaking, planned
from safeloc.assurance.margins.kept_margins import MARGINS
from safeloc.assurance.margins.read_modules import readings_kept_in
from safeloc.assurance.margins.shipped_margins import margins_of
from safeloc.assurance.mutation.kept_score import SCORES
from safeloc.assurance.mutation.shipped_scores import scores_of, strengths_of
from safeloc.assurance.mutation.strength import STRENGTHS
from safeloc.catalogue import ENTRIES, Target, load_target, with_sources
from safeloc.cli.console import err, out, print_json
from safeloc.cli.keeping import CacheOption, FreshOption, print_cached, store_in
from safeloc.cli.options import (
    ConfigOption,
    DepthOption,
    ExamplesOption,
    JobsOption,
    JsonOption,
    SecondsOption,
    SeedOption,
    SingleOption,
    StepsOption,
)
from safeloc.cli.show import Progressing, code, print_summary, summed_up
from safeloc.cli.verifying import Verifying
from safeloc.cli.watching import WatchOption, beside, watch
from safeloc.errors import InputError
from safeloc.proof.cache.reports import KeptReport, keep_report, kept_report, report_key
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.times import keep_seconds, seconds_before
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.many import in_order, verify_targets
from safeloc.proof.verification.memory import Memory
from safeloc.proof.verification.one import Plan
from safeloc.report.copied import copied_to
from safeloc.report.data import NOT_ASKED
from safeloc.report.folder import JUNIT, PAGE, SARIF, cleared, files_of, usable, write_folder
from safeloc.report.kept_pieces import KeptPieces
from safeloc.report.made_by import made_by
from safeloc.report.proof_evidence import evidence_data


def verify(
    targets: Annotated[list[str] | None, typer.Argument(help="machines; by default all shipped ones")] = None,
    config: ConfigOption = None,
    source: Annotated[
        list[str] | None,
        typer.Option("--source", help="for the localizer: your own source as FILE.py:NAME (repeatable)"),
    ] = None,
    folder: Annotated[Path, typer.Option("--out", help="folder of the report")] = Path("safeloc-report"),
    depth: DepthOption = 25,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    examples: ExamplesOption = 60,
    steps: StepsOption = 60,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick",
            help="property tests and recordings only, in seconds; proves nothing, so the exit code is 3 at best",
        ),
    ] = False,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    check: Annotated[
        bool, typer.Option("--recheck", help="check every proof of the report again, as `recheck` does")
    ] = False,
    evidence: Annotated[
        bool,
        typer.Option(
            "--evidence",
            help="also find the core of each proof, and break every clause of the world, as `cores` and `faults` do",
        ),
    ] = False,
    single: SingleOption = False,
    sarif: Annotated[
        Path | None,
        typer.Option(
            "--sarif", metavar="FILE", help="also write what does not hold as SARIF, for editors and code hosts"
        ),
    ] = None,
    junit: Annotated[
        Path | None, typer.Option("--junit", metavar="FILE", help="also write all results as JUnit XML, for CI servers")
    ] = None,
    again: WatchOption = False,
    as_json: JsonOption = False,
) -> None:
    """Prove, test, replay the shipped recordings, and write the report: the main command."""
    names = _named(targets, source)
    if quick and (check or evidence):
        raise typer.BadParameter(f"{'--recheck' if check else '--evidence'} is about proofs, and --quick makes none.")
    if again:
        raise typer.Exit(watch(sys.argv[1:], beside(names, config)))
    if config is not None and len(names) > 1 and not source:
        raise typer.BadParameter(f"--config is for one machine; {len(names)} are given: {', '.join(names)}.")
    plan = Plan(Limits(depth=depth, seconds=seconds, seed=seed), examples, steps, seed, quick)
    store = store_in(cache)
    key = None if as_json else report_key(names, config, plan, single, evidence, *_stamps(store))
    usable(folder)
    copies = copied_to(folder, {SARIF: sarif, JUNIT: junit})
    if not fresh and _put_back(kept_report(store, key), folder):
        copies()
        _checked(folder, jobs, 0, wanted=check)
        raise typer.Exit(0)
    loaded = _distinct([load_target(name, config) for name in names])
    findings = _verified(loaded, plan, jobs, store, fresh=fresh, quiet=as_json)
    evidence_of = _evidence(loaded, jobs, store, fresh=fresh, quiet=as_json) if evidence else NOT_ASKED

    data = dict[str, Any]()

    def written(of_report: Mapping[str, Any]) -> None:
        data.update(of_report)
        if code(findings) == 0:
            keep_report(store, key, folder, files_of(folder), summed_up(findings))

    page = _Report(folder, store, _made(plan), single, jobs, fresh).written(findings, loaded, evidence_of, written)
    copies()
    store.trim()
    if as_json:
        print_json(data)
        raise typer.Exit(code(findings))
    print_summary(findings, loaded)
    print_cached(findings, quiet=False)
    err.print(f"report: {page}", markup=False)
    _checked(folder, jobs, code(findings), wanted=check)
    raise typer.Exit(code(findings))


@dataclass(frozen=True)
class _Report:
    """The report to write.

    made  how it is made, for its reader
    fresh  whether nothing kept of earlier reports goes into it
    """

    folder: Path
    store: Store
    made: Mapping[str, Any]
    single: bool
    jobs: int
    fresh: bool

    def written(
        self,
        findings: Sequence[Finding],
        loaded: Sequence[Target],
        evidence: Mapping[str, Any],
        on_written: Callable[[Mapping[str, Any]], None],
    ) -> Path:
        """Write it, with what was measured of its machines before; return the path of the page."""
        with nullcontext() if self.fresh else readings_kept_in(self.store):
            return write_folder(
                self.folder,
                findings,
                loaded,
                evidence=evidence,
                strengths=strengths_of(self.store, loaded),
                single=self.single,
                made=self.made,
                margins=margins_of(self.store, loaded),
                scores=scores_of(self.store, loaded),
                on_written=on_written,
                jobs=self.jobs,
                kept=KeptPieces(self.store, self.fresh),
            )


def _stamps(store: Store) -> Iterator[str]:
    """Return what changes whenever a result is kept that a report takes up."""
    return (kind.stamp(store) for kind in (STRENGTHS, MARGINS, SCORES))


def _made(plan: Plan) -> dict[str, Any]:
    """Return how the report was made, for its reader."""
    limits = {
        "depth": plan.limits.depth,
        "seconds": plan.limits.seconds,
        "examples": plan.examples,
        "steps": plan.steps,
    }
    return made_by(sys.argv[1:], {**limits, "seed": plan.seed})


def _named(targets: list[str] | None, sources: list[str] | None) -> list[str]:
    """Return the names of the machines to verify; all shipped ones by default."""
    if not sources:
        return targets or list(ENTRIES)
    if targets is None or len(targets) != 1:
        raise typer.BadParameter("--source is for the localizer; give the localizer as the only machine.")
    return with_sources(targets[0], sources)


def _put_back(report: KeptReport | None, folder: Path) -> bool:
    """Restore the report of an identical earlier run into the folder; return whether there was one."""
    if report is None:
        return False
    with cleared(folder):
        report.put_back(folder)
    out.print(report.summary, markup=False)
    err.print(f"nothing has changed since {report.since}; the report of that run: {folder / PAGE}", markup=False)
    return True


def _verified(
    targets: Sequence[Target], plan: Plan, jobs: int, store: Store, *, fresh: bool, quiet: bool
) -> list[Finding]:
    """Return all findings; the results of completed machines enter the cache even if the run is interrupted."""
    took = seconds_before(store, [one.name for one in targets], plan)
    look_in = None if fresh else store
    try:
        with Memory() as memory, Verifying(targets, quiet=quiet, seconds=took, jobs=jobs) as events:
            found = verify_targets(targets, plan, jobs=jobs, on_event=events, look_in=look_in, keep_in=store)
    except KeyboardInterrupt:
        err.print(
            "interrupted: completed machines are in the cache, and the next run continues from there", markup=False
        )
        raise
    for name, seconds in events.taken.items():
        keep_seconds(store, name, plan, seconds)
    if memory.most_bytes and not quiet:
        err.print(f"memory of all processes: at most {memory.most_bytes / 1e9:.1f} GB", markup=False)
    return in_order(found)


def _evidence(
    targets: Sequence[Target], jobs: int, store: Store, *, fresh: bool, quiet: bool
) -> dict[str, dict[str, Any]]:
    """Return, for each target, the core of each proof and the effect of each broken clause."""
    found = {}
    with Progressing(sum(map(planned, targets)), quiet=quiet) as progress:
        for target in targets:
            breaking = Breaking(Limits(seconds=SECONDS_A_CLAIM), jobs, progress, None if fresh else store, store)
            cores = breaking.cores(target)
            found[target.name] = evidence_data(target, cores, breaking.singles(target, cores))
    return found


def _checked(folder: Path, jobs: int, found: int, *, wanted: bool) -> None:
    """Recheck the report, if wanted; end the command with the checker's exit code unless it is 0.

    found  exit code of the findings; `violated` (1) takes precedence over the checker's
    """
    if not wanted:
        return
    from safeloc.cli.recheck import recheck  # loads solvers, which a run without --recheck may not need

    try:
        recheck(folder, jobs=jobs)
    except typer.Exit as end:
        if end.exit_code != 0 and found != 1:
            raise


def _distinct(targets: list[Target]) -> list[Target]:
    """Return the targets; InputError if two have the same name, since a report identifies machines by name."""
    names = [target.name for target in targets]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two machines have the name {twice[0]!r}; give each machine of a report its own name.")
    return targets
