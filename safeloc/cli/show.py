"""Output of the command line: progress bars on a terminal, plain lines in a pipe, JSON on demand."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import assert_never

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from safeloc.cli.console import err, folded, out, print_json, print_line
from safeloc.cli.finding_lines import finding_line, finding_lines, verdict_word
from safeloc.language.verdict import SHOWN, Held, NotAsked, Proved, Unknown, Vacuous, Violated, told, word, worst
from safeloc.proof.results import Finding
from safeloc.proof.verification.unasked import QUICK
from safeloc.report.data import report_data
from safeloc.report.headline import KindAndVerdict, counted, headline
from safeloc.target import Target

EXIT_CODES: Mapping[str, int] = {"proved": 0, "held": 0, "violated": 1, "unknown": 3, "vacuous": 3, "not asked": 3}
_SHOWN_STEPS = 30
"""Steps of a run that are printed; the report holds all of them."""
_LINES_OF_A_TERM = 4
_OF_THE_ASSUMPTION = ("assumption", "assumption lasts", "dead ends")
"""Obligations that are violated if nothing can keep the assumption."""
_COLOURS: Mapping[str, str] = {
    "proved": "green",
    "shown": "blue",
    "held": "cyan",
    "violated": "bold red",
    "unknown": "yellow",
    "vacuous": "magenta",
    "not asked": "yellow",
}


class Progressing:
    """Display of progress: a bar with a time estimate on a terminal, one line per finding in a pipe, nothing with --json.

    planned  expected number of findings of all phases. Each phase has a fixed share of the bar, also if it has more or
             fewer findings than expected
    """

    def __init__(self, planned: int, *, quiet: bool) -> None:
        self._plain = not quiet and not sys.stderr.isatty()
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("about"),
            TimeRemainingColumn(),
            TextColumn("left"),
            console=err,
            disable=quiet or self._plain,
            transient=True,
        )
        self._task = self._bar.add_task("", total=planned)
        self._done, self._end = 0, 0

    def __enter__(self) -> Progressing:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    @property
    def done(self) -> tuple[int, int]:
        """Return the number of findings so far, and the expected number."""
        return int(self._bar.tasks[0].completed), int(self._bar.tasks[0].total or 0)

    def say(self, text: str, planned: int) -> None:
        """Begin a new phase with its expected number of findings; this ends the phase before."""
        self._done, self._end = self._end, self._end + planned
        self._bar.update(self._task, description=text, completed=self._done, refresh=True)
        if self._plain:
            err.print(text, markup=False)

    def add(self, finding: Finding) -> None:
        """Count a finding; print it in a pipe."""
        self.tick(f"{verdict_word(finding.result):9} {finding.id}  ({finding.seconds:.1f} s)")

    def tick(self, line: str) -> None:
        """Count one item; print the line in a pipe."""
        self._done = min(self._done + 1, self._end)
        self._bar.update(self._task, completed=self._done)
        if self._plain:
            err.print(line, markup=False)


def findings_table(findings: Sequence[Finding], targets: Iterable[Target] = (), *, sum_up: bool = True) -> None:
    """Print every verdict, the evidence of every bad result, and the headline; of these targets, also how to have a run explained."""
    made = {target.name: target for target in targets}
    for finding in findings:
        _finding(finding)
    for finding in findings:
        _evidence(finding)
        if isinstance(finding.result, Violated) and _is_explained(finding, made):
            out.print(f"Why: {_explaining(made[finding.machine], finding)}", markup=False, soft_wrap=True)
        for what, text in finding.notes.items():
            out.print("")
            print_line(f"{what}: {text}")
    for page in _pages_to_read(findings):
        out.print(f"\nWhat to try: safeloc docs {page}", markup=False)
    if sum_up:
        out.print(summed_up(findings), markup=False)


def _is_explained(finding: Finding, made: Mapping[str, Target]) -> bool:
    """Return whether `safeloc explain` knows the finding: a claim that is written on the command line is none of the target's."""
    target = made.get(finding.machine)
    names = () if target is None else {prop.name for prop in target.properties}
    return finding.kind == "property" and finding.id.split("/", 2)[2] in names


def _explaining(target: Target, finding: Finding) -> str:
    """Return the command that explains a finding of a property."""
    made_with: list[str] = []
    if target.config_file is not None:
        made_with = ["--config", str(target.config_file)]
    elif target.configuration:
        made_with = ["--configuration", target.configuration]
    return shlex.join(["safeloc", "explain", target.spec or target.name, finding.id.split("/", 2)[2], *made_with])


