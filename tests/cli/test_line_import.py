"""`safeloc import`: a line that loads again, and notes on what did not come along."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.railway.map.toml_files import load_line
from tests.cli.calling import Call
from tests.railway.map.imports.documents import STATION


@pytest.fixture
def station(tmp_path: Path) -> Path:
    """A small railML document."""
    path = tmp_path / "station.railml"
    path.write_text(STATION, encoding="utf-8")
    return path


def test_the_line_loads_again(call: Call, station: Path, tmp_path: Path) -> None:
    """Sealed with its checksum, under the name and version that were asked for."""
    where = tmp_path / "station.toml"
    called = call("import", str(station), "--out", str(where), "--name", "Here", "--version", "7")
    assert 0 == called.code
    line = load_line(where)
    assert ("Here", "7", 3) == (line.name, line.version, len(line.edges))
    assert line.checksum is not None
    told = f"Here: edges 3, switches 1, balise groups 2, signals 1, axle counters 1; notes 10: {where}\n"
    assert told == called.err
    assert "assumed: track ends without a buffer stop or an open border [netElement 'c']\n" in called.out
    assert (
        "not carried over: attribute 'type' [border 'bo1' line 74, switchIS 'w1' line 105, track 'tr1' line"
        in called.out
    )


def test_every_note(call: Call, station: Path, tmp_path: Path) -> None:
    """One line each, or as JSON."""
    where = str(tmp_path / "x.toml")
    assert 10 == len(call("import", str(station), "--out", where, "--all-notes").out.splitlines())
    notes = json.loads(call("import", str(station), "--out", where, "--json").out)
    assert {"kind": "assumed", "place": "netElement 'c'"}.items() <= notes[0].items()
    assert 10 == len(notes)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.railml", "--out", "x.toml"], "none.railml: cannot be read: No such file"),
        (["none.json", "--out", "x.toml"], "none.json: its suffix is no known format; name one of railml, geojson"),
        (["none.json", "--out", "x.toml", "--format", "ifc"], "'ifc' is no format of lines"),
    ],
)
def test_wrong_usage(call: Call, arguments: list[str], message: str) -> None:
    """Told in one line, with exit code 2, and nothing is written."""
    called = call("import", *arguments)
    assert 2 == called.code
    assert message in called.err
    assert not Path("x.toml").exists()


def test_an_unwritable_place_is_told(call: Call, station: Path, tmp_path: Path) -> None:
    """With the place."""
    called = call("import", str(station), "--out", str(tmp_path / "no" / "x.toml"))
    assert 2 == called.code
    assert "x.toml: cannot be written" in called.err
