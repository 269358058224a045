"""Readings on the ways to a goal: those that are too far behind to keep a position are left out where only that is asked."""

from __future__ import annotations

import pytest

from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.railway.audit.marker_readings import Goal, Origin, Readings
from safeloc.railway.audit.rules import Rules
from safeloc.railway.map.model import Line
from safeloc.railway.map.walk import Walk
from tests.railway.map.made import fork, marker, straight

PLACES_MM = range(10_000, 1_500_000, 90_000)
LINES = {
    "straight": straight(1_500_000, markers=tuple(marker(n, "e0", at) for n, at in enumerate(PLACES_MM, 1))),
    "fork": fork(
        stem_mm=1_500_000,
        left_mm=400_000,
        right_mm=900_000,
        markers=(
            *(marker(n, "stem", at) for n, at in enumerate(PLACES_MM, 1)),
            marker(50, "left", 300_000),
            marker(51, "right", 800_000),
        ),
    ),
}


def near(readings: Readings, goal: Goal, enough_mm: int | None) -> list[frozenset[Origin]]:
    """What keeps the position on each way to a goal."""
    ways = readings.ways(goal, enough_mm)
    return [frozenset(one for one in way.origins if one.spare_mm >= 0) for way in ways]


@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
@pytest.mark.parametrize("tolerance_mm", [10_000, 30_000])
def test_what_is_left_out_keeps_no_position(line: Line, tolerance_mm: int) -> None:
    """Every way keeps all readings that have to spare; fewer of the others are told, and no way loses its last one."""
    readings = Readings(Walk(line), Rules(LayoutConfig(tolerance_mm=tolerance_mm, markers=MarkerReaders())))
    told, every = 0, 0
    for goal in readings.goals():
        assert near(readings, goal, 10**12) == near(readings, goal, None)
        short, long = list(readings.ways(goal, None)), list(readings.ways(goal, 10**12))
        assert [bool(way.origins) for way in long] == [bool(way.origins) for way in short]
        told, every = told + sum(len(way.origins) for way in short), every + sum(len(way.origins) for way in long)
    assert told < every
