"""`safeloc export`: a machine as code, diagram, table or solver text, in one file or a folder."""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import Target, load_target
from safeloc.cli.console import err
from safeloc.codegen.c99 import to_c
from safeloc.codegen.compiled import to_python
from safeloc.codegen.diagram import to_dot, to_mermaid, to_svg, to_table
from safeloc.codegen.fmu import to_fmu
from safeloc.errors import InputError
from safeloc.language.expr import Bool
from safeloc.language.system import without_ghosts
from safeloc.proof.provers.lasting import lasting
from safeloc.proof.provers.proved_base import base
from safeloc.proof.runs.lawful import first_state
from safeloc.proof.runs.sampled import sampled_runs
from safeloc.runtime.embedding.cycle_length import configured_period_ms

_TEXTS: Mapping[str, Callable[[Target], str]] = {
    "python": lambda target: to_python(without_ghosts(target.system)),
    "mermaid": lambda target: "".join(map(to_mermaid, target.machines)),
    "dot": lambda target: "".join(map(to_dot, target.machines)),
    "svg": lambda target: "".join(map(to_svg, target.machines)),
    "table": lambda target: _table(target),
    "smtlib": lambda target: "\n".join(base(target.system).certificates.values()),
}
_FOLDERS: Mapping[str, Callable[[Target], Mapping[str, str]]] = {
    "c": lambda target: to_c(
        without_ghosts(target.system), sampled_runs(target), doc=target.doc, kept=_lasting(target)
    ),
}
_FILES: Mapping[str, Callable[[Target], bytes]] = {"fmu": lambda target: _unit(target)}
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


def _unit(target: Target) -> bytes:
    """Return an FMI co-simulation unit; its period comes from the configuration, or from the machines."""
    on_board = without_ghosts(target.system)
    period_ms = configured_period_ms(target.name, target.config)
    first = first_state(on_board, random.Random(0))
    return to_fmu(on_board, period_ms=period_ms, first=first, doc=target.doc, kept=_lasting(target))


def _lasting(target: Target) -> Mapping[str, Bool] | None:
    """Return the invariants that a restored state must satisfy; None, and a warning, if not all ranges are proved."""
    err.print(f"{target.name}: proving the invariants for check_state", markup=False)
    found = lasting(target.system)
    if found is None:
        err.print("not every range is proved: check_state checks ranges only, and a step may leave them", markup=False)
    return found


def _table(target: Target) -> str:
    lines = []
    for machine in target.machines:
        for row in to_table(machine):
            lines.append(
                f"{row.name}\t{row.source}\t{row.target}\t{row.guard}\t{' '.join(row.requirements)}\t{row.declared}"
            )
    return "\n".join(lines) + "\n"
