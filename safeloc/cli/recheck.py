"""`safeloc recheck`: check every proof of a report folder again, by a program that did not find it."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import typer

from safeloc.checker.answer import CONFIRMED, NO_PROOF
from safeloc.checker.around.checking import check_around, is_around
from safeloc.checker.folder import Checking, check_folder
from safeloc.checker.solve import NEEDED, SOLVERS
from safeloc.checker.unsat import Survey, survey
from safeloc.cli.console import err, print_json, print_line
from safeloc.cli.show import Progressing
from safeloc.errors import InputError

_SCHEMA = "safeloc-recheck/1"
_EVERY = 100  # certificates to a line of progress in a pipe


def recheck(
    folder: Annotated[
        Path, typer.Argument(help="folder that `safeloc verify --out` or `safeloc prove --around --out` wrote")
    ],
    jobs: Annotated[int, typer.Option(help="processes", min=1)] = 2,
    seconds: Annotated[float, typer.Option(help="time limit of a solver for each goal", min=0.1)] = 60.0,
    proofs: Annotated[
        bool,
        typer.Option(
            "--proofs", help="also produce and check cvc5's proof of every goal, step by step (8 times slower)"
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help=f"print JSON only (schema {_SCHEMA})")] = False,
) -> None:
    """Check every proof of a report again, from the report's files and the declaration alone.

    Exit code 0: all proofs are confirmed; 1: a certificate or a claim is wrong; 3: something could not be confirmed.
    """
    around = is_around(folder)
    if proofs and around:
        raise InputError(f"{folder}: --proofs is about the certificates of a report; this is a proof around a stream.")
    with Progressing(1, quiet=as_json) as progress:
        progress.say(f"checking {folder}", 1)
        check, what = (check_around, "stretches") if around else (check_folder, "certificates")
        found = check(
            folder, jobs=jobs, seconds=seconds, progress=lambda *n: _print_progress(*n, quiet=as_json, what=what)
        )
    steps = (
        survey(folder, jobs=jobs, seconds=seconds, progress=lambda *n: _print_progress(*n, quiet=as_json))
        if proofs
        else None
    )
    if as_json:
        print_json(_data(found) | ({} if steps is None else {"proofs": _step_data(steps)}))
    else:
        for line in (
            *_lines(found, "questions" if around else "certificates"),
            *([] if steps is None else _step_lines(steps)),
        ):
            print_line(line)
    raise typer.Exit(found.exit_code)


def _print_progress(done: int, total: int, *, quiet: bool, what: str = "certificates") -> None:
    if not quiet and (done == total or done % _EVERY == 0 or sys.stderr.isatty()):
        err.print(f"{done} of {total} {what}", markup=False, end="\r" if sys.stderr.isatty() else "\n")


def _lines(found: Checking, asked: str) -> list[str]:
    """Return a line for each unconfirmed result with its reason, then the counts."""
    lines = [f"{row.answer:17} {row.id}: {row.why}" for row in found.rows if row.answer not in (CONFIRMED, NO_PROOF)]
    lines += [f"{'wrong':17} {name}: {why}" for name, why in sorted(found.wrong.items())]
    lines += [f"{'undecided':17} {name}: {why}" for name, why in sorted(found.undecided.items())]
    answers = Counter(row.answer for row in found.rows)
    return [
        *lines,
        ", ".join(f"{count} {answer}" for answer, count in answers.items()) or "no results",
        *_solvers(found, asked),
    ]


def _solvers(found: Checking, asked: str) -> list[str]:
    """Return a line for each solver with the number of goals that it confirms."""
    answers = {
        name: [one for each in found.opinions.values() for one in each.answers.get(name, ())] for name in SOLVERS
    }
    if not found.opinions:
        return [f"no solver was asked: there are no {asked}"]
    return [
        f"{name}: {given.count('unsat')} of {len(given)} goals of {len(found.opinions)} {asked}"
        if given or name in NEEDED
        else f"{name}: not installed"
        for name, given in answers.items()
    ]


def _step_lines(found: Survey) -> list[str]:
    """Return lines with the number of certificates that need no trust in a solver, and the unchecked steps of the others."""
    every = len(found.sure) + len(found.trusted) + len(found.unproved)
    lines = [f"no proof          {name}: {where}" for name, where in sorted(found.unproved.items())]
    lines += [f"{rule}: {count} steps not checked" for rule, count in found.rules.most_common()]
    return [
        *lines,
        f"{len(found.sure)} of {every} certificates need no trust in a solver: every step of their proofs was checked",
    ]


def _step_data(found: Survey) -> dict[str, Any]:
    return {"nothing_trusted": sorted(found.sure), "trusted": found.trusted, "no_proof": found.unproved}


def _data(found: Checking) -> dict[str, Any]:
    return {
        "schema": _SCHEMA,
        "exit_code": found.exit_code,
        "results": [vars(row) for row in found.rows],
        "wrong": found.wrong,
        "undecided": found.undecided,
        "certificates": {name: each.answers for name, each in sorted(found.opinions.items())},
    }
