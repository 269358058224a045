"""The commands."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from safeloc.backends.compiled import to_python
from safeloc.backends.diagram import to_dot, to_mermaid, to_svg, to_table
from safeloc.backends.smtlib import to_smtlib
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.cli.audit import audit_line
from safeloc.cli.line_import import import_line
from safeloc.cli.replay import replay_stream
from safeloc.cli.show import EXIT_CODES, Progressing, err, findings_table, out, print_json, result
from safeloc.errors import InputError, SafelocError
from safeloc.provers.base import base, step_queries
from safeloc.provers.limits import Limits
from safeloc.provers.obligations import obligations
from safeloc.provers.portfolio import prove as prove_all
from safeloc.report.data import report_data
from safeloc.report.folder import render_folder, write_folder
from safeloc.requirements import requirements
from safeloc.results import Finding
from safeloc.spec import Property
from safeloc.streams.steps import write_steps
from safeloc.system import without_ghosts
from safeloc.testing import run_tests
from safeloc.verdict import Proved, word, worst

app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)
app.command("import")(import_line)
app.command("audit")(audit_line)

TargetArgument = Annotated[
    str, typer.Argument(help="a name from `safeloc list`, or package.module:name, or file.py:name")
]
ConfigOption = Annotated[Path | None, typer.Option("--config", help="TOML or JSON with the machine's configuration")]
JsonOption = Annotated[bool, typer.Option("--json", help="print JSON only (schema safeloc-report/1)")]
DepthOption = Annotated[int, typer.Option(help="steps of bounded search", min=1)]
SecondsOption = Annotated[float, typer.Option(help="time limit for each property", min=0.1)]
JobsOption = Annotated[int, typer.Option(help="processes", min=1)]
SeedOption = Annotated[int, typer.Option(help="seed of solvers and random runs")]
ExamplesOption = Annotated[int, typer.Option(help="property-test runs", min=1)]
StepsOption = Annotated[int, typer.Option(help="steps of each property-test run", min=1)]


@app.command("list")
def list_(
    what: Annotated[str, typer.Argument(help="machines, properties or requirements")] = "machines",
    as_json: JsonOption = False,
) -> None:
    """What there is."""
    kinds = {"machines": _machines, "properties": _property_rows, "requirements": _requirement_rows}
    if what not in kinds:
        raise typer.BadParameter(f"{what!r}: choose one of {', '.join(kinds)}.")
    rows = kinds[what]()
    if as_json:
        print_json(rows)
        return
    for row in rows:
        out.print("  ".join(value for value in row.values() if value), markup=False)


def _machines() -> list[dict[str, str]]:
    return [{"name": entry.name, "summary": entry.summary} for entry in ENTRIES.values()]


def _property_rows() -> list[dict[str, str]]:
    rows = []
    for name in ENTRIES:
        for prop in load_target(name).properties:
            rows.append(
                {"machine": name, "name": prop.name, "requirements": " ".join(prop.trace), "statement": prop.statement}
            )
    return rows


def _requirement_rows() -> list[dict[str, str]]:
    return [{"id": one.id, "status": one.status, "machine": one.machine, "text": one.text} for one in requirements()]


@app.command()
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
    with Progressing(len(chosen), quiet=as_json) as progress:
        progress.say(f"proving {loaded.name}")
        findings = prove_all(loaded.system, chosen, limits, jobs=jobs, on_finding=progress.add)
        if only is None:
            findings += _obliged(loaded, limits, progress)
    raise typer.Exit(result(findings, [loaded], as_json=as_json))


def _chosen(target: Target, names: list[str] | None) -> list[Property]:
    if names is None:
        return list(target.properties)
    known = {prop.name: prop for prop in target.properties}
    missing = [name for name in names if name not in known]
    if missing:
        raise typer.BadParameter(f"{target.name} has no property {missing[0]!r}; it has {', '.join(known)}.")
    return [known[name] for name in names]


def _obliged(target: Target, limits: Limits, progress: Progressing) -> list[Finding]:
    progress.say(f"obligations of {target.name}")
    findings = obligations(target.system, limits)
    for finding in findings:
        progress.add(finding)
    return findings


@app.command()
def test(
    target: TargetArgument,
    config: ConfigOption = None,
    examples: ExamplesOption = 100,
    steps: StepsOption = 60,
    seed: SeedOption = 0,
    as_json: JsonOption = False,
) -> None:
    """Run property tests along plausible and faulty streams."""
    loaded = load_target(target, config)
    findings = _tested(loaded, examples, steps, seed, obligations(loaded.system, Limits()))
    raise typer.Exit(result(findings, [loaded], as_json=as_json))


@app.command()
def replay(
    target: TargetArgument,
    stream: Annotated[Path, typer.Argument(help="JSONL or CSV with the inputs of every step")],
    config: ConfigOption = None,
    form: Annotated[str, typer.Option("--format", help="table or jsonl")] = "table",
    as_json: JsonOption = False,
) -> None:
    """Run a recorded stream through a machine and check every property on it."""
    if form not in ("table", "jsonl"):
        raise typer.BadParameter(f"--format {form!r}: choose table or jsonl.")
    loaded = load_target(target, config)
    rows, findings = replay_stream(loaded, stream)
    if as_json:
        print_json(report_data(findings, [loaded]))
    elif form == "jsonl":
        for row in rows:
            sys.stdout.write(row.as_json() + "\n")
    else:
        out.print(rows[0].heading() if rows else "(no steps)", markup=False)
        for row in rows:
            out.print(row.as_text(), markup=False)
        findings_table(findings)
    raise typer.Exit(EXIT_CODES[worst(word(finding.result) for finding in findings)])


@app.command()
def export(
    target: TargetArgument,
    to: Annotated[str, typer.Option("--to", help="python, mermaid, dot, svg, table or smtlib")],
    config: ConfigOption = None,
    where: Annotated[Path | None, typer.Option("--out", help="file to write; standard output without it")] = None,
) -> None:
    """Write a machine in another form."""
    loaded = load_target(target, config)
    forms = {
        "python": lambda: to_python(without_ghosts(loaded.system)),
        "mermaid": lambda: "".join(map(to_mermaid, loaded.machines)),
        "dot": lambda: "".join(map(to_dot, loaded.machines)),
        "svg": lambda: "".join(map(to_svg, loaded.machines)),
        "table": lambda: _table(loaded),
        "smtlib": lambda: "\n".join(to_smtlib(query) for query in step_queries(loaded.system, base(loaded.system))),
    }
    if to not in forms:
        raise typer.BadParameter(f"--to {to!r}: choose one of {', '.join(forms)}.")
    text = forms[to]()
    if where is None:
        sys.stdout.write(text)
        return
    try:
        where.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error}") from error


@app.command()
def simulate(
    target: TargetArgument,
    where: Annotated[Path, typer.Option("--out", help="stream to write: .jsonl or .csv")],
    config: ConfigOption = None,
    seed: SeedOption = 0,
) -> None:
    """Write a stream of simulated sensors, with the truth beside it, that `replay` takes."""
    loaded = load_target(target, config)
    if loaded.simulate is None:
        able = [name for name in ENTRIES if load_target(name).simulate is not None]
        raise InputError(f"{loaded.name} has no simulation; {', '.join(able)} has.")
    steps = loaded.simulate(seed)
    try:
        write_steps(where, steps, machine=loaded.name)
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error}") from error
    err.print(f"{len(steps)} steps: {where}", markup=False)


@app.command()
def report(folder: Annotated[Path, typer.Argument(help="folder that `safeloc verify` wrote")]) -> None:
    """Render the page of a report folder again from its report.json."""
    err.print(f"report: {render_folder(folder)}", markup=False)


def _table(target: Target) -> str:
    lines = []
    for machine in target.machines:
        for row in to_table(machine):
            lines.append(
                f"{row.name}\t{row.source}\t{row.target}\t{row.guard}\t{' '.join(row.requirements)}\t{row.declared}"
            )
    return "\n".join(lines) + "\n"


@app.command()
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
    loaded = _distinct([load_target(name, config) for name in targets or list(ENTRIES)])
    limits = Limits(depth=depth, seconds=seconds, seed=seed)
    findings: list[Finding] = []
    with Progressing(sum(len(one.properties) for one in loaded), quiet=as_json) as progress:
        for one in loaded:
            progress.say(f"proving {one.name}")
            findings += prove_all(one.system, one.properties, limits, jobs=jobs, on_finding=progress.add)
            owed = _obliged(one, limits, progress)
            progress.say(f"testing {one.name}")
            findings += [*owed, *_tested(one, examples, steps, seed, owed)]
            findings += _shipped_streams(one, progress)
    page = write_folder(folder, findings, loaded)
    code = result(findings, loaded, as_json=True) if as_json else _summary(findings)
    err.print(f"report: {page}", markup=False)
    raise typer.Exit(code)


def _distinct(targets: list[Target]) -> list[Target]:
    """A report tells machines apart by name."""
    names = [target.name for target in targets]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two machines are called {twice[0]!r}; give each machine of a report its own name.")
    return targets


def _tested(target: Target, examples: int, steps: int, seed: int, owed: Sequence[Finding]) -> list[Finding]:
    """Property tests that also start where the reachability witnesses end, so that deep modes are tested as well."""
    corpus = [f.result.witness for f in owed if isinstance(f.result, Proved) and f.result.witness is not None]
    return run_tests(target.system, target.properties, examples=examples, steps=steps, seed=seed, corpus=corpus)


def _summary(findings: Sequence[Finding]) -> int:
    wrong = [finding for finding in findings if word(finding.result) in ("violated", "unknown")]
    if wrong:
        findings_table(wrong)
    counts = {verdict: sum(word(f.result) == verdict for f in findings) for verdict in EXIT_CODES}
    out.print(", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count))
    return EXIT_CODES[worst(word(finding.result) for finding in findings)]


def _shipped_streams(target: Target, progress: Progressing) -> list[Finding]:
    findings = []
    for stream in target.streams:
        progress.say(f"replaying {stream.name}")
        findings += replay_stream(target, stream)[1]
    return findings


def main() -> None:
    """Entry point: a SafelocError is one clear message and exit code 2."""
    try:
        app()
    except SafelocError as error:
        err.print(f"safeloc: {error}", markup=False)
        sys.exit(2)
