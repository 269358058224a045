"""What the command line prints: progress on a terminal, plain lines in a pipe, JSON on demand."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from safeloc.report.data import report_data
from safeloc.results import Finding
from safeloc.verdict import Proved, Unknown, Violated, word, worst

EXIT_CODES: Mapping[str, int] = {"proved": 0, "held": 0, "violated": 1, "unknown": 3}
COLOURS: Mapping[str, str] = {"proved": "green", "held": "cyan", "violated": "bold red", "unknown": "yellow"}

out = Console(highlight=False, soft_wrap=True)
err = Console(stderr=True, highlight=False, soft_wrap=True)


class Progressing:
    """Counts findings: a bar with a time estimate on a terminal, one line a finding in a pipe."""

    def __init__(self, total: int, *, quiet: bool) -> None:
        self._quiet = quiet
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=err,
            disable=quiet or not sys.stderr.isatty(),
        )
        self._task = self._bar.add_task("checking", total=total)

    def __enter__(self) -> Progressing:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def say(self, text: str) -> None:
        """What is going on now."""
        self._bar.update(self._task, description=text)
        if not self._quiet and not sys.stderr.isatty():
            err.print(text)

    def add(self, finding: Finding) -> None:
        """One more finding."""
        self._bar.advance(self._task)
        if not self._quiet and not sys.stderr.isatty():
            err.print(f"{word(finding.result):9} {finding.id}  ({finding.seconds:.1f} s)", markup=False)


def findings_table(findings: Sequence[Finding]) -> None:
    """The verdict table (plain lines in a pipe), then the evidence of everything that is not well."""
    if not out.is_terminal:
        for finding in findings:
            out.print(f"{word(finding.result):9} {finding.id}  [{finding.method}]", markup=False)
    else:
        _table(findings)
    for finding in findings:
        _evidence(finding)
    counts = {verdict: sum(word(f.result) == verdict for f in findings) for verdict in EXIT_CODES}
    out.print(", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count) or "nothing to check")


def _table(findings: Sequence[Finding]) -> None:
    table = Table("verdict", "statement", "method", "requirements")
    for finding in findings:
        verdict = word(finding.result)
        table.add_row(
            f"[{COLOURS[verdict]}]{verdict}[/]",
            f"{_escape(finding.id)}\n[dim]{_escape(finding.statement)}[/]",
            _escape(finding.method),
            " ".join(finding.requirements),
        )
    out.print(table)


def _escape(text: str) -> str:
    return text.replace("[", "\\[")


def _evidence(finding: Finding) -> None:
    match finding.result:
        case Violated(trace, engine, reason):
            out.print(f"\n[bold red]violated[/] {_escape(finding.id)}: {_escape(finding.statement)}")
            out.print(f"found by {engine}. {reason}".rstrip(), markup=False)
            if trace is not None:
                out.print(trace.table(), markup=False)
        case Unknown(reason, depth):
            out.print(f"\n[yellow]unknown[/] {_escape(finding.id)}: {_escape(reason)} (clean up to step {depth})")
        case Proved() | _:
            pass


def print_json(data: object) -> None:
    """JSON and nothing else on standard output."""
    print(json.dumps(data, indent=2))


def result(findings: Sequence[Finding], targets: Iterable[Any], *, as_json: bool) -> int:
    """Print findings and return the exit code."""
    if as_json:
        print_json(report_data(findings, targets))
    else:
        findings_table(findings)
    return EXIT_CODES[worst(word(finding.result) for finding in findings)]
