"""The command `safeloc report`: render the page of a report folder again, unpack it, or compare it with an earlier one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import err, print_line
from safeloc.cli.options import SingleOption
from safeloc.cli.show import EXIT_CODES
from safeloc.report.changes import changes
from safeloc.report.extract import extract
from safeloc.report.folder import render_folder
from safeloc.report.stored import DATA, checked, read_for_page


def report(
    folder: Annotated[Path, typer.Argument(help="folder that `safeloc verify` wrote")],
    single: SingleOption = False,
    to: Annotated[
        Path | None,
        typer.Option(
            "--extract", help="instead of the page, write certificates as .smt2 and runs as .jsonl into this folder"
        ),
    ] = None,
    earlier: Annotated[
        Path | None,
        typer.Option(
            "--diff", help="instead of the page, print what changed since the report in this folder", file_okay=False
        ),
    ] = None,
    since: Annotated[
        Path | None,
        typer.Option("--since", help="the page says what changed since the report in this folder", file_okay=False),
    ] = None,
) -> None:
    """Render the page of a report folder again, unpack its certificates and traces, or compare it with an earlier report.

    With --diff: exit code 1 if a verdict is worse than before, a new result is neither proved nor held, or a result is gone.
    """
    if earlier is not None:
        if single or to is not None or since is not None:
            raise typer.BadParameter("--diff writes nothing; leave out --single-file, --extract and --since.")
        raise typer.Exit(_compared(earlier, folder))
    if to is None:
        err.print(f"report: {render_folder(folder, single=single, since=since)}", markup=False)
    elif single or since is not None:
        raise typer.BadParameter("--single-file and --since apply to the page, and --extract writes no page.")
    else:
        texts, runs = extract(folder, to)
        err.print(f"{to}: {texts} certificates, {runs} traces", markup=False)


def _compared(earlier: Path, folder: Path) -> int:
    """Print what changed, and return the exit code."""
    old, new = read_for_page(earlier), read_for_page(folder)
    found = checked(folder / DATA, lambda: changes(old, new))
    for line in found.lines:
        print_line(line)
    return EXIT_CODES["violated" if found.worse else "held"]
