"""`safeloc export`: a machine as code, diagram, table or solver text, in one file or a folder."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import Target, load_target
from safeloc.cli.console import err
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.show import Progressing
from safeloc.codegen.c99_build import compiler
from safeloc.codegen.compiled import to_python
from safeloc.codegen.diagram import to_dot, to_mermaid, to_svg, to_table_text
from safeloc.errors import InputError
from safeloc.language.system import without_ghosts
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.exported import PHASES, Say, c_folder, fmi_unit, script
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
_FOLDERS: Mapping[str, Callable[[Target, Say, Say], Mapping[str, str]]] = {"c": c_folder}
_FILES: Mapping[str, Callable[[Target, Say, Say], bytes]] = {"fmu": fmi_unit}
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
    cache: CacheOption = None,
    fresh: FreshOption = False,
) -> None:
    """Export a machine as code, diagram, table or solver text.

    For C and FMI it proves first what every state is checked by; what `verify` or `prove` have proved of the same machine and
    configuration comes from the cache.
    """
    if to not in _FORMS:
        raise typer.BadParameter(f"--to {to!r}: choose one of {', '.join(_FORMS)}.")
    if to not in _TEXTS and where is None:
        what = "several files; name a folder" if to in _FOLDERS else "a binary file; name it"
        raise typer.BadParameter(f"--to {to} writes {what} with --out.")
    if where is not None:
        _require_place(where, folder=to in _FOLDERS)
    if to == "fmu":
        compiler()  # before a proof that may take long
    loaded = load_target(target, config)
    if where is None:
        sys.stdout.write(_TEXTS[to](loaded))
        return
    with Progressing(PHASES, quiet=to in _TEXTS) as progress, kept_in(store_in(cache), fresh=fresh):
        if to in _TEXTS:
            _write_file(_TEXTS[to](loaded).encode(), where)
        elif to in _FOLDERS:
            _write_folder(_FOLDERS[to](loaded, lambda text: progress.say(text, 1), _warn), where)
        else:
            _write_file(_FILES[to](loaded, lambda text: progress.say(text, 1), _warn), where)


def _require_place(where: Path, *, folder: bool) -> None:
    """Refuse a place that cannot be written, before anything is computed."""
    if why := _obstacle(where, folder=folder):
        raise InputError(f"{where}: cannot be written: {why}. Name a {'folder' if folder else 'file'} with --out.")


def _obstacle(where: Path, *, folder: bool) -> str:
    """Return what keeps a folder or a file from being written there; "" if nothing is seen."""
    if where.is_dir():
        return "" if folder else "it is a folder"
    if where.exists() and not folder:
        return ""
    above = next(place for place in (where, *where.absolute().parents) if place.exists())
    if not above.is_dir():
        return f"{above} is no folder"
    return "" if folder or where.absolute().parent.is_dir() else f"there is no folder {where.parent}"


def _write_file(content: bytes, where: Path) -> None:
    try:
        where.write_bytes(content)
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error.strerror or error}.") from error


def _write_folder(files: Mapping[str, str], folder: Path) -> None:
    """Write the files into the folder; other files there stay."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror or error}.") from error
    err.print(f"{len(files)} files in {folder}", markup=False)


def _warn(line: str) -> None:
    err.print(line, markup=False)
