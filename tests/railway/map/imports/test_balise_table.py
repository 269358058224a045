"""Tables of balise groups: the real one, and cells that do not fit."""

from __future__ import annotations

import re
import sys
import zipfile
from pathlib import Path

import openpyxl
import pytest

from safeloc.errors import EngineError, InputError
from safeloc.railway.map.imports.balise_table import COLUMNS, read_balise_table
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.places import kilometre_mm
from tests.data_sources import data_file

Cell = int | float | str | None
ROWS: list[list[Cell]] = [
    [426, 139, "Ut-As", 1_200, "Utrecht", "Z", "spoor 1"],
    [426, 140, "Ut-As", 1_000, "Amsterdam", "Z", "spoor 1"],
    [426, 141, "As-Ut", 500, "Utrecht", "N", "spoor 1"],
]


def table(folder: Path, rows: list[list[Cell]], heading: tuple[str, ...] = COLUMNS, *sheets: str) -> Path:
    """A workbook with these rows."""
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    sheet.title = "groups"
    for row in [list(heading), *rows]:
        sheet.append(row)
    for title in sheets:
        book.create_sheet(title)
    path = folder / "balises.xlsx"
    book.save(path)
    return path


def test_groups_lie_at_their_kilometres(tmp_path: Path) -> None:
    """A track of a kilometre line is an edge, from 1 m before its first to 1 m after its last group."""
    line, notes = read_balise_table(table(tmp_path, ROWS))
    assert [("Ut-As spoor 1", 202_000, "spoor 1"), ("As-Ut spoor 1", 2_000, "spoor 1")] == [
        (edge.id, edge.length_mm, edge.track) for edge in line.edges
    ]
    assert [
        ("426-139", 426, 139, 201_000, "increasing"),
        ("426-140", 426, 140, 1_000, "decreasing"),
        ("426-141", 426, 141, 1_000, "decreasing"),
    ] == [(one.id, one.country, one.identity, one.position_mm, one.orientation) for one in line.balise_groups]
    assert ("Ut-As", 1_200_000) == kilometre_mm(line.edges[0], 201_000)
    assert {"border"} == {node.kind for node in line.nodes}
    assert ["Km", "Or Lint", "Spoornr", "NID_BG"] == [note.place.split("'")[1] for note in notes]
    assert {"assumed"} == {note.kind for note in notes}


def test_the_real_table() -> None:
    """488 groups on 174 tracks of 8 kilometre lines, each at its kilometre."""
    line, notes = read_balise_table(data_file("balises/Baliselocations-V2.xlsx"))
    assert (488, 174, 4) == (len(line.balise_groups), len(line.edges), len(notes))
    assert 8 == len({edge.kilometres[0].line for edge in line.edges})
    edges = {edge.id: edge for edge in line.edges}
    places = {one.identity: kilometre_mm(edges[one.edge], one.position_mm) for one in line.balise_groups}
    assert (("Vspa-Dvaz", 201_555_000), ("Ut-Rtd", 87_000)) == (places[139], places[984])


def test_orientations_of_the_real_table_are_plausible() -> None:
    """Where a track has groups of both orientations, those before a place a train heads for lie on its side of it."""
    line = read_balise_table(data_file("balises/Baliselocations-V2.xlsx")).line
    ahead = behind = 0
    for edge in line.edges:
        own = [one for one in line.balise_groups if one.edge == edge.id]
        up = [one.position_mm for one in own if one.orientation == "increasing"]
        down = [one.position_mm for one in own if one.orientation == "decreasing"]
        if up and down:
            further = sum(up) / len(up) > sum(down) / len(down)
            ahead, behind = ahead + further, behind + (not further)
    assert (106, 7) == (ahead, behind)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (["426", 142, "A", 1, "Utrecht", "Z", "1"], "column 'NID_C': expected a number, got '426'."),
        ([426, 142.5, "A", 1, "Utrecht", "Z", "1"], "column 'NID_BG': expected a whole number, got 142.5."),
        ([426, 142, None, 1, "Utrecht", "Z", "1"], "column 'Lint': expected text, got None."),
        ([426, 142, "A", None, "Utrecht", "Z", "1"], "column 'Km': expected a number, got None."),
        ([426, 142, "A", 0.00012, "Utrecht", "Z", "1"], "column 'Km': 0.00012 m is no whole number of mm."),
        ([426, 142, "A", 1, "Rotterdam", "Z", "1"], "'Or Lint' 'Z' with 'Or BG' 'Rotterdam' is not known"),
        ([426, 142, "A", 1, "Utrecht", "Z", "  "], "column 'Spoornr': expected text, got '  '."),
        ([426, 99_999, "A", 1, "Utrecht", "Z", "1"], "field identity: Input should be less than or equal to 16383"),
        ([426, 139, "A", 1, "Utrecht", "Z", "1"], "NID_C 426, NID_BG 139 is that of sheet 'groups' row 2 as well."),
    ],
)
def test_cells_that_do_not_fit_are_refused(tmp_path: Path, row: list[Cell], message: str) -> None:
    """With sheet and row."""
    path = table(tmp_path, [*ROWS, row])
    with pytest.raises(InputError, match=f"^{re.escape(f'{path}: sheet')} 'groups' row 5: {re.escape(message)}"):
        read_balise_table(path)


