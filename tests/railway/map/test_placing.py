"""Balise groups placed along a route."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.railway.map.elements import Node, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.placing import with_balise_groups
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Run, Topology

LINE = Line(
    name="two",
    version="1",
    nodes=(Node(id="a"), Node(id="b"), Node(id="c")),
    edges=(
        TrackEdge(id="ab", from_node="a", to_node="b", length_mm=1_000),
        TrackEdge(id="cb", from_node="c", to_node="b", length_mm=2_000),
    ),
)
ROUTE = Route(Topology(LINE), (Run("ab", "increasing"), Run("cb", "decreasing")), 0, 2_000)


def test_groups_lie_where_the_route_is() -> None:
    """Distances along the route become places of edges, against the edge as well; the route gives the direction."""
    line = with_balise_groups(ROUTE, [400, 1_500], first_identity=7, accuracy_mm=1_000)
    assert [
        ("placed 7", "ab", 7, 400, "increasing", 1_000),
        ("placed 8", "cb", 8, 1_500, "decreasing", 1_000),
    ] == [
        (one.id, one.edge, one.identity, one.position_mm, one.orientation, one.location_accuracy_mm)
        for one in line.balise_groups
    ]


def test_more_groups_need_other_identities() -> None:
    """The line refuses a second group of the same identity."""
    first = with_balise_groups(ROUTE, [400])
    again = Route(Topology(first), ROUTE.runs, 0, 2_000)
    assert 2 == len(with_balise_groups(again, [500], first_identity=2).balise_groups)
    with pytest.raises(ValidationError, match="2 elements are called 'placed 1'"):
        with_balise_groups(again, [500])


def test_a_place_beyond_the_route_is_refused() -> None:
    """Nothing is placed elsewhere instead."""
    with pytest.raises(InputError, match="3001 mm is not on a route of 3000 mm"):
        with_balise_groups(ROUTE, [3_001])
