"""Recorded paths: the route they run over, its direction, and paths that no vehicle can run."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from safeloc.errors import InputError
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.geojson_path import read_path, route_over
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.topology import Run, Topology
from tests.railway.map.imports.test_geojson import SWITCH, written
from tests.railway.map.recorded_trains import route_of


@pytest.fixture
def topology(tmp_path: Path) -> Topology:
    """The small network with one switch."""
    return Topology(read_geojson(written(tmp_path, SWITCH)).line)


def path_file(folder: Path, *elements: str, **properties: Any) -> Path:
    """A path over these elements."""
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "LineString", "coordinates": [[0, 0], [1, 1]]},
            "properties": {"netelement_id": element, "start_intrinsic": 0.0, "end_intrinsic": 1.0, **properties},
        }
        for element in elements
    ]
    path = folder / "path.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features, "properties": {}}), encoding="utf-8")
    return path


def test_the_direction_follows_from_the_order(tmp_path: Path, topology: Topology) -> None:
    """From the south branch to the stem: along the one, against the other."""
    route, notes = read_path(path_file(tmp_path, "south", "stem"), topology)
    assert (Run("south", "increasing"), Run("stem", "decreasing")) == route.runs
    assert 2 * 1_113_195 == route.length_mm
    told = "shares run over and rows of the log; the route is over whole elements"
    assert (
        tuple(Note("not carried over", f"feature {n} {name!r}", told) for n, name in ((1, "south"), (2, "stem")))
        == notes
    )


def test_a_single_element_needs_its_direction(tmp_path: Path, topology: Topology) -> None:
    """Nothing in the file tells it."""
    path = path_file(tmp_path, "stem")
    with pytest.raises(InputError, match=r"the direction along 'stem' is unknown; give it as increasing"):
        read_path(path, topology)
    assert (Run("stem", "decreasing"),) == read_path(path, topology, first="decreasing").route.runs


def test_an_element_named_again_and_again_is_run_over_once(tmp_path: Path, topology: Topology) -> None:
    """As programs write it that name the element of every stretch of a log; the note says how often."""
    route, notes = read_path(path_file(tmp_path, "south", "south", "stem", "stem", "stem"), topology)
    assert (Run("south", "increasing"), Run("stem", "decreasing")) == route.runs
    assert [("element 'south'", 2), ("element 'stem'", 3)] == [
        (note.place, int(note.text.split()[1])) for note in notes if note.kind == "assumed"
    ]
    assert route.runs == route_over(["south", "south", "stem"], topology).runs


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        (["north", "south"], "no vehicle can run over 'north', 'south' in this order."),
        (["south", "stem", "north"], "no vehicle can run over 'south', 'stem', 'north' in this order."),
        (["stem", "west"], "feature 2 'west': the network has no element 'west'."),
        ([], "names no element."),
    ],
)
def test_paths_that_cannot_be_run_are_refused(
    tmp_path: Path, topology: Topology, elements: list[str], message: str
) -> None:
    """From branch to branch, and back out of a switch."""
    path = path_file(tmp_path, *elements)
    with pytest.raises(InputError, match=f"^{re.escape(f'{path}: {message}')}$"):
        read_path(path, topology)


def test_a_route_over_unknown_elements_is_refused(topology: Topology) -> None:
    """By name."""
    with pytest.raises(InputError, match=r"^the network has no element 'west'\.$"):
        route_over(["stem", "west"], topology)


def test_what_is_not_carried_over_is_noted(tmp_path: Path, topology: Topology) -> None:
    """A path that is not certain, and properties of nobody's knowledge."""
    notes = read_path(path_file(tmp_path, "south", "stem", probability=0.5, colour="red"), topology).notes
    assert Note("not understood", "feature 1 'south'", "property 'colour'") in notes
    told = "probability 0.5; the element counts as run over"
    assert Note("not carried over", "feature 2 'stem'", told) in notes


@pytest.mark.parametrize(
    ("log", "runs"),
    [
        ("28876", ["3842-", "5900-", "11648-", "127-", "9748-"]),
        ("31176", ["24043-", "11886-", "11885-", "7137+"]),
        ("29083", ["5916+", "2026+", "42+", "111+", "155+"]),
    ],
)
def test_the_paths_that_the_trains_took(log: str, runs: list[str]) -> None:
    """Each as a legal route over the network, with the direction along every element."""
    signs = {"increasing": "+", "decreasing": "-"}
    assert runs == [run.edge.removeprefix("88_L_") + signs[run.direction] for run in route_of(log).runs]