def test_kilometres_may_have_decimals(tmp_path: Path) -> None:
    """As the sheet shows them, to the mm."""
    line = read_balise_table(table(tmp_path, [[1, 2, "A", 0.1, "Utrecht", "Z", "t"]])).line
    assert ("A", 100) == kilometre_mm(line.edges[0], line.balise_groups[0].position_mm)


def test_empty_rows_are_no_groups(tmp_path: Path) -> None:
    """Between groups and after them."""
    nothing: list[Cell] = [None] * 7
    line = read_balise_table(table(tmp_path, [ROWS[0], nothing, ROWS[1], nothing])).line
    assert 2 == len(line.balise_groups)


def test_columns(tmp_path: Path) -> None:
    """A missing column is refused, one more is noted, and so is a second sheet."""
    with pytest.raises(InputError, match="sheet 'groups': needs one column 'Spoornr'; it has 'NID_C', 'NID_BG'"):
        read_balise_table(table(tmp_path, ROWS, COLUMNS[:-1]))
    wide: list[list[Cell]] = [[*row, "x"] for row in ROWS]
    notes = read_balise_table(table(tmp_path, wide, (*COLUMNS, "Remark"), "more")).notes
    assert Note("not understood", "sheet 'groups'", "column 'Remark'") in notes
    assert Note("not carried over", "sheet 'more'", "only the first sheet is read") in notes


def test_what_is_no_table_is_refused(tmp_path: Path) -> None:
    """Another file, an empty sheet, no file."""
    text = tmp_path / "text.xlsx"
    text.write_text("no workbook", encoding="utf-8")
    with pytest.raises(InputError, match=f"^{re.escape(str(text))}: not an XLSX file"):
        read_balise_table(text)
    with pytest.raises(InputError, match="sheet 'groups': has no rows"):
        read_balise_table(table(tmp_path, []))
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_balise_table(tmp_path / "none.xlsx")


def test_without_openpyxl_the_remedy_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Spreadsheets need the extra."""
    path = table(tmp_path, ROWS)
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(EngineError, match=r"^reading XLSX needs openpyxl; install safeloc\[geo\]\.$"):
        read_balise_table(path)


@pytest.mark.parametrize("part", ["xl/worksheets/sheet1.xml", "xl/workbook.xml"])
def test_entities_in_a_workbook_are_refused(tmp_path: Path, part: str) -> None:
    """A spreadsheet is XML in a ZIP file; a document type in it is no more welcome than in railML."""
    whole, attacked = table(tmp_path, ROWS), tmp_path / "attacked.xlsx"
    with zipfile.ZipFile(whole) as source, zipfile.ZipFile(attacked, "w") as target:
        for name in source.namelist():
            data = source.read(name)
            if name == part:
                text = data.decode("utf-8").removeprefix('<?xml version="1.0"?>')
                data = f'<!DOCTYPE x [<!ENTITY e "{"ha" * 1000}">]>{text}'.encode()
            target.writestr(name, data)
    with pytest.raises(InputError, match=f"^{re.escape(str(attacked))}: "):
        read_balise_table(attacked)


def test_a_workbook_broken_inside_is_refused(tmp_path: Path) -> None:
    """The sheet's XML ends in the middle of a row, and a part is missing."""
    whole, broken = table(tmp_path, ROWS), tmp_path / "broken.xlsx"
    for lost in ("cut", "gone"):
        with zipfile.ZipFile(whole) as source, zipfile.ZipFile(broken, "w") as target:
            for name in source.namelist():
                data = source.read(name)
                if name != "xl/worksheets/sheet1.xml":
                    target.writestr(name, data)
                elif lost == "cut":
                    target.writestr(name, data[: len(data) // 2])
        with pytest.raises(InputError, match=f"^{re.escape(str(broken))}: not a readable XLSX file"):
            read_balise_table(broken)
