"""The verification commands `safeloc prove`, `test`, `replay` and `verify`, and `report`, which shows results again."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import BaseModel

from safeloc.assurance.evidence.fault_work import SECONDS_A_CLAIM, Breaking, planned
from safeloc.assurance.mutation.strength import stamp, strengths_of
from safeloc.catalogue import ENTRIES, Target, configured, load_target
from safeloc.cli.console import err, out, print_json
from safeloc.cli.judged import tell
from safeloc.cli.keeping import CacheOption, FreshOption, store_in, told
from safeloc.cli.show import Progressing, code, findings_table, result, summed_up
from safeloc.cli.verifying import Verifying
from safeloc.cli.watching import WatchOption, beside, watch
from safeloc.errors import InputError
from safeloc.language.spec import Property
from safeloc.language.verdict import word
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.cache.reports import KeptReport, keep_report, kept_report, report_key
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked, found_before, keep
from safeloc.proof.cache.times import keep_seconds, seconds_before
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.assumptions import judge_recording
from safeloc.proof.verification.many import in_order, verify_targets
from safeloc.proof.verification.memory import Memory
from safeloc.proof.verification.one import Plan, Work, claims, owed
from safeloc.proof.verification.replay import as_table, replay_stream
from safeloc.proof.verification.unasked import nothing_asked, nothing_tested
from safeloc.report.data import NOT_ASKED, report_data
from safeloc.report.extract import extract
from safeloc.report.folder import PAGE, cleared, files_of, render_folder, usable, write_folder
from safeloc.report.proof_evidence import evidence_data

TargetArgument = Annotated[
    str, typer.Argument(help="a name from `safeloc list`, or package.module:name, or file.py:name")
]
ConfigOption = Annotated[Path | None, typer.Option("--config", help="TOML or JSON with the machine's configuration")]
JsonOption = Annotated[bool, typer.Option("--json", help="print JSON only (schema safeloc-report/4)")]
DepthOption = Annotated[int, typer.Option(help="steps of bounded search", min=1)]


def _finite(seconds: float) -> float:
    if not math.isfinite(seconds):
        raise typer.BadParameter(f"{seconds} is no time limit; give a number of seconds.")
    return seconds


SecondsOption = Annotated[
    float,
    typer.Option(
        help="limit for each property: seconds of an idle machine, as solvers count them; the clock ends it after six times that",
        min=0.1,
        callback=_finite,
    ),
]
JobsOption = Annotated[int, typer.Option(help="processes", min=1)]
SeedOption = Annotated[int, typer.Option(help="seed of the solvers and of random runs")]
ExamplesOption = Annotated[int, typer.Option(help="property-test runs", min=1)]
SingleOption = Annotated[bool, typer.Option("--single-file", help="write one self-contained page")]
StepsOption = Annotated[int, typer.Option(help="steps of each property-test run", min=1)]


def prove(
    target: TargetArgument,
    config: ConfigOption = None,
    only: Annotated[list[str] | None, typer.Option("--property", help="only this property (repeatable)")] = None,
    configurations: Annotated[
        list[str] | None,
        typer.Option(
            "--configurations",
            help="instead of the defaults: `all` declared configurations of a shipped machine, or one by name (repeatable)",
        ),
    ] = None,
    depth: DepthOption = 25,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    again: WatchOption = False,
    as_json: JsonOption = False,
) -> None:
    """Prove the properties and obligations of a machine for all streams that obey its assumption."""
    if again:
        raise typer.Exit(watch(sys.argv[1:], beside([target], config)))
    proving = _Proving(only, Limits(depth=depth, seconds=seconds, seed=seed), jobs, store_in(cache), fresh, as_json)
    if configurations is None:
        loaded = load_target(target, config)
        raise typer.Exit(result(proving.findings(loaded), [loaded], as_json=as_json))
    if config is not None:
        raise typer.BadParameter(
            "--config and --configurations exclude each other; name the declared ones, or give a file."
        )
    raise typer.Exit(proving.in_each(configured(target, configurations)))


@dataclass(frozen=True)
class _Proving:
    """How a machine is proved: which properties, within which limits."""

    only: list[str] | None
    limits: Limits
    jobs: int
    store: Store
    fresh: bool
    quiet: bool

    def findings(self, loaded: Target) -> list[Finding]:
        """Prove one target, or return what an earlier run found."""
        chosen = _chosen(loaded, self.only)
        question = asked(loaded, "proved", self.limits, self.only)
        found = None if self.fresh else found_before(self.store, question)
        if found is None:
            found = self._proved(loaded, chosen)
            keep(self.store, question, found)
        _tell_kept(found, quiet=self.quiet)
        return found

    def _proved(self, loaded: Target, chosen: Sequence[Property]) -> list[Finding]:
        expected = claims(loaded, chosen) + (owed(loaded) if self.only is None else 0)
        with kept_in(self.store, fresh=self.fresh), Progressing(expected, quiet=self.quiet) as progress:
            work = Work(loaded, self.jobs, progress.say, progress.add)
            found = [*nothing_asked(loaded), *work.proved(chosen, self.limits)]
            return found if self.only is not None else [*found, *work.obliged(self.limits)]

    def in_each(self, configured: Iterable[tuple[str, Target]]) -> int:
        """Prove a machine in each of its configurations; return the exit code of the worst finding."""
        every: dict[str, list[Finding]] = {}
        reports: dict[str, Any] = {}
        for name, loaded in configured:
            self._head(name, loaded)
            every[name] = self.findings(loaded)
            if self.quiet:
                reports[name] = report_data(every[name], [loaded])
            else:
                _summary(every[name])
        if self.quiet:
            print_json({"configurations": reports})
        else:
            self._table(every)
        return code([finding for findings in every.values() for finding in findings])

    def _head(self, name: str, loaded: Target) -> None:
        if not self.quiet:
            out.print(f"\n{loaded.name}, {name}: {_own_figures(loaded.config)}", markup=False)

    def _table(self, every: Mapping[str, Sequence[Finding]]) -> None:
        out.print("")
        for name, findings in every.items():
            out.print(f"{name:30}  {summed_up(findings)}", markup=False)


def _own_figures(config: BaseModel | None) -> str:
    """The figures of a configuration that are not the defaults."""
    own = {} if config is None else config.model_dump(mode="json", exclude_defaults=True)
    return ", ".join(f"{name} = {value}" for name, value in own.items()) or "no figure is changed"


def _tell_kept(findings: Sequence[Finding], *, quiet: bool) -> None:
    if not quiet and told(findings):
        err.print(told(findings), markup=False)


def _chosen(target: Target, names: list[str] | None) -> list[Property]:
    if names is None:
        return list(target.properties)
    known = {prop.name: prop for prop in target.properties}
    missing = [name for name in names if name not in known]
    if missing:
        raise typer.BadParameter(f"{target.name} has no property {missing[0]!r}; it has {', '.join(known)}.")
    return [known[name] for name in names]


def test(
    target: TargetArgument,
    config: ConfigOption = None,
    examples: ExamplesOption = 100,
    steps: StepsOption = 60,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    as_json: JsonOption = False,
) -> None:
    """Run property tests along plausible and faulty streams."""
    loaded = load_target(target, config)
    plan = Plan(Limits(), examples, steps, seed)
    with Progressing(owed(loaded) + len(loaded.properties), quiet=as_json) as progress:
        work = Work(loaded, jobs, progress.say, progress.add)
        obliged = work.obliged(plan.limits)
        findings = [*nothing_tested(loaded), *work.tested(plan, obliged)]
    raise typer.Exit(result(findings, [loaded], as_json=as_json))


def replay(
    target: TargetArgument,
    stream: Annotated[Path, typer.Argument(help="JSONL, CSV or Parquet with the inputs of every step")],
    config: ConfigOption = None,
    period: Annotated[
        int | None,
        typer.Option("--period-ms", help="the file holds single records; group them into steps of this period", min=1),
    ] = None,
    run: Annotated[
        str | None, typer.Option("--run", help="the file holds a report's traces; replay the run of this result")
    ] = None,
    form: Annotated[str, typer.Option("--format", help="table or jsonl")] = "table",
    folder: Annotated[Path | None, typer.Option("--out", help="folder for a report with pictures")] = None,
    assumptions: Annotated[
        bool,
        typer.Option(
            "--assumptions",
            help="judge the laws of the worlds instead: how near each came to being broken, and every breach",
        ),
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Run a recorded stream through a machine and check every property on it, or what the proofs assume of the world."""
    if form not in ("table", "jsonl"):
        raise typer.BadParameter(f"--format {form!r}: choose table or jsonl.")
    if run is not None and period is not None:
        raise typer.BadParameter("--period-ms is for single records; the run of --run has steps already.")
    loaded = load_target(target, config)
    if assumptions:
        if folder is not None or form != "table":
            raise typer.BadParameter("--assumptions goes with neither --out nor --format; give --json for data.")
        judged = judge_recording(loaded, stream, period_ms=period, run=run)
        raise typer.Exit(tell(loaded, stream.name, judged, as_json=as_json))
    if folder is not None:
        usable(folder)
    rows, findings = replay_stream(loaded, stream, period_ms=period, run=run)
    if folder is not None:
        err.print(f"report: {write_folder(folder, findings, [loaded])}", markup=False)
    if as_json:
        print_json(report_data(findings, [loaded]))
    elif form == "jsonl":
        for row in rows:
            sys.stdout.write(row.as_json() + "\n")
    else:
        for line in as_table(rows):
            out.print(line, markup=False)
        findings_table(findings)
    raise typer.Exit(code(findings))


