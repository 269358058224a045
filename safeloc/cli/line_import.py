"""`safeloc import`: convert a map to our line format, with notes on everything that was lost."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import err, out, print_json
from safeloc.errors import InputError
from safeloc.railway.map.imports.formats import FORMATS, importer
from safeloc.railway.map.imports.notes import Imported, similar
from safeloc.railway.map.model import sealed
from safeloc.railway.map.toml_files import to_toml

_REFUSED = 1


def import_line(
    file: Annotated[
        Path, typer.Argument(help="railML 3, GeoJSON network, table of balises (XLSX) or TTOBench track (JSON)")
    ],
    where: Annotated[Path, typer.Option("--out", help="line to write, as TOML")],
    form: Annotated[
        str | None, typer.Option("--format", help=f"{', '.join(FORMATS)}; by default from the suffix")
    ] = None,
    name: Annotated[str | None, typer.Option("--name", help="name of the line; by default from the file")] = None,
    version: Annotated[str | None, typer.Option("--version", help='version of the map; by default "1"')] = None,
    every_note: Annotated[
        bool, typer.Option("--all-notes", help="print every note separately instead of grouped")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="print the notes as JSON only")] = False,
) -> None:
    """Import a map; report everything that was not understood, dropped or assumed. Exit code 1 where elements were refused."""
    imported = importer(file, form)(file, name=name, version=version)
    _write(where, to_toml(sealed(imported.line)))
    if as_json:
        print_json([{"kind": note.kind, "place": note.place, "text": note.text} for note in imported.notes])
    else:
        _print_notes(imported, every_note)
        err.print(f"{_summary(imported)}: {where}", markup=False)
    raise typer.Exit(_REFUSED if imported.refused else 0)


def _print_notes(imported: Imported, every_note: bool) -> None:
    """Print the refused elements one by one and first, then all other notes."""
    others = [note for note in imported.notes if note.kind != "refused"]
    for note in (*imported.refused, *(others if every_note else similar(others))):
        out.print(str(note), markup=False)


def _write(where: Path, text: str) -> None:
    try:
        where.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error}") from error


def _summary(imported: Imported) -> str:
    line = imported.line
    counts = {
        "edges": line.edges,
        "switches": line.switches,
        "balise groups": line.balise_groups,
        "signals": line.signals,
        "axle counters": line.axle_counters,
    }
    listed = ", ".join(f"{kind} {len(elements)}" for kind, elements in counts.items() if elements)
    refused = f"; elements refused {len(imported.refused)}" if imported.refused else ""
    return f"{line.name}: {listed}; notes {len(imported.notes)}{refused}"
