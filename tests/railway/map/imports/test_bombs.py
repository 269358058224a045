"""Small files that stand for large ones: each importer reads what exists, within bounds, or refuses it with what to do.

Memory is measured by Python's own count of what it allocated, time by nothing: what is bounded is the work.
"""

from __future__ import annotations

import json
import re
import tracemalloc
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import openpyxl
import pytest

from safeloc import catalogue
from safeloc.errors import InputError
from safeloc.railway.map import toml_files
from safeloc.railway.map.imports import building, json_text, railml_xml, workbook_parts
from safeloc.railway.map.imports.balise_table import COLUMNS, read_balise_table
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.geojson_path import read_path
from safeloc.railway.map.imports.lengths import decimal
from safeloc.railway.map.imports.railml import read_railml
from safeloc.railway.map.imports.ttobench import read_ttobench
from safeloc.railway.map.toml_files import load_line
from safeloc.railway.map.topology import Topology
from safeloc.sensing.fibre import recordings
from safeloc.sensing.satellite import log_lines
from tests.railway.map.imports.documents import RAILML, STATION

SHEET = "xl/worksheets/sheet1.xml"
NAMESPACE = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
HEADING = "".join(f'<c r="{chr(65 + at)}1" t="inlineStr"><is><t>{name}</t></is></c>' for at, name in enumerate(COLUMNS))
GROUP = '<c><v>426</v></c><c><v>{0}</v></c>{1}<c><v>{0}</v></c>' + "".join(
    f'<c t="inlineStr"><is><t>{text}</t></is></c>' for text in ("Utrecht", "Z", "spoor 1")
)  # fmt: skip
LINT = '<c t="inlineStr"><is><t>Ut-As</t></is></c>'


def groups(count: int) -> str:
    """Rows of balise groups."""
    return "".join(f"<row>{GROUP.format(number, LINT)}</row>" for number in range(1, count + 1))


def workbook(folder: Path, rows: str, **others: str) -> Path:
    """A workbook whose sheet has these rows, and with these parts instead of its own."""
    sheet = f'<worksheet xmlns="{NAMESPACE}"><sheetData>{rows}</sheetData></worksheet>'
    parts = {SHEET: sheet, **{name.replace("__", "/") + ".xml": text for name, text in others.items()}}
    whole, path = folder / "whole.xlsx", folder / "bomb.xlsx"
    openpyxl.Workbook().save(whole)
    with zipfile.ZipFile(whole) as source, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for name in {*source.namelist(), *parts}:
            target.writestr(name, parts[name] if name in parts else source.read(name))
    return path


@contextmanager
def at_most(megabytes: float) -> Iterator[None]:
    """Python allocates no more than that meanwhile."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < megabytes * 1e6
    finally:
        tracemalloc.stop()


def refused(read: Callable[[Path], object], path: Path, *words: str) -> None:
    """The error begins with the file, and says these words."""
    with pytest.raises(InputError, match=f"^{re.escape(str(path))}") as error:
        read(path)
    assert all(word in str(error.value) for word in words), str(error.value)


# ------------------------------------------------------------------ workbooks


def test_a_cell_far_to_the_right_pads_no_row(tmp_path: Path) -> None:
    """2000 groups, and a cell in the last column of each row: what exists is read, in the memory that it needs."""
    far = '<c r="XFD{0}"><v>1</v></c>'
    rows = "".join(f"<row>{GROUP.format(number, LINT)}{far.format(number + 1)}</row>" for number in range(1, 2_001))
    path = workbook(tmp_path, f'<row r="1">{HEADING}</row>{rows}')
    with at_most(40):  # padded, it would be 2000 rows of 16 384 cells of 8 bytes: 262 MB
        assert 2_000 == len(read_balise_table(path).line.balise_groups)


def test_the_bomb_of_the_review_is_refused(tmp_path: Path) -> None:
    """A heading up to column XFD and 20 000 rows of one cell: a file of some kB that took gigabytes."""
    rows = "<row><c><v>1</v></c></row>" * 20_000
    path = workbook(tmp_path, f'<row r="1">{HEADING}<c r="XFD1"><v>1</v></c></row>{rows}')
    assert path.stat().st_size < 110_000
    with at_most(40):
        refused(read_balise_table, path, "row 1: more than 200 columns", "split it")


def test_rows_that_are_far_down_are_not_waited_for(tmp_path: Path) -> None:
    """A row number beyond any sheet's last one is no row."""
    path = workbook(tmp_path, f'<row r="1">{HEADING}</row>{groups(3)}<row r="99999999999"><c><v>1</v></c></row>')
    assert 3 == len(read_balise_table(path).line.balise_groups)


