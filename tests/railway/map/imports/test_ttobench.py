"""TTOBench tracks: exact positions, stretches up to the next row, and rows that do not fit."""

from __future__ import annotations

import copy
import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safeloc.errors import InputError
from safeloc.railway.map.elements import Curve, Gradient, SpeedLimit, Stretch, Tunnel
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.ttobench import EDGE, read_ttobench
from tests.data_sources import data_file

TRACK: dict[str, Any] = {
    "metadata": {"id": "Here_There", "created by": "nobody"},
    "altitude": {"unit": "m", "value": 12.0},
    "stops": {"unit": "m", "values": [0.0, 400.5, 1000.1]},
    "speed limits": {"units": {"position": "m", "velocity": "km/h"}, "values": [[0.0, 95], [600.3, 110]]},
    "gradients": {"units": {"position": "m", "slope": "permil"}, "values": [[0.0, -2.4]]},
    "curvatures": {
        "units": {"position": "m", "radius at start": "m", "radius at end": "m"},
        "values": [[0.0, "infinity", -502.5], [100.0, 340.1, 340.1]],
    },
    "tunnels": {"units": {"position": "m", "length": "m", "cross section": "m^2"}, "values": [[700.0, 50.1, 40.0]]},
    "ETCS braking data": {"M_NVAVADH": {"unit": "-", "value": 0}, "Kt_int": {"unit": "-", "value": 1.15}},
}


def written(folder: Path, data: object) -> Path:
    """The data as a file."""
    path = folder / "track.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


def piece(start: int, end: int) -> dict[str, Any]:
    """A stretch of the one edge."""
    return {"edge": EDGE, "from_mm": start, "to_mm": end}


def test_a_track(tmp_path: Path) -> None:
    """Every table becomes stretches up to the next row; speeds are rounded down, everything else is exact."""
    line = read_ttobench(written(tmp_path, TRACK)).line
    assert ("Here_There", "1", "track.json; created by: nobody") == (line.name, line.version, line.source)
    assert [1_000_100] == [edge.length_mm for edge in line.edges]
    assert (
        SpeedLimit(**piece(0, 600_300), max_speed_mm_s=26_388),
        SpeedLimit(**piece(600_300, 1_000_100), max_speed_mm_s=30_555),
    ) == line.speed_limits
    assert (Gradient(**piece(0, 1_000_100), rise_ppm=-2_400),) == line.gradients
    assert (
        Curve(**piece(0, 100_000), from_radius_mm=None, to_radius_mm=-502_500),
        Curve(**piece(100_000, 1_000_100), from_radius_mm=340_100, to_radius_mm=340_100),
    ) == line.curves
    assert (Tunnel(id="tunnel 1", stretches=(Stretch(**piece(700_000, 750_100)),)),) == line.tunnels


def test_what_is_not_carried_over_is_noted(tmp_path: Path) -> None:
    """Stops, altitude, cross sections and braking data; an unknown member is not understood."""
    notes = read_ttobench(written(tmp_path, {**TRACK, "weather": "fine"})).notes
    stop = "a stop point needs a reflector; the file knows none"
    assert (
        Note("not carried over", "'tunnels' row 1", "cross section 40.0 m2"),
        Note("not carried over", "'stops' row 1 at 0.0 m", stop),
        Note("not carried over", "'stops' row 2 at 400.5 m", stop),
        Note("not carried over", "'stops' row 3 at 1000.1 m", stop),
        Note("not carried over", "'altitude'", "the map has no place for it"),
        Note("not carried over", "'ETCS braking data'", "the map has no place for it"),
        Note("not understood", "'weather'", "unknown member"),
    ) == notes


def test_what_is_rounded_is_noted(tmp_path: Path) -> None:
    """Positions finer than a mm, slopes finer than a ppm."""
    data = copy.deepcopy(TRACK)
    data["speed limits"]["values"][1][0] = 600.3004
    data["gradients"]["values"][0][1] = -2.40004
    rounded = [str(note) for note in read_ttobench(written(tmp_path, data)).notes if note.kind == "rounded"]
    assert [
        "'speed limits' row 2: rounded: 600.3004 m to 600300 mm",
        "'gradients' row 1: rounded: slope -2.40004 per mille to -2400 ppm",
    ] == rounded


