"""Tables of balise groups (XLSX) as lines: columns NID_C, NID_BG, Lint, Km, Or BG, Or Lint, Spoornr.

This is the form of the engineering data of Utrecht-Amsterdam. Each row is a group: `Km` is its place in metres along the
kilometre line `Lint`, `Spoornr` its track, `Or BG` the town in its nominal direction. The table does not contain where
tracks begin and end, or how they are connected: every track of a kilometre line becomes an edge of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.elements import Balise, BaliseGroup, Direction, KilometrePoint, Node, TrackEdge
from safeloc.railway.map.imports.building import made, within
from safeloc.railway.map.imports.lengths import decimal, millimetres
from safeloc.railway.map.imports.notes import Imported, Note
from safeloc.railway.map.imports.spreadsheet import Sheet, read_sheet
from safeloc.railway.map.model import Line
from safeloc.runtime.outside import quoted

COLUMNS = ("NID_C", "NID_BG", "Lint", "Km", "Or BG", "Or Lint", "Spoornr")
_MARGIN_MM = 1_000
"""A track extends this far beyond its first and last group."""

_NOMINAL: Mapping[tuple[str, str], Direction] = {
    ("Z", "Utrecht"): "increasing",
    ("Z", "Amsterdam"): "decreasing",
    ("N", "Utrecht"): "decreasing",
    ("N", "Amsterdam"): "increasing",
}
"""(direction of rising kilometres: Z south, N north; town) -> direction. Utrecht lies south of Amsterdam."""


@dataclass(frozen=True)
class Row:
    """One group of the table."""

    place: str
    country: int
    identity: int
    line: str
    kilometre_mm: int
    nominal: Direction
    track: str

    @property
    def edge(self) -> str:
        """The edge that the group lies on."""
        return f"{self.line} {self.track}"


def read_balise_table(path: Path, *, name: str | None = None, version: str | None = None) -> Imported:
    """Return the groups of the first sheet.

    name, version  of the line; by default the file's name, and "1"
    Raises InputError with sheet and row for wrong cells and for groups given twice; EngineError without openpyxl.
    """
    with within(path):
        return _imported(read_sheet(path), name or path.stem, version or "1", path.name)


def _imported(sheet: Sheet, name: str, version: str, source: str) -> Imported:
    notes: list[Note] = []
    rows = list(_rows(sheet, notes))
    _refuse_twice(rows)
    notes += _assumed()
    spans = _spans(rows)
    edges = tuple(_edge(edge, *span) for edge, span in spans.items())
    line = made(
        Line,
        "table",
        name=name,
        version=version,
        source=source,
        nodes=tuple(
            made(Node, edge.id, id=node, kind="border") for edge in edges for node in (edge.from_node, edge.to_node)
        ),
        edges=edges,
        balise_groups=tuple(_group(row, spans[row.edge][0].kilometre_mm) for row in rows),
    )
    return Imported(line, tuple(notes))


# ------------------------------------------------------------------ cells


def _rows(sheet: Sheet, notes: list[Note]) -> Iterator[Row]:
    where = f"sheet {sheet.title!r}"
    notes += [Note("not carried over", f"sheet {other!r}", "only the first sheet is read") for other in sheet.others]
    heading = [str(cell).strip() if cell is not None else "" for cell in sheet.heading]
    at = {column: _column(heading, column, where) for column in COLUMNS}
    for column in heading:
        if column and column not in COLUMNS:
            notes.append(Note("not understood", where, f"column {column!r}"))
    if not sheet.rows:
        raise InputError(f"{where}: has no rows.")
    for number, row in sheet.rows:
        yield _row(f"{where} row {number}", {column: row[index] for column, index in at.items()})


def _column(heading: Sequence[str], column: str, where: str) -> int:
    if heading.count(column) != 1:
        there = ", ".join(repr(one) for one in heading if one) or "none"
        raise InputError(f"{where}: needs one column {column!r}; it has {there}.")
    return heading.index(column)


def _row(place: str, found: Mapping[str, Any]) -> Row:
    rising, town = _text(found, "Or Lint", place), _text(found, "Or BG", place)
    if (rising, town) not in _NOMINAL:
        raise InputError(
            f"{place}: 'Or Lint' {rising!r} with 'Or BG' {town!r} is not known; use Z or N, Utrecht or Amsterdam."
        )
    kilometre_mm, exact = millimetres(decimal(_number(found, "Km", place), f"{place}: column 'Km'"))
    if not exact:
        raise InputError(f"{place}: column 'Km': {found['Km']} m is no whole number of mm.")
    return Row(
        place,
        _whole_number(found, "NID_C", place),
        _whole_number(found, "NID_BG", place),
        _text(found, "Lint", place),
        kilometre_mm,
        _NOMINAL[rising, town],
        _text(found, "Spoornr", place),
    )


def _number(cells: Mapping[str, Any], column: str, place: str) -> str:
    """Return a number as a spreadsheet shows it; the file holds binary fractions."""
    value = cells[column]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"{place}: column {column!r}: expected a number, got {quoted(value)}.")
    return repr(value)


def _whole_number(cells: Mapping[str, Any], column: str, place: str) -> int:
    value = decimal(_number(cells, column, place), f"{place}: column {column!r}")
    if value != value.to_integral_value():
        raise InputError(f"{place}: column {column!r}: expected a whole number, got {value}.")
    return int(value)


def _text(cells: Mapping[str, Any], column: str, place: str) -> str:
    value = cells[column]
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{place}: column {column!r}: expected text, got {quoted(value)}.")
    return value.strip()


def _refuse_twice(rows: Sequence[Row]) -> None:
    first: dict[tuple[int, int], Row] = {}
    for row in rows:
        before = first.setdefault((row.country, row.identity), row)
        if before is not row:
            raise InputError(
                f"{row.place}: NID_C {row.country}, NID_BG {row.identity} is that of {before.place} as well."
            )


# ------------------------------------------------------------------ the line


def _assumed() -> Iterator[Note]:
    """Yield notes on what the line assumes because the table does not contain it."""
    yield Note("assumed", "column 'Km'", "metres along the kilometre line, without jumps")
    yield Note("assumed", "column 'Or Lint'", "Z: rising kilometres lead south, N: north; Utrecht is the south end")
    yield Note(
        "assumed",
        "column 'Spoornr'",
        "a track reaches 1 m beyond its first and last group; connections between tracks are unknown",
    )
    yield Note(
        "assumed",
        "column 'NID_BG'",
        "linked; one balise: the table tells neither links nor the places of single balises",
    )


def _spans(rows: Sequence[Row]) -> dict[str, tuple[Row, Row]]:
    """Return for each edge its groups with the lowest and the highest kilometre, in the order of the table."""
    by_edge: dict[str, list[Row]] = {}
    for row in rows:
        by_edge.setdefault(row.edge, []).append(row)
    return {
        edge: (min(of_edge, key=lambda row: row.kilometre_mm), max(of_edge, key=lambda row: row.kilometre_mm))
        for edge, of_edge in by_edge.items()
    }


def _edge(edge: str, lowest: Row, highest: Row) -> TrackEdge:
    start = made(KilometrePoint, lowest.place, kilometre_mm=lowest.kilometre_mm - _MARGIN_MM, line=lowest.line)
    return made(
        TrackEdge,
        lowest.place,
        id=edge,
        from_node=f"{edge} low end",
        to_node=f"{edge} high end",
        length_mm=highest.kilometre_mm - lowest.kilometre_mm + 2 * _MARGIN_MM,
        track=lowest.track,
        kilometres=(start,),
    )


def _group(row: Row, lowest_mm: int) -> BaliseGroup:
    return made(
        BaliseGroup,
        row.place,
        id=f"{row.country}-{row.identity}",
        edge=row.edge,
        identity=row.identity,
        country=row.country,
        balises=(made(Balise, row.place, position_mm=row.kilometre_mm - lowest_mm + _MARGIN_MM),),
        nominal_direction=row.nominal,
    )