def _pages_to_read(findings: Sequence[Finding]) -> list[str]:
    """Return the pages of the documentation that help with these findings."""
    undecided = any(isinstance(one.result, Unknown) and one.kind != "replay" for one in findings)
    empty = any(
        isinstance(one.result, Vacuous)
        or (isinstance(one.result, Violated) and one.id.rpartition("/")[2] in _OF_THE_ASSUMPTION)
        for one in findings
    )
    return ["howto/undecided"] * undecided + ["howto/empty_assumption"] * empty


def print_summary(findings: Sequence[Finding], targets: Iterable[Target] = ()) -> None:
    """Print the results that are neither proved nor held, and the headline; what a quick run left open is only counted."""
    wrong = [one for one in findings if word(one.result) not in ("proved", "held") and one.method != QUICK]
    if wrong:
        findings_table(wrong, targets, sum_up=False)
    out.print(summed_up(findings), markup=False)


def summed_up(findings: Sequence[Finding]) -> str:
    """Return one line with the overall verdict and the number of findings of each verdict."""
    verdicts = [
        KindAndVerdict(one.kind, word(one.result), one.method == QUICK, told(one.result) == SHOWN) for one in findings
    ]
    return ": ".join(part for part in (headline(verdicts), counted(verdicts)) if part)


def code(findings: Sequence[Finding]) -> int:
    """Return the exit code of the worst finding; that of `not asked` if there is no finding."""
    return EXIT_CODES[worst(word(finding.result) for finding in findings)]


def _finding(finding: Finding) -> None:
    """Print one finding: a line in a pipe; on a terminal at most two, with the verdict in colour."""
    if not out.is_terminal:
        out.print(finding_line(finding), markup=False)
        return
    verdict = verdict_word(finding.result)
    first, *rest = finding_lines(finding, out.width)
    out.print(f"[{_COLOURS[verdict]}]{verdict}[/]{_escape(first.removeprefix(verdict))}")
    for line in rest:
        out.print(line, markup=False)


def _long(text: str) -> None:
    """Print a text that may hold whole terms: in full in a pipe, the first lines on a terminal."""
    lines = [text] if not out.is_terminal else folded(text, out.width)
    for line in lines[:_LINES_OF_A_TERM]:
        out.print(line, markup=False)
    if len(lines) > _LINES_OF_A_TERM:
        out.print(f"    ... {len(lines) - _LINES_OF_A_TERM} more lines; in a pipe all are printed", markup=False)


def _escape(text: str) -> str:
    return text.replace("[", "\\[")


def _evidence(finding: Finding) -> None:
    match finding.result:
        case Violated(trace, engine, reason):
            says = "" if finding.id.endswith(f"/{finding.statement}") else f": {finding.statement}"
            out.print(f"\n[bold red]violated[/] {_escape(finding.id)}{_escape(says)}")
            out.print(f"found by {engine}. {reason}".rstrip(), markup=False)
            if trace is not None:
                out.print(trace.table(_SHOWN_STEPS), markup=False)
        case Unknown(reason) as unknown:
            how_far = "" if finding.kind == "replay" else f" ({unknown.searched})"  # of one run nothing is searched
            out.print(f"\n[yellow]unknown[/] {_escape(finding.id)}: {_escape(reason)}{how_far}")
        case Vacuous(reason, trace):
            out.print(f"\n[magenta]vacuous[/] {_escape(finding.id)}: {_escape(reason)}")
            if trace is not None:
                out.print(trace.table(_SHOWN_STEPS), markup=False)
        case NotAsked(reason):
            out.print(f"\n[yellow]not asked[/] {_escape(finding.id)}: {_escape(reason)}")
        case Held(notes=notes) if finding.kind == "replay" and notes:
            out.print("")
            _long(f"{finding.id}: " + ", ".join(f"{what}: {number}" for what, number in notes.items()))
        case Proved() | Held():
            pass
        case _:
            assert_never(finding.result)


def result(findings: Sequence[Finding], targets: Iterable[Target], *, as_json: bool) -> int:
    """Print findings and return the exit code."""
    if as_json:
        print_json(report_data(findings, targets))
    else:
        findings_table(findings, targets)
    return code(findings)
