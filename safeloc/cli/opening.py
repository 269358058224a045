"""The command `safeloc open`: show a report, a stream or the recordings of a machine in a browser."""

from __future__ import annotations

import os
import sys
import tempfile
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import err, print_line
from safeloc.errors import InputError
from safeloc.report.opening import Found, find

_UNFIT = 2


def open_(
    word: Annotated[str, typer.Argument(help="a report folder, a stream, a machine, or a recording that ships")],
    machine: Annotated[
        str | None, typer.Option("--machine", help="the machine of a stream that does not name it")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="write the page of a stream or machine here", dir_okay=False)
    ] = None,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="open the page, or only print its path")
    ] = True,
) -> None:
    """Show a report, a stream or the recordings of a machine in a browser: search, and step through every run.

    Nothing listens on the network: the page is a file. Exit code 2 if the files of a report do not fit their digests.
    """
    found = find(word, machine)
    if out is not None and found.page is not None:
        raise typer.BadParameter(
            f"--out is for the page of a stream or a machine; that of this report is {found.page}."
        )
    page = found.page or _written(found, out)
    print_line(str(page))
    for line in found.origin:
        err.print(line, markup=False)
    for line in found.unfit:
        err.print(f"safeloc: {line}", markup=False)
    if browser and _has_screen():
        webbrowser.open(page.absolute().as_uri())
    raise typer.Exit(_UNFIT if found.unfit else 0)


def _written(found: Found, out: Path | None) -> Path:
    """Write the page and return its path; without `out` in a new folder for temporary files."""
    path = out or Path(tempfile.mkdtemp(prefix="safeloc-")) / "index.html"
    try:
        path.write_text(found.text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}.") from error
    return path


def _has_screen() -> bool:
    """Return whether a browser can show something; one in the terminal is only used where the user names it."""
    if "BROWSER" in os.environ or sys.platform == "darwin":
        return True
    return "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ
