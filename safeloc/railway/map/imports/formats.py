"""The formats of maps that can be imported, by name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from safeloc.errors import InputError
from safeloc.railway.map.imports.balise_table import read_balise_table
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.notes import Imported
from safeloc.railway.map.imports.railml import read_railml
from safeloc.railway.map.imports.ttobench import read_ttobench


class Importer(Protocol):
    """Reads a file. `name` and `version` of the line come from the file unless they are given."""

    def __call__(self, path: Path, *, name: str | None = None, version: str | None = None) -> Imported: ...


FORMATS: Mapping[str, Importer] = {
    "railml": read_railml,
    "geojson": read_geojson,
    "balises": read_balise_table,
    "ttobench": read_ttobench,
}
SUFFIXES = {".railml": "railml", ".xml": "railml", ".geojson": "geojson", ".xlsx": "balises"}


def importer(path: Path, form: str | None = None) -> Importer:
    """Return the importer of the format, by default that of the file's suffix. InputError for an unknown format."""
    chosen = form if form is not None else SUFFIXES.get(path.suffix.lower())
    if chosen is None:
        raise InputError(f"{path}: its suffix is no known format; name one of {', '.join(FORMATS)}.")
    if chosen not in FORMATS:
        raise InputError(f"{chosen!r} is no format of lines; there are {', '.join(FORMATS)}.")
    return FORMATS[chosen]
