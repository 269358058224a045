"""GeoJSON networks: lengths, nodes, switches with their sides, and everything that is not carried over."""

from __future__ import annotations

import copy
import json
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safeloc.errors import EngineError, InputError
from safeloc.railway.map.elements import Crossing, Switch
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.notes import Note
from tests.data_sources import data_file

Collection = dict[str, Any]


def track(identity: str, *points: tuple[float, ...]) -> dict[str, Any]:
    """A line of the network."""
    geometry = {"type": "LineString", "coordinates": points}
    return {"type": "Feature", "properties": {"id": identity}, "geometry": geometry}


def relation(one: str, end: int, other: str, other_end: int, navigability: str = "both") -> dict[str, Any]:
    """Two ends that meet."""
    properties = {
        "id": f"n1|{one}|{other}",
        "type": "netrelation",
        "netelementA": one,
        "positionOnA": end,
        "netelementB": other,
        "positionOnB": other_end,
        "navigability": navigability,
    }
    return {"type": "Feature", "properties": properties, "geometry": {"type": "Point", "coordinates": [0.01, 0.0]}}


SWITCH: Collection = {
    "type": "FeatureCollection",
    "features": [
        track("stem", (0.0, 0.0), (0.01, 0.0)),
        track("north", (0.01, 0.0), (0.0103, 0.00003), (0.02, 0.001)),
        track("south", (0.02, 0.0), (0.01, 0.0)),
        relation("stem", 1, "north", 0),
        relation("stem", 1, "south", 1),
        relation("north", 0, "south", 1, "none"),
    ],
}


def changed(change: Callable[[Collection], object]) -> Collection:
    """The switch with something changed."""
    found = copy.deepcopy(SWITCH)
    change(found)
    return found


def written(folder: Path, collection: object) -> Path:
    """The collection as a file."""
    path = folder / "network.geojson"
    path.write_text(json.dumps(collection), encoding="utf-8")
    return path


def test_a_switch(tmp_path: Path) -> None:
    """Who goes east has the north on the left; the node bears the name that the relations share."""
    line, notes = read_geojson(written(tmp_path, SWITCH))
    assert (Switch(id="n1", node="n1", stem="stem", left="north", right="south"),) == line.switches
    assert [1_113_195, 1_118_673, 1_113_195] == [edge.length_mm for edge in line.edges]
    assert [("stem begin", "n1"), ("n1", "north end"), ("south begin", "n1")] == [
        (edge.from_node, edge.to_node) for edge in line.edges
    ]
    node = next(node for node in line.nodes if node.id == "n1")
    assert (0.01, 0.0) == (node.longitude_deg, node.latitude_deg)
    assert ["beginning of 'stem'", "end of 'north'", "beginning of 'south'"] == [note.place for note in notes]
    assert {"assumed"} == {note.kind for note in notes}


def test_sides_do_not_depend_on_the_direction_of_the_stem(tmp_path: Path) -> None:
    """The same switch entered from the east: north is then on the right."""

    def mirror(found: Collection) -> None:
        for feature in found["features"][:3]:
            feature["geometry"]["coordinates"] = [(-x, y) for x, y in feature["geometry"]["coordinates"]]

    line = read_geojson(written(tmp_path, changed(mirror))).line
    assert (Switch(id="n1", node="n1", stem="stem", left="south", right="north"),) == line.switches


def test_a_diamond_is_a_crossing(tmp_path: Path) -> None:
    """Four ends and two ways that do not meet: one node, two movements."""
    collection = {
        "type": "FeatureCollection",
        "features": [
            track("w", (0.0, 0.0), (0.01, 0.0)),
            track("e", (0.01, 0.0), (0.02, 0.0)),
            track("s", (0.01, -0.01), (0.01, 0.0)),
            track("n", (0.01, 0.0), (0.01, 0.01)),
            relation("w", 1, "e", 0),
            relation("s", 1, "n", 0),
            relation("w", 1, "n", 0, "none"),
            relation("e", 0, "s", 1, "none"),
        ],
    }
    line = read_geojson(written(tmp_path, collection)).line
    assert (Crossing(id="n1", node="n1", movements=(("e", "w"), ("n", "s"))),) == line.crossings


def test_the_airport_network() -> None:
    """74 elements and 142 relations: 41 switches with known sides, 3 crossings, 13 ends, and one contradiction."""
    line, notes = read_geojson(data_file("trains/network_airport.geojson"))
    assert (74, 57, 41, 3) == (len(line.edges), len(line.nodes), len(line.switches), len(line.crossings))
    assert 56_008_054 == sum(edge.length_mm for edge in line.edges)
    contradiction = Note(
        "doubtful",
        "feature 166 '88_NL_5253|524|23772'",
        "is stated both as passable and as not passable; taken as not passable",
    )
    assert [contradiction] == [note for note in notes if note.kind != "assumed"]
    assert 13 == sum(note.kind == "assumed" for note in notes)


def _set(index: int, **properties: object) -> Callable[[Collection], object]:
    return lambda found: found["features"][index]["properties"].update(properties)


def _drop(index: int, name: str) -> Callable[[Collection], object]:
    return lambda found: found["features"][index]["properties"].pop(name)


def _coordinates(index: int, points: object) -> Callable[[Collection], object]:
    return lambda found: found["features"][index]["geometry"].update(coordinates=points)


