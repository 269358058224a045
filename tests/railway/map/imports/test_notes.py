"""Notes told together, lengths and numbers as files write them, and the choice of an importer."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.railway.map.imports.formats import FORMATS, importer
from safeloc.railway.map.imports.lengths import decimal, millimetres
from safeloc.railway.map.imports.notes import Note, similar


def test_similar_notes_are_told_once() -> None:
    """By kind and text, with the first three places."""
    notes = [Note("assumed", f"row {number}", "linked") for number in range(5)]
    notes.insert(1, Note("rounded", "row x", "length"))
    assert [
        "assumed: linked [row 0, row 1, row 2 and 2 more]",
        "rounded: length [row x]",
    ] == [str(told) for told in similar(notes)]
    assert "row 0: assumed: linked" == str(notes[0])


@pytest.mark.parametrize(
    ("metres", "found"),
    [
        ("0.1", (100, True)),
        ("29556.1", (29_556_100, True)),
        ("0.0005", (0, False)),
        ("0.0015", (2, False)),
        ("-1.2", (-1_200, True)),
        ("1e3", (1_000_000, True)),
    ],
)
def test_metres_become_whole_millimetres(metres: str, found: tuple[int, bool]) -> None:
    """Exactly, or to the nearest with a remark."""
    assert found == millimetres(decimal(metres, "here"))


@pytest.mark.parametrize("text", ["", "x", "1,5", "NaN", "Infinity", None, True, 1.5, [1]])
def test_what_is_no_number_is_refused(text: object) -> None:
    """Binary fractions as well: they are not what a file says."""
    with pytest.raises(InputError, match=r"^here: expected a (finite )?number, got"):
        decimal(text, "here")


def test_numbers_are_taken_as_written() -> None:
    """Text, whole numbers, decimals."""
    assert [Decimal("1.50"), Decimal(2), Decimal("0.1")] == [
        decimal(" 1.50 ", "here"), decimal(2, "here"), decimal(Decimal("0.1"), "here")
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("file", "form"),
    [("a.railml", "railml"), ("a.XML", "railml"), ("a.geojson", "geojson"), ("a.xlsx", "balises")],
)
def test_the_suffix_tells_the_format(file: str, form: str) -> None:
    """Unless one is named."""
    assert FORMATS[form] is importer(Path(file))
    assert FORMATS["ttobench"] is importer(Path(file), "ttobench")


def test_unknown_formats_are_refused() -> None:
    """A suffix that says nothing, and a name that is none."""
    known = "railml, geojson, balises, ttobench"
    with pytest.raises(InputError, match=rf"^a\.json: its suffix is no known format; name one of {known}\.$"):
        importer(Path("a.json"))
    with pytest.raises(InputError, match=rf"^'ifc' is no format of lines; there are {known}\.$"):
        importer(Path("a.json"), "ifc")
