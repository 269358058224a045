"""Routes: legal ways between places, positions along them, and what is met in order."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.railway.map.elements import AxleCounter, Node, Signal, Switch, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import Route, routes_between, through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Run, Topology
from tests.railway.map.made import fork, group, reflector, stop, straight

FIG3 = Topology(find_line("fig3"))


def forth(*edges: str) -> tuple[Run, ...]:
    """Runs along edges."""
    return tuple(Run(edge, "increasing") for edge in edges)


def back(*edges: str) -> tuple[Run, ...]:
    """Runs against edges."""
    return tuple(Run(edge, "decreasing") for edge in edges)


def equipped(travel: str = "both") -> Line:
    """Two edges of 1 m with one of everything that is met on the way."""
    return straight(
        1_000,
        1_000,
        travel=travel,
        balise_groups=(group(1, "e0", 100, 103),),
        reflectors=(reflector("r", "e1", 200), reflector("q", "e0", 50, direction="decreasing")),
        stop_points=(stop("p", "e1", 192, "r"),),
        signals=(Signal(id="s", edge="e0", position_mm=900, direction="increasing"),),
        axle_counters=(AxleCounter(id="a", edge="e1", position_mm=0),),
    )


def met(line: Line, runs: tuple[Run, ...], start: int, end: int) -> list[tuple[int, str]]:
    """Position and identity of everything met."""
    return [(one.position_mm, one.element.id) for one in Route(Topology(line), runs, start, end).objects()]


def test_objects_are_met_in_order() -> None:
    """Along the edges, what concerns that direction."""
    expected = [(100, "g1"), (900, "s"), (1_000, "a"), (1_192, "p"), (1_200, "r")]
    assert expected == met(equipped(), forth("e0", "e1"), 0, 1_000)


def test_backwards_objects_are_met_in_reverse() -> None:
    """Against the edges, balises and counters from the other side, and the reflector that faces that way."""
    assert [(1_000, "a"), (1_900, "g1"), (1_950, "q")] == met(equipped(), back("e1", "e0"), 0, 1_000)


def test_positions_count_from_the_start() -> None:
    """A route that begins within an edge meets what lies behind its start no more, nor what lies beyond its end."""
    assert [(300, "s"), (400, "a")] == met(equipped(), forth("e0", "e1"), 600, 150)


def test_the_direction_of_a_group_is_seen() -> None:
    """A group is passed in its nominal direction or against it; a single balise does not tell."""
    topology = Topology(equipped())
    there = next(Route(topology, forth("e0"), 0, 1_000).objects())
    again = [one for one in Route(topology, back("e0"), 0, 1_000).objects() if one.element.id == "g1"]
    assert (True, False) == (there.nominal, again[0].nominal)
    alone = Topology(straight(1_000, balise_groups=(group(1, "e0", 100),)))
    assert next(Route(alone, forth("e0"), 0, 1_000).objects()).nominal is None


def test_the_five_routes_of_figure_3() -> None:
    """Exactly the five routes of the source, with its sequences of models (RFL-D6)."""
    routes = {route.models(): route.name for route in through_routes(FIG3, 100)}
    assert routes == {
        "ADAB": "301 > 302-304 > 304-306 > 309",
        "ACD": "301 > 302-303 > 303-305 > 305-307 > 310",
        "ADCD": "301 > 302-304 > 304-305 > 305-307 > 310",
        "ADAD": "301 > 302-304 > 304-306 > 306-307 > 310",
        "DCD": "308 > 303-305 > 305-307 > 310",
    }


def test_switches_of_the_third_route() -> None:
    """The third route goes straight over 302, turns off at 304, and trails 305 and 307."""
    route = next(route for route in through_routes(FIG3, 100) if route.models() == "ADCD")
    seen = [(one.position_mm, one.passage.switch.id, one.passage.facing, one.passage.side) for one in route.switches()]
    assert seen == [
        (300_000, "302", True, "left"),
        (500_000, "304", True, "right"),
        (550_000, "305", False, "right"),
        (850_000, "307", False, "left"),
    ]


def test_all_routes_between_two_places() -> None:
    """From before 302 to behind 307 there are three ways, from balise 319 one."""
    goal = Place("310", 10_000)
    assert 3 == len(routes_between(FIG3, Place("301", 100_000), goal))
    (only,) = routes_between(FIG3, Place("308", 150_000), goal)
    assert (200_000 + 200_000 + 300_000 + 10_000, "DC") == (only.length_mm, only.models())


def test_routes_on_one_edge() -> None:
    """Forwards, backwards, and none against regular travel."""
    topology = Topology(straight(1_000, travel="both"))
    (there,) = routes_between(topology, Place("e0", 100), Place("e0", 400))
    (again,) = routes_between(topology, Place("e0", 400), Place("e0", 100))
    assert (forth("e0"), 300) == (there.runs, there.length_mm)
    assert (back("e0"), 300) == (again.runs, again.length_mm)
    assert [] == routes_between(Topology(straight(1_000)), Place("e0", 400), Place("e0", 100))


def test_too_many_routes_are_refused() -> None:
    """A number of routes beyond the limit is an error, not a part of the answer."""
    with pytest.raises(InputError, match=r"^more than 2 routes lead from '301' to '310'; ask for a shorter way\.$"):
        routes_between(FIG3, Place("301", 0), Place("310", 0), most=2)


def test_places_off_the_map_are_refused() -> None:
    """Unknown edges and positions beyond an edge."""
    with pytest.raises(InputError, match=r"^fig3 has no edge 'x'\.$"):
        routes_between(FIG3, Place("x", 0), Place("310", 0))
    with pytest.raises(InputError, match=r"^-1 mm is not on edge '301' of 300000 mm\.$"):
        routes_between(FIG3, Place("301", -1), Place("310", 0))


def test_illegal_routes_are_refused() -> None:
    """Branch to branch, against travel, empty, or off its edges."""
    topology = Topology(fork(stem_mm=5, left_mm=5, right_mm=5))
    with pytest.raises(InputError, match="from edge 'left' no vehicle can go to edge 'right', increasing"):
        Route(topology, forth("left", "right"), 0, 5)
    with pytest.raises(InputError, match="edge 'left' cannot be travelled in direction decreasing"):
        Route(topology, back("left"), 0, 5)
    with pytest.raises(InputError, match="at least one edge"):
        Route(topology, (), 0, 5)
    with pytest.raises(InputError, match="from 4 mm to 2 mm does not lie on its edges"):
        Route(topology, forth("stem"), 4, 2)


@given(st.integers(0, 299_999), st.integers(0, 200_000), st.data())
def test_place_and_position_agree(start: int, end: int, data: st.DataObject) -> None:
    """The place at a position along a route lies at that position."""
    (first, *_) = routes_between(FIG3, Place("301", start), Place("310", end))
    position = data.draw(st.integers(0, first.length_mm))
    assert position in first.positions_of(first.place(position))


def test_ends_of_a_route() -> None:
    """Its first and last places are on it, and beyond them it has none."""
    (route,) = routes_between(FIG3, Place("308", 5), Place("310", 7))
    assert (Place("308", 5), Place("310", 7)) == (route.place(0), route.place(route.length_mm))
    assert [] == route.positions_of(Place("308", 4))
    with pytest.raises(InputError, match="is not on a route of"):
        route.place(route.length_mm + 1)


def test_a_turning_loop_is_passed_both_ways() -> None:
    """Through a loop the stem is met again from the other side."""
    nodes = tuple(Node(id=name) for name in ("a", "s", "far"))
    shape = (("stem", "a", "s"), ("up", "s", "far"), ("down", "far", "s"))
    edges = tuple(TrackEdge(id=name, from_node=one, to_node=two, length_mm=10) for name, one, two in shape)
    switch = Switch(id="s", node="s", stem="stem", left="up", right="down")
    topology = Topology(Line(name="loop", version="1", nodes=nodes, edges=edges, switches=(switch,)))
    routes = routes_between(topology, Place("stem", 4), Place("stem", 2))
    through = [route for route in routes if len(route.runs) == 4]
    assert [34, 34] == [route.length_mm for route in through]
    assert [[0, 32], [0, 32]] == [route.positions_of(Place("stem", 4)) for route in through]