def report(
    folder: Annotated[Path, typer.Argument(help="folder that `safeloc verify` wrote")],
    single: SingleOption = False,
    to: Annotated[
        Path | None,
        typer.Option(
            "--extract", help="instead of the page, write certificates as .smt2 and runs as .jsonl into this folder"
        ),
    ] = None,
) -> None:
    """Render the page of a report folder again, or unpack the report's certificates and traces."""
    if to is None:
        err.print(f"report: {render_folder(folder, single=single)}", markup=False)
    elif single:
        raise typer.BadParameter("--single-file is an option of the page, and --extract writes no page.")
    else:
        texts, runs = extract(folder, to)
        err.print(f"{to}: {texts} certificates, {runs} traces", markup=False)


def verify(
    targets: Annotated[list[str] | None, typer.Argument(help="machines; by default all shipped ones")] = None,
    config: ConfigOption = None,
    folder: Annotated[Path, typer.Option("--out", help="folder of the report")] = Path("safeloc-report"),
    depth: DepthOption = 25,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    examples: ExamplesOption = 60,
    steps: StepsOption = 60,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    check: Annotated[
        bool, typer.Option("--recheck", help="check every proof of the report again, as `recheck` does")
    ] = False,
    evidence: Annotated[
        bool,
        typer.Option(
            "--evidence",
            help="also find what each proof rests on, and break every clause of the world, as `cores` and `faults` do",
        ),
    ] = False,
    single: SingleOption = False,
    again: WatchOption = False,
    as_json: JsonOption = False,
) -> None:
    """Prove, test, replay the shipped recordings, and write the report: the main command."""
    names = targets or list(ENTRIES)
    if again:
        raise typer.Exit(watch(sys.argv[1:], beside(names, config)))
    if config is not None and len(names) > 1:
        raise typer.BadParameter(f"--config is for one machine; {len(names)} are given: {', '.join(names)}.")
    plan = Plan(Limits(depth=depth, seconds=seconds, seed=seed), examples, steps, seed)
    store = store_in(cache)
    key = None if as_json else report_key(names, config, plan, single, evidence, stamp(store))
    usable(folder)
    if not fresh and _put_back(kept_report(store, key), folder):
        _checked(folder, jobs, 0, wanted=check)
        raise typer.Exit(0)
    loaded = _distinct([load_target(name, config) for name in names])
    findings = _verified(loaded, plan, jobs, store, fresh=fresh, quiet=as_json)
    rests = _evidence(loaded, jobs, store, fresh=fresh, quiet=as_json) if evidence else NOT_ASKED

    def keep_it() -> None:
        if code(findings) == 0:
            keep_report(store, key, folder, files_of(folder), summed_up(findings))

    strengths = strengths_of(store, loaded)
    page = write_folder(
        folder, findings, loaded, evidence=rests, strengths=strengths, single=single, on_written=keep_it
    )
    store.trim()
    if as_json:
        print_json(report_data(findings, loaded, rests, strengths))
        raise typer.Exit(code(findings))
    _summary(findings)
    _tell_kept(findings, quiet=False)
    err.print(f"report: {page}", markup=False)
    _checked(folder, jobs, code(findings), wanted=check)
    raise typer.Exit(code(findings))