@pytest.mark.parametrize(
    ("change", "note"),
    [
        (_set(0, gauge=1435), Note("not understood", "feature 1 'stem'", "property 'gauge'")),
        (_set(3, gauge=1435), Note("not understood", "feature 4 'n1|stem|north'", "property 'gauge'")),
        (
            _coordinates(0, [(0.0, 0.0, 12.0), (0.01, 0.0, 13.0)]),
            Note("not carried over", "feature 1 'stem'", "heights; lengths are those on the ellipsoid"),
        ),
        (
            _set(4, navigability="AB"),
            Note("not carried over", "feature 5 'n1|stem|south'", "one way only; the map allows both ways"),
        ),
        (
            _coordinates(2, [(0.02, 0.0), (0.0102, 0.0)]),
            Note("doubtful", "feature 5 'n1|stem|south'", "ends that meet lie 22.3 m apart; taken as meeting"),
        ),
        (
            _coordinates(2, [(0.02, 0.001), (0.0103, 0.00003), (0.01, 0.0)]),
            Note(
                "not carried over",
                "feature 4 'n1|stem|north'",
                "which branch is left is not known; the switch is a crossing",
            ),
        ),
        (
            lambda found: found["features"].append(
                {"type": "Feature", "properties": {"id": "x"}, "geometry": {"type": "Polygon", "coordinates": []}}
            ),
            Note("not understood", "feature 7 'x'", "Polygon of type None"),
        ),
        (lambda found: found.update(author="x"), Note("not understood", "collection", "member 'author'")),
        (
            _set(3, navigability="none"),
            Note(
                "not carried over", "feature 4 'n1|stem|north'", "ends that meet without a way between them; kept apart"
            ),
        ),
    ],
)
def test_what_is_not_carried_over_is_noted(tmp_path: Path, change: Callable[[Collection], object], note: Note) -> None:
    """Each with its feature."""
    assert note in read_geojson(written(tmp_path, changed(change))).notes


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda found: found.update(type="Feature"), "expected a FeatureCollection, got 'Feature'."),
        (lambda found: found.update(crs={}), "names a coordinate system; GeoJSON is longitude and latitude"),
        (lambda found: found.pop("features"), "collection: 'features' is missing."),
        (lambda found: found.update(features={}), "features: expected a list, got an object."),
        (lambda found: found.update(features=[]), "the file has no LineString: there is no track in it."),
        (lambda found: found["features"][0].update(type="Thing"), "feature 1 'stem': expected a Feature, got 'Thing'."),
        (_drop(0, "id"), "feature 1: 'id' is missing."),
        (_set(1, id="stem"), "feature 2 'stem': the identity is that of an earlier feature."),
        (_coordinates(0, [(0.0, 0.0)]), "feature 1 'stem': a track has at least two points."),
        (_coordinates(0, [(0.0, 0.0), (0.0, 0.0)]), "feature 1 'stem': a track has at least two points."),
        (_coordinates(0, [(0.0, 0.0), (0.0, 91.0)]), "feature 1 'stem': 0.0, 91.0 is no longitude and latitude"),
        (_coordinates(0, [(0.0, 0.0), ("x", 1.0)]), "feature 1 'stem': position: expected a number, got 'x'."),
        (_coordinates(0, [(0.0, 0.0), (1.0,)]), "feature 1 'stem': a position has a longitude and a latitude."),
        (_set(3, netelementB="west"), "feature 4 'n1|stem|north': netelementB: there is no element 'west'."),
        (_set(3, positionOnA=2), "feature 4 'n1|stem|north': positionOnA must be 0 or 1, not 2."),
        (_set(3, positionOnA=True), "feature 4 'n1|stem|north': positionOnA must be 0 or 1, not True."),
        (_set(3, navigability="maybe"), "feature 4 'n1|stem|north': navigability must be both, none, AB or BA"),
        (_drop(3, "navigability"), "feature 4 'n1|stem|north': 'navigability' is missing."),
        (_set(3, netelementB="stem", positionOnB=1), "joins one end of edge 'stem' to itself."),
        (_set(5, netelementB="stem", positionOnB=0, navigability="both"), "both ends of edge 'stem' meet at one node"),
    ],
)
def test_wrong_input_is_refused(tmp_path: Path, change: Callable[[Collection], object], message: str) -> None:
    """With file, feature and what to mend."""
    path = written(tmp_path, changed(change))
    with pytest.raises(InputError, match=f"^{re.escape(str(path))}: .*{re.escape(message)}"):
        read_geojson(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ":1: not JSON"),
        ("[]", ": expected an object, got a list."),
        ('{"type": 1, "type": 2}', ": 'type' is given twice in one object; keep one."),
        ('{"type": NaN}', ": NaN is no number of JSON."),
        ('{"a": ' * 100_000, ": nested too deeply to be a map."),
    ],
)
def test_what_is_no_json_object_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """With the line where there is one."""
    path = tmp_path / "network.geojson"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(f"{path}{message}")):
        read_geojson(path)


def test_without_pyproj_the_remedy_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Geodesic lengths need the extra."""
    monkeypatch.setitem(sys.modules, "pyproj", None)
    with pytest.raises(EngineError, match=r"^measuring GeoJSON tracks needs pyproj; install safeloc\[geo\]\.$"):
        read_geojson(written(tmp_path, SWITCH))


def test_name_and_version(tmp_path: Path) -> None:
    """By default the file's name and "1"."""
    path = written(tmp_path, SWITCH)
    assert ("network", "1") == (read_geojson(path).line.name, read_geojson(path).line.version)
    named = read_geojson(path, name="Here", version="7").line
    assert ("Here", "7") == (named.name, named.version)
