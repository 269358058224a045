"""Kilometres of places, upwards and downwards, over jumps, and as people write them."""

from __future__ import annotations

from safeloc.railway.map.elements import KilometrePoint, TrackEdge
from safeloc.railway.map.places import along, kilometre_mm, kilometre_text


def edge(*points: KilometrePoint) -> TrackEdge:
    """Two kilometres of track with these kilometre points."""
    return TrackEdge(id="e", from_node="a", to_node="b", length_mm=2_000_000, kilometres=points)


UP = KilometrePoint(kilometre_mm=12_000_000, line="L36")
DOWN = KilometrePoint(position_mm=500_000, kilometre_mm=3_000, direction="decreasing")


def test_kilometres_count_from_the_last_point() -> None:
    """Before the jump upwards on one line, behind it downwards on another."""
    both = edge(UP, DOWN)
    assert ("L36", 12_499_999) == kilometre_mm(both, 499_999)
    assert ("", 3_000) == kilometre_mm(both, 500_000)
    assert ("", -2_000) == kilometre_mm(both, 505_000)


def test_an_edge_without_kilometres_has_none() -> None:
    """No figure is invented."""
    assert kilometre_mm(edge(), 5) is None
    assert "" == kilometre_text(edge(), 5)


def test_kilometres_are_written_to_the_millimetre() -> None:
    """Six digits behind the point, the sign before, the kilometre line in front where it has a name."""
    assert "L36 12.000005" == kilometre_text(edge(UP), 5)
    assert "-0.002000" == kilometre_text(edge(UP, DOWN), 505_000)


def test_distance_along_an_edge() -> None:
    """From where the vehicle comes onto it."""
    assert (300, 700) == (along("increasing", 1_000, 300), along("decreasing", 1_000, 300))
