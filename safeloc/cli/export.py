"""`safeloc export`: a machine as code, diagram, table or solver text, in one file or a folder."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import Target, load_target
from safeloc.cli.console import err
from safeloc.codegen.compiled import to_python
from safeloc.codegen.diagram import to_dot, to_mermaid, to_svg, to_table_text
from safeloc.errors import InputError
from safeloc.language.system import without_ghosts
from safeloc.proof.exported import c_folder, fmi_unit, script
from safeloc.proof.provers.proved_base import base

_TEXTS: Mapping[str, Callable[[Target], str]] = {
    "python": lambda target: to_python(without_ghosts(target.system)),
    "mermaid": lambda target: "".join(map(to_mermaid, target.machines)),
    "dot": lambda target: "".join(map(to_dot, target.machines)),
    "svg": lambda target: "".join(map(to_svg, target.machines)),
    "table": lambda target: to_table_text(target.machines),
    "smtlib": lambda target: "\n".join(base(target.system).certificates.values()),
    "javascript": script,
}
_FOLDERS: Mapping[str, Callable[[Target], Mapping[str, str]]] = {
    "c": lambda target: c_folder(target, _say),
}
_FILES: Mapping[str, Callable[[Target], bytes]] = {"fmu": lambda target: fmi_unit(target, _say)}
_FORMS = (*_TEXTS, *_FOLDERS, *_FILES)


def export(
    target: Annotated[str, typer.Argument(help="a name from `safeloc list`, or package.module:name, or file.py:name")],
    to: Annotated[str, typer.Option("--to", help=", ".join(_FORMS))],
    config: Annotated[
        Path | None, typer.Option("--config", help="TOML or JSON with the machine's configuration")
    ] = None,
    where: Annotated[
        Path | None, typer.Option("--out", help="file to write, standard output without it; a folder for c")
    ] = None,
) -> None:
    """Export a machine as code, diagram, table or solver text."""
    if to not in _FORMS:
        raise typer.BadParameter(f"--to {to!r}: choose one of {', '.join(_FORMS)}.")
    if to not in _TEXTS and where is None:
        what = "several files; name a folder" if to in _FOLDERS else "a binary file; name it"
        raise typer.BadParameter(f"--to {to} writes {what} with --out.")
    loaded = load_target(target, config)
    if where is None:
        sys.stdout.write(_TEXTS[to](loaded))
    elif to in _FOLDERS:
        _write_folder(_FOLDERS[to](loaded), where)
    else:
        _write_file(_FILES[to](loaded) if to in _FILES else _TEXTS[to](loaded).encode(), where)


def _write_file(content: bytes, where: Path) -> None:
    try:
        where.write_bytes(content)
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error}") from error


def _write_folder(files: Mapping[str, str], folder: Path) -> None:
    """Write the files into the folder; other files there stay."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error
    err.print(f"{len(files)} files in {folder}", markup=False)


def _say(line: str) -> None:
    err.print(line, markup=False)
