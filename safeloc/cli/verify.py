"""The commands that judge machines: `safeloc prove`, `test`, `replay`, `verify`, and `report`, which shows again what was judged."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.cli.console import err, out, print_json
from safeloc.cli.replay import as_table, replay_stream, whole_run
from safeloc.cli.show import Progressing, code, findings_table, result, summed_up
from safeloc.cli.unasked import nothing_asked, nothing_tested
from safeloc.errors import InputError
from safeloc.provers.antecedents import found
from safeloc.provers.limits import Limits
from safeloc.provers.obligations import CHECKS, obligations
from safeloc.provers.portfolio import prove as prove_all
from safeloc.provers.recorded import Recording
from safeloc.report.data import report_data
from safeloc.report.folder import render_folder, usable, write_folder
from safeloc.results import Finding
from safeloc.spec import Property
from safeloc.streams.steps import read_steps
from safeloc.testing import run_tests
from safeloc.verdict import Proved, word

TargetArgument = Annotated[
    str, typer.Argument(help="a name from `safeloc list`, or package.module:name, or file.py:name")
]
ConfigOption = Annotated[Path | None, typer.Option("--config", help="TOML or JSON with the machine's configuration")]
JsonOption = Annotated[bool, typer.Option("--json", help="print JSON only (schema safeloc-report/2)")]
DepthOption = Annotated[int, typer.Option(help="steps of bounded search", min=1)]


def _finite(seconds: float) -> float:
    if not math.isfinite(seconds):
        raise typer.BadParameter(f"{seconds} is no time limit; give a number of seconds.")
    return seconds


SecondsOption = Annotated[float, typer.Option(help="time limit for each property", min=0.1, callback=_finite)]
JobsOption = Annotated[int, typer.Option(help="processes", min=1)]
SeedOption = Annotated[int, typer.Option(help="seed of solvers and random runs")]
ExamplesOption = Annotated[int, typer.Option(help="property-test runs", min=1)]
StepsOption = Annotated[int, typer.Option(help="steps of each property-test run", min=1)]


def prove(
    target: TargetArgument,
    config: ConfigOption = None,
    only: Annotated[list[str] | None, typer.Option("--property", help="only this property (repeatable)")] = None,
    depth: DepthOption = 25,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    as_json: JsonOption = False,
) -> None:
    """Prove the properties and obligations of a machine for all streams that obey its assumption."""
    loaded = load_target(target, config)
    chosen = _chosen(loaded, only)
    limits = Limits(depth=depth, seconds=seconds, seed=seed)
    owed = _owed(loaded) if only is None else 0
    with Progressing(_claims(loaded, chosen) + owed, quiet=as_json) as progress:
        progress.say(f"proving {loaded.name}", _claims(loaded, chosen))
        findings = [*nothing_asked(loaded), *_proved(loaded, chosen, limits, jobs, progress)]
        if only is None:
            findings += _obliged(loaded, limits, jobs, progress)
    raise typer.Exit(result(findings, [loaded], as_json=as_json))


def _chosen(target: Target, names: list[str] | None) -> list[Property]:
    if names is None:
        return list(target.properties)
    known = {prop.name: prop for prop in target.properties}
    missing = [name for name in names if name not in known]
    if missing:
        raise typer.BadParameter(f"{target.name} has no property {missing[0]!r}; it has {', '.join(known)}.")
    return [known[name] for name in names]


def _claims(target: Target, properties: Sequence[Property]) -> int:
    """Findings that proving these will give, as near as can be said beforehand."""
    return len(properties) + sum(len(machine.lemmas) for machine in target.machines)


def _owed(target: Target) -> int:
    """Obligations, as near as can be said beforehand: one of each kind, each mode and transition by itself."""
    return len(CHECKS) + sum(len(machine.modes) + len(machine.transitions) for machine in target.machines)


def _recordings(target: Target) -> list[Recording]:
    return [Recording(stream.first, stream.steps) for stream in map(read_steps, target.streams)]


def _proved(
    target: Target, properties: Sequence[Property], limits: Limits, jobs: int, progress: Progressing
) -> list[Finding]:
    return prove_all(
        target.system, properties, limits, jobs=jobs, on_finding=progress.add, recordings=_recordings(target)
    )


def _obliged(target: Target, limits: Limits, jobs: int, progress: Progressing) -> list[Finding]:
    progress.say(f"obligations of {target.name}", _owed(target))
    return obligations(
        target.system,
        limits,
        jobs=jobs,
        on_finding=progress.add,
        recordings=_recordings(target),
        properties=target.properties,
    )


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
    with Progressing(_owed(loaded) + len(loaded.properties), quiet=as_json) as progress:
        owed = _obliged(loaded, Limits(), jobs, progress)
        progress.say(f"testing {loaded.name}", len(loaded.properties))
        findings = [*nothing_tested(loaded), *_tested(loaded, examples, steps, seed, owed)]
    raise typer.Exit(result(findings, [loaded], as_json=as_json))


def replay(
    target: TargetArgument,
    stream: Annotated[Path, typer.Argument(help="JSONL, CSV or Parquet with the inputs of every step")],
    config: ConfigOption = None,
    period: Annotated[
        int | None,
        typer.Option("--period-ms", help="the stream holds single records; make steps of this period", min=1),
    ] = None,
    form: Annotated[str, typer.Option("--format", help="table or jsonl")] = "table",
    folder: Annotated[Path | None, typer.Option("--out", help="folder for a report of it, with its pictures")] = None,
    as_json: JsonOption = False,
) -> None:
    """Run a recorded stream through a machine and check every property on it."""
    if form not in ("table", "jsonl"):
        raise typer.BadParameter(f"--format {form!r}: choose table or jsonl.")
    loaded = load_target(target, config)
    if folder is not None:
        usable(folder)
    rows, findings = replay_stream(loaded, stream, period_ms=period)
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


def report(folder: Annotated[Path, typer.Argument(help="folder that `safeloc verify` wrote")]) -> None:
    """Render the page of a report folder again from its report.json."""
    err.print(f"report: {render_folder(folder)}", markup=False)


def verify(
    targets: Annotated[list[str] | None, typer.Argument(help="machines; all shipped ones without any")] = None,
    config: ConfigOption = None,
    folder: Annotated[Path, typer.Option("--out", help="folder of the report")] = Path("safeloc-report"),
    depth: DepthOption = 25,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    examples: ExamplesOption = 60,
    steps: StepsOption = 60,
    as_json: JsonOption = False,
) -> None:
    """Prove, test, replay the shipped streams, and write the report: the main job."""
    names = targets or list(ENTRIES)
    if config is not None and len(names) > 1:
        raise typer.BadParameter(f"--config is of one machine, and here are {len(names)}: {', '.join(names)}.")
    loaded = _distinct([load_target(name, config) for name in names])
    usable(folder)
    limits = Limits(depth=depth, seconds=seconds, seed=seed)
    findings: list[Finding] = []
    with Progressing(sum(map(_work, loaded)), quiet=as_json) as progress:
        for one in loaded:
            progress.say(f"proving {one.name}", _claims(one, one.properties))
            findings += [*nothing_asked(one), *_proved(one, one.properties, limits, jobs, progress)]
            owed = _obliged(one, limits, jobs, progress)
            progress.say(f"testing {one.name}", len(one.properties))
            findings += [*owed, *_tested(one, examples, steps, seed, owed)]
            findings += _shipped_streams(one, progress)
    page = write_folder(folder, findings, loaded)
    if as_json:
        raise typer.Exit(result(findings, loaded, as_json=True))
    _summary(findings)
    err.print(f"report: {page}", markup=False)
    raise typer.Exit(code(findings))


def _work(target: Target) -> int:
    """Findings of all phases, as near as can be said beforehand."""
    tests, replays = len(target.properties), len(target.streams) * len(target.properties)
    return _claims(target, target.properties) + _owed(target) + tests + replays


def _distinct(targets: list[Target]) -> list[Target]:
    """A report tells machines apart by name."""
    names = [target.name for target in targets]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two machines are called {twice[0]!r}; give each machine of a report its own name.")
    return targets


def _tested(target: Target, examples: int, steps: int, seed: int, owed: Sequence[Finding]) -> list[Finding]:
    """Property tests that also start along witnesses and shipped streams, so that deep modes and cases are tested."""
    witnesses = [f.result.witness for f in owed if isinstance(f.result, Proved)]
    occurring = found(target.system, target.properties).runs()
    streams = [whole_run(target, path) for path in target.streams]
    corpus = [run for run in (*witnesses, *occurring, *streams) if run is not None]
    return run_tests(target.system, target.properties, examples=examples, steps=steps, seed=seed, corpus=corpus)


def _summary(findings: Sequence[Finding]) -> None:
    wrong = [finding for finding in findings if word(finding.result) not in ("proved", "held")]
    if wrong:
        findings_table(wrong, sum_up=False)
    out.print(summed_up(findings), markup=False)


def _shipped_streams(target: Target, progress: Progressing) -> list[Finding]:
    findings = []
    for stream in target.streams:
        progress.say(f"replaying {stream.name}", len(target.properties))
        findings += replay_stream(target, stream)[1]
    return findings