def test_too_many_rows_and_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Counted while the part is looked through, with its line."""
    path = workbook(tmp_path, f"{'<row/>' * 50_000}\n{'<row/>' * 50_001}")
    refused(read_balise_table, path, f"part {SHEET}:2: more than 100000 rows", "split it")
    monkeypatch.setattr(workbook_parts, "MOST_CELLS", 100)
    refused(read_balise_table, workbook(tmp_path, f"<row>{'<c/>' * 101}</row>"), "more than 100 cells")


def test_parts_that_unpack_without_end(tmp_path: Path) -> None:
    """A hundred kB that unpack to 100 MB."""
    path = workbook(tmp_path, "", xl__sharedStrings=" " * 100_000_001)
    assert path.stat().st_size < 200_000
    with at_most(20):
        refused(read_balise_table, path, "the workbook: more than 100000000 bytes in its parts")


def test_texts_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shared texts are counted like any element, over all parts."""
    monkeypatch.setattr(workbook_parts, "MOST_ELEMENTS", 10_000)
    texts = f'<sst xmlns="{NAMESPACE}">{"<si/>" * 10_001}</sst>'
    refused(read_balise_table, workbook(tmp_path, groups(1), xl__sharedStrings=texts), "more than 10000 elements")


def test_deep_workbooks_are_refused(tmp_path: Path) -> None:
    """With part and line."""
    path = workbook(tmp_path, "<a>" * 1_000 + "</a>" * 1_000)
    refused(read_balise_table, path, f"part {SHEET}:1: elements are nested deeper than 64")


@pytest.mark.parametrize("text", ["\u0661\u0662", "&#1633;", "\uff11", "1_000", "0x10", "one", "1e9999"])
def test_numbers_of_workbooks_have_ascii_digits(tmp_path: Path, text: str) -> None:
    """Libraries read digits of every script."""
    group = GROUP.replace("<v>{0}</v>", f"<v>{text}</v>", 1).format(1, LINT)
    path = workbook(tmp_path, f"<row>{HEADING}</row><row>{group}</row>")
    refused(read_balise_table, path, f"part {SHEET}:1: ", "is no number in ASCII digits")


# ------------------------------------------------------------------ railML


def test_elements_without_end(tmp_path: Path) -> None:
    """8 MB of elements of four bytes would be gigabytes of elements in memory."""
    path = tmp_path / "bomb.railml"
    path.write_text(f"{RAILML}{'<a/>' * 2_000_001}</railML>")
    with at_most(40):
        refused(read_railml, path, "more than 2000000 elements", "split it")