def _at(*path: Any, value: object) -> Callable[[dict[str, Any]], object]:
    def change(data: dict[str, Any]) -> None:
        inner: Any = data
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: data.pop("stops"), "file: 'stops' is missing."),
        (lambda data: data.pop("metadata"), "file: 'metadata' is missing."),
        (_at("metadata", "id", value=""), "'metadata': id: expected text, got ''."),
        (_at("stops", "unit", value="km"), "'stops': unit is 'km'; known is 'm'."),
        (_at("stops", "values", value=[0.0]), "'stops': stops begin at 0 and grow; the last one ends the track."),
        (_at("stops", "values", 0, value=1.0), "'stops': stops begin at 0 and grow; the last one ends the track."),
        (_at("stops", "values", 1, value=2000), "'stops': stops begin at 0 and grow; the last one ends the track."),
        (_at("stops", "values", 2, value="x"), "'stops' row 3: expected a number, got 'x'."),
        (_at("stops", "values", 2, value=1000.12345), "'stops': the length 1000.12345 m is no whole number of mm."),
        (_at("gradients", "units", "slope", value="percent"), "'gradients': units are"),
        (_at("gradients", "values", 0, value=[0.0]), "'gradients' row 1: expected position, slope, got 1 values."),
        (_at("gradients", "values", 0, 0, value=5), "'gradients' row 1: the first position must be 0, not 5."),
        (_at("gradients", "values", 0, 1, value=None), "'gradients' row 1: slope: expected a number, got None."),
        (_at("speed limits", "values", 1, 0, value=0.0), "'speed limits' row 1: positions must grow"),
        (_at("speed limits", "values", 1, 0, value=1000.1), "'speed limits' row 2: positions must grow"),
        (_at("speed limits", "values", 1, 0, value=2000), "'speed limits' row 2: 2000 m lies outside the track"),
        (_at("speed limits", "values", 1, 0, value=-1), "'speed limits' row 2: -1 m lies outside the track"),
        (_at("speed limits", "values", 1, 1, value=0), "'speed limits' row 2: field max_speed_mm_s"),
        (_at("curvatures", "values", 0, 2, value=0.0), "'curvatures' row 1: a radius cannot be 0.0 m."),
        (_at("tunnels", "values", 0, 1, value=500.0), "'tunnels' row 1: 1200.0 m lies outside the track"),
        (_at("tunnels", "values", 0, 1, value=0.0), "'tunnels' row 1: a tunnel of 0.0 m has no length."),
    ],
)
def test_wrong_input_is_refused(tmp_path: Path, change: Callable[[dict[str, Any]], object], message: str) -> None:
    """With file, table and row."""
    data = copy.deepcopy(TRACK)
    change(data)
    path = written(tmp_path, data)
    with pytest.raises(InputError, match=re.escape(f"{path}: {message}")):
        read_ttobench(path)


def test_the_published_tracks() -> None:
    """All of the library's table: identity, length, stops, speeds, slopes."""
    table = data_file("lines_ttobench/tracks/tracks.csv")
    with table.open(encoding="utf-8") as file:
        listed = list(csv.DictReader(file))
    assert 15 == len(listed)
    for row in listed:
        line, notes = read_ttobench(table.with_name(f"{row['ID']}.json"))
        assert row["ID"] == line.name
        assert round(float(row["Length [m]"]) * 1000) == line.edges[0].length_mm
        assert int(row["Num stops [-]"]) == sum("'stops'" in note.place for note in notes)
        assert int(row["Max speed limit [km/h]"]) * 1_000_000 // 3_600 == max(
            limit.max_speed_mm_s for limit in line.speed_limits
        )
        assert round(float(row["Max gradient [permil]"]) * 1000) == max(one.rise_ppm for one in line.gradients)
        assert set() == {note.kind for note in notes} - {"not carried over"}


def test_the_published_tunnels() -> None:
    """The reference track with tunnels: 1050 m and 5050 m long."""
    line = read_ttobench(data_file("lines_ttobench/tracks/00_reference_with_tunnels.json")).line
    assert [1_050_000, 5_050_000] == [one.to_mm - one.from_mm for tunnel in line.tunnels for one in tunnel.stretches]
