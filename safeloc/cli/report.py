"""The command `safeloc report`: render the page of a report folder again, or unpack its certificates and traces."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import err
from safeloc.cli.options import SingleOption
from safeloc.report.extract import extract
from safeloc.report.folder import render_folder


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
        raise typer.BadParameter("--single-file applies to the page, and --extract writes no page.")
    else:
        texts, runs = extract(folder, to)
        err.print(f"{to}: {texts} certificates, {runs} traces", markup=False)