def test_attributes_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Likewise."""
    monkeypatch.setattr(railml_xml, "MOST_ATTRIBUTES", 1_000)
    path = tmp_path / "bomb.railml"
    attributes = " ".join(f"b{at}=''" for at in range(1_001))
    path.write_text(f"{RAILML}<a {attributes}/></railML>")
    refused(read_railml, path, "more than 1000 attributes")


@pytest.mark.parametrize("value", ["\u0661\u0660\u0660\u0660", "1_000", "\uff11\uff10", "1e999999999", "9" * 2_000])
def test_lengths_of_railml_are_numbers_in_ascii_digits(tmp_path: Path, value: str) -> None:
    """A number of a billion digits is none either: it would never end."""
    path = tmp_path / "station.railml"
    path.write_text(STATION.replace('length="1000.250"', f'length="{value}"'), encoding="utf-8")
    refused(read_railml, path, "netElement 'a' line", "expected a number")


# ------------------------------------------------------------------ JSON


@pytest.mark.parametrize("read", [read_geojson, read_ttobench])
def test_values_without_end(tmp_path: Path, read: Callable[[Path], object]) -> None:
    """Empty lists take three bytes in the file and seventy in memory."""
    path = tmp_path / "bomb.geojson"
    path.write_bytes(b'{"a":[' + b"[]," * 5_000_001 + b"[]]}")
    with at_most(40):
        refused(read, path, "more than 10000000 values", "split it")


@pytest.mark.parametrize("text", ["9" * 5_000, "1e999999999", "-1E+999999999"])
def test_numbers_without_end(tmp_path: Path, text: str) -> None:
    """Whole numbers of thousands of digits, and those that only become so large."""
    coordinates = f"[[{text}, 0], [1, 1]]"
    path = tmp_path / "bomb.geojson"
    path.write_text(
        '{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"id": "a"}, '
        f'"geometry": {{"type": "LineString", "coordinates": {coordinates}}}}}]}}'
    )
    refused(read_geojson, path)


def test_a_name_given_twice_is_found_in_one_look(tmp_path: Path) -> None:
    """Not in one look for each name: 100 000 of them took the square of that."""
    names = ", ".join(f'"n{number}": 0' for number in [*range(100_000), 99_999])
    path = tmp_path / "twice.json"
    path.write_text(f"{{{names}}}")
    refused(read_ttobench, path, "'n99999' is given twice in one object")


def test_numbers_of_maps_are_below_a_bound() -> None:
    """The largest number is the same for every format."""
    assert 999_999_999_999_999 == decimal("999999999999999", "here")
    with pytest.raises(InputError, match=r"^here: expected a number below 10\^15, got '1e15'\.$"):
        decimal("1e15", "here")


# ------------------------------------------------------------------ networks and paths


def network(folder: Path, tracks: int, ways: list[tuple[int, int, int, int]]) -> Path:
    """Tracks beside each other, and relations between ends of them."""
    lines = [
        {
            "type": "Feature",
            "properties": {"id": f"e{at}"},
            "geometry": {"type": "LineString", "coordinates": [[at * 1e-4, 0], [(at + 1) * 1e-4, 0]]},
        }
        for at in range(tracks)
    ]
    relations = [
        {
            "type": "Feature",
            "properties": {
                "id": f"r{number}", "type": "netrelation", "netelementA": f"e{one}", "netelementB": f"e{other}",
                "positionOnA": end, "positionOnB": other_end, "navigability": "both",
            },
            "geometry": {"type": "Point", "coordinates": [0, 0]},
        }
        for number, (one, end, other, other_end) in enumerate(ways)
    ]  # fmt: skip
    path = folder / "network.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [*lines, *relations]}), encoding="utf-8")
    return path


def test_ends_that_meet_at_one_place_are_bounded(tmp_path: Path) -> None:
    """Each pair of them may be a way: 10 000 ends would be fifty million pairs."""
    star = [(0, 1, other, 0) for other in range(1, 120)]
    refused(read_geojson, network(tmp_path, 120, star), "120 ends meet at one place, at most 100 can")


def test_a_path_has_any_length(tmp_path: Path) -> None:
    """One step an element, whatever their number; each was a call within the one before."""
    chain = network(tmp_path, 2_500, [(at, 1, at + 1, 0) for at in range(2_499)])
    topology = Topology(read_geojson(chain).line)
    path = tmp_path / "path.geojson"
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "LineString", "coordinates": []},
            "properties": {"netelement_id": f"e{at}"},
        }
        for at in range(2_500)
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}), encoding="utf-8")
    assert 2_500 == len(read_path(path, topology).route.runs)


# ------------------------------------------------------------------ lines of our own


def test_keys_of_many_parts_are_refused(tmp_path: Path) -> None:
    """Their time grows with the square of the parts."""
    path = tmp_path / "bomb.toml"
    path.write_text(f"name = 1\n{'a.' * 100_000}b = 1\n")
    refused(load_line, path, ":2: more than 2000 points in one line")


@pytest.mark.parametrize("name", ["bomb.toml", "bomb.json"])
def test_large_and_broken_lines_are_refused(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the file, and what to do."""
    path = tmp_path / name
    digits = "9" * 5_000
    path.write_text(f'{{"a": {digits}}}' if name.endswith("json") else f"a = {digits}")
    refused(load_line, path, "not JSON" if name.endswith("json") else "not TOML")
    monkeypatch.setattr("safeloc.railway.map.toml_files.LARGEST_TEXT", 100)
    refused(load_line, path, "more than 100 bytes", "split it")


def test_map_files_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also what never ends."""
    monkeypatch.setattr("safeloc.railway.map.imports.building.LARGEST_MAP", 100)
    for read in (read_railml, read_geojson, read_ttobench, read_balise_table):
        path = tmp_path / "large"
        path.write_bytes(b" " * 101)
        refused(read, path, "more than 100 bytes")
        refused(read, Path("/dev/zero"), "not a file")
        refused(read, tmp_path, "a folder, not a file")


def test_limits_are_those_of_the_docs() -> None:
    """docs/imports.md names them."""
    told = (Path(__file__).parents[4] / "docs" / "imports.md").read_text(encoding="utf-8")
    limits = (
        building.LARGEST_MAP, json_text.MOST_VALUES, railml_xml.MOST_ELEMENTS, railml_xml.MOST_ATTRIBUTES,
        workbook_parts.LARGEST_PART, workbook_parts.MOST_ELEMENTS, workbook_parts.MOST_ROWS, workbook_parts.MOST_CELLS,
        toml_files.LARGEST_TEXT, log_lines.LARGEST_LOG, log_lines.MOST_LINES, recordings.LARGEST_RECORDING,
        catalogue.LARGEST_CONFIG,
    )  # fmt: skip
    assert [] == [limit for limit in limits if f"{limit:,}".replace(",", " ") not in told]
