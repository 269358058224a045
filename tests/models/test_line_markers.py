"""Vehicles on lines with markers: what their readers are told of a route, and what the odometry machine makes of the runs."""

from __future__ import annotations

import pytest

from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.drive import Journey, streams
from safeloc.models.line_runs.ways import accuracies, markers
from safeloc.railway.audit import audit
from safeloc.railway.map.routes import through_routes
from safeloc.railway.map.topology import Topology
from safeloc.railway.map.walk import Walk
from tests.models.line_runs import kept_all_the_way, said
from tests.railway.map.made import group, marker, straight


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("travel", ["increasing", "decreasing"])
def test_markers_of_the_map_are_read_at_both_ends(travel: str) -> None:
    """As far apart as the audit permits: lawful, every marker read twice, and the position kept from the first one on; the odometer of
    the trailing end gives it where the leading one alone would have lost it.
    """
    layout = LayoutConfig(markers=MarkerReaders())
    placed = tuple(marker(number, "e0", 100_000 + 647_400 * (number - 1)) for number in (1, 2, 3))
    line = straight(1_750_000, travel=travel, markers=placed)
    assert () == audit(line, layout).violated
    (route,) = through_routes(Topology(line), 2)
    (stream,) = streams(Journey(route, Walk(line), LineVehicle(layout=layout, trust_first=True), 5), "odometry")
    told = said(stream)
    assert {"contained", "INVALID"} == set(told.standing)
    assert "INVALID" not in told.standing[told.standing.index("contained") :]
    assert {"FRONT", "REAR"} <= set(told.modes)
    read = [step["rear_marker"] for step in stream.steps if "rear_marker" in step]
    assert read == ([1, 2, 3] if travel == "increasing" else [3, 2])
    assert kept_all_the_way(stream)


def test_markers_and_groups_on_one_line_have_numbers_of_their_own() -> None:
    """A marker with a group's identity is numbered behind the groups; readers that do not read groups see markers alone."""
    line = straight(900_000, balise_groups=(group(1, "e0", 200_000, 203_000),), markers=(marker(1, "e0", 100_000),))
    (route,) = through_routes(Topology(line), 2)
    assert [(2, 100_000), (1, 200_000)] == markers(route, MarkerReaders())
    assert {2: 300, 1: 1_300} == accuracies(route, 12_000, 1_000, MarkerReaders())
    assert [(2, 100_000)] == markers(route, MarkerReaders(groups_are_markers=False))
    plain = line.model_copy(update={"markers": (marker(7, "e0", 100_000, None),)})
    (route,) = through_routes(Topology(plain), 2)
    assert [(7, 100_000), (1, 200_000)] == markers(route, MarkerReaders())
    assert 12_000 == accuracies(route, 12_000, 1_000, MarkerReaders())[7]
