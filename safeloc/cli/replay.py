"""The command `safeloc replay`: check properties, or the laws of the worlds, on a recorded stream."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import Target, load_target
from safeloc.cli.console import err, out, print_json, print_line
from safeloc.cli.options import ConfigOption, JsonOption, TargetArgument
from safeloc.cli.show import EXIT_CODES, code, findings_table, summed_up
from safeloc.errors import InputError, StreamError
from safeloc.explain.explanation import part_line
from safeloc.explain.failing_parts import failing_parts
from safeloc.language.verdict import Violated
from safeloc.proof.results import Finding
from safeloc.proof.verification.assumptions import Judged, judge_recording
from safeloc.proof.verification.replay import Row, as_table, replay_stream
from safeloc.report.assumptions import as_data, as_lines, numbers_of
from safeloc.report.data import report_data
from safeloc.report.folder import usable, write_folder
from safeloc.report.made_by import made_by
from safeloc.report.run_files import format_of
from safeloc.report.run_files.columns import RunColumns, run_columns
from safeloc.runtime.embedding.cycle_length import configured_period_ms
from safeloc.target import find_recording, recording_name

_MOST_PARTS = 20
_FIRST_AND_LAST = 5
"""Steps at either end of a recording that a terminal always gets."""


def replay(
    target: TargetArgument,
    stream: Annotated[
        Path,
        typer.Argument(
            help="JSONL, CSV or Parquet with the inputs of every step; or a recording that ships (safeloc list recordings)"
        ),
    ],
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
    written: Annotated[
        Path | None,
        typer.Option(
            "--to", help="write the run, state and outputs included: FILE.csv, .parquet, .vcd or .mcap", dir_okay=False
        ),
    ] = None,
    assumptions: Annotated[
        bool,
        typer.Option(
            "--assumptions",
            help="check the laws of the worlds instead: the least distance of each to a breach, and every breach",
        ),
    ] = False,
    every: Annotated[bool, typer.Option("--all", help="every row of the table, also on a terminal")] = False,
    as_json: JsonOption = False,
) -> None:
    """Run a recorded stream through a machine; check every property on it, or the proofs' assumptions about the world."""
    if form not in ("table", "jsonl"):
        raise typer.BadParameter(f"--format {form!r}: choose table or jsonl.")
    if run is not None and period is not None:
        raise typer.BadParameter("--period-ms groups single records; the run of --run consists of steps.")
    loaded = load_target(target, config)
    stream = find_recording(loaded, stream)
    if assumptions:
        if folder is not None or written is not None or form != "table":
            raise typer.BadParameter("--assumptions excludes --out, --to and --format; give --json for data.")
        judged = judge_recording(loaded, stream, period_ms=period, run=run)
        _print_judged(loaded, stream.name, judged, as_json=as_json)
        raise typer.Exit(_exit_code(judged))
    if folder is not None:
        usable(folder)
    write = None if written is None else format_of(written)
    try:
        rows, findings = replay_stream(loaded, stream, period_ms=period, run=run)
    except StreamError as error:
        if loaded.other_figures and stream in loaded.streams:
            raise InputError(
                f"{error} The recording {recording_name(stream)} was made with other figures than those of {config}, which "
                "cannot take it; replay a recording of your own vehicle, or leave out --config."
            ) from error
        raise
    if written is not None and write is not None:
        try:
            write(written, _columns(loaded, findings, period))
        except OSError as error:
            raise InputError(f"{written}: cannot be written: {error.strerror}.") from error
        err.print(f"run: {written}", markup=False)
    if folder is not None:
        page = write_folder(folder, findings, [loaded], made=made_by(sys.argv[1:], {}))
        err.print(f"report: {page}", markup=False)
    if as_json:
        print_json(report_data(findings, [loaded]))
    elif form == "jsonl":
        for row in rows:
            sys.stdout.write(row.as_json() + "\n")
    else:
        _print_run(loaded, rows, findings, every_row=every or not out.is_terminal)
    raise typer.Exit(code(findings))


def _print_run(target: Target, rows: Sequence[Row], findings: Sequence[Finding], *, every_row: bool) -> None:
    """Print the verdict, the table of steps, each finding with the term that broke, and the verdict again."""
    out.print(summed_up(findings), markup=False)
    lines = as_table(rows)
    for line in lines if every_row else _shown(rows, lines):
        out.print(line, markup=False)
    findings_table(findings, sum_up=False)
    for line in _broken_terms(target, findings):
        print_line(line)
    out.print(summed_up(findings), markup=False)


def _broken_terms(target: Target, findings: Sequence[Finding]) -> Iterator[str]:
    """Yield, of each violated property, the parts of its term that fail in the first step that violates it."""
    claims = {prop.name: prop for prop in target.properties}
    for finding in findings:
        prop = claims.get(finding.id.partition(": ")[2])
        if prop is not None and isinstance(finding.result, Violated) and finding.result.trace is not None:
            at = len(finding.result.trace.steps)
            yield f"\n{prop.name}: the part that fails in step {at}, with its values"
            yield from (f"  {part_line(part)}" for part in failing_parts(finding.result.trace, prop)[:_MOST_PARTS])


def _columns(target: Target, findings: Sequence[Finding], period_ms: int | None) -> RunColumns:
    """Return the replayed run as columns; without a period of single records its cycle is the configured one."""
    replayed = findings[0].replayed
    assert replayed is not None  # every finding of a replay has its run
    period = period_ms or configured_period_ms(target.name, target.config)
    return run_columns(replayed.trace, period_ms=period, truth_mm=replayed.truth_mm)


def _shown(rows: Sequence[Row], lines: Sequence[str]) -> Iterator[str]:
    """Yield the lines for a terminal: heading, first and last steps, every change of mode, and how many steps lie between.

    lines  the heading, and a line for each row
    """
    yield lines[0]
    before = 0
    for number, line in enumerate(lines[1:]):
        ends = number < _FIRST_AND_LAST or number >= len(rows) - _FIRST_AND_LAST
        if ends or rows[number].modes != rows[number - 1].modes:
            if number > before:
                yield f"... {number - before} more steps without a change of mode; --all prints them"
            yield line
            before = number + 1


def _print_judged(target: Target, recording: str, judged: Judged, *, as_json: bool) -> None:
    numbers = numbers_of(target)
    if as_json:
        print_json(as_data(recording, judged, numbers))
        return
    for line in as_lines(recording, judged, numbers):
        print_line(line)


def _exit_code(judged: Judged) -> int:
    """Return 0 if no law was broken, 1 if one was, 3 if the recording shows no law."""
    return EXIT_CODES["violated" if judged.broken else "held" if judged.every else "not asked"]