def _put_back(report: KeptReport | None, folder: Path) -> bool:
    """Restore the report of an identical earlier run into the folder; return whether there was one."""
    if report is None:
        return False
    with cleared(folder):
        report.put_back(folder)
    out.print(report.said, markup=False)
    err.print(f"nothing has changed since {report.since}; the report of that run: {folder / PAGE}", markup=False)
    return True


def _verified(
    targets: Sequence[Target], plan: Plan, jobs: int, store: Store, *, fresh: bool, quiet: bool
) -> list[Finding]:
    """Return all findings; completed results enter the cache, also if the run is interrupted."""
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
    """Return, for each target, what its proofs rest on, and what becomes of it when a clause is broken."""
    found = {}
    with Progressing(sum(map(planned, targets)), quiet=quiet) as progress:
        for target in targets:
            breaking = Breaking(Limits(seconds=SECONDS_A_CLAIM), jobs, progress, None if fresh else store, store)
            cores = breaking.cores(target)
            found[target.name] = evidence_data(target, cores, breaking.singles(target, cores))
    return found


def _checked(folder: Path, jobs: int, found: int, *, wanted: bool) -> None:
    """Ends the command where the checker does not confirm what was found; what was violated stays violated."""
    if not wanted:
        return
    from safeloc.cli.recheck import recheck  # it loads solvers, which a run without it does not need

    try:
        recheck(folder, jobs=jobs)
    except typer.Exit as end:
        if end.exit_code != 0 and found != 1:
            raise


def _distinct(targets: list[Target]) -> list[Target]:
    """Refuse two machines of one name: a report identifies machines by name."""
    names = [target.name for target in targets]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two machines have the name {twice[0]!r}; give each machine of a report its own name.")
    return targets


def _summary(findings: Sequence[Finding]) -> None:
    wrong = [finding for finding in findings if word(finding.result) not in ("proved", "held")]
    if wrong:
        findings_table(wrong, sum_up=False)
    out.print(summed_up(findings), markup=False)
