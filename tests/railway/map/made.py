"""Small lines for tests: a straight track of edges e0, e1, ... between nodes n0, n1, ..., and a Y with one switch."""

from __future__ import annotations

from typing import Any

from safeloc.railway.map.elements import (
    Balise,
    BaliseGroup,
    Direction,
    Marker,
    Node,
    Reflector,
    StopPoint,
    Switch,
    TrackEdge,
)
from safeloc.railway.map.model import Line


def straight(*lengths_mm: int, travel: str = "increasing", **more: Any) -> Line:
    """Edges e0, e1, ... one behind the other."""
    nodes = tuple(Node(id=f"n{index}") for index in range(len(lengths_mm) + 1))
    edges = tuple(
        TrackEdge(id=f"e{index}", from_node=f"n{index}", to_node=f"n{index + 1}", length_mm=length, travel=travel)  # type: ignore[arg-type]
        for index, length in enumerate(lengths_mm)
    )
    return Line(name="straight", version="1", nodes=nodes, edges=edges, **more)


def fork(*, stem_mm: int, left_mm: int, right_mm: int, **more: Any) -> Line:
    """Edges stem, left and right at switch `s`, run from the stem."""
    nodes = tuple(Node(id=name) for name in ("west", "s", "north", "south"))
    shape = (("stem", "west", "s", stem_mm), ("left", "s", "north", left_mm), ("right", "s", "south", right_mm))
    edges = tuple(
        TrackEdge(id=name, from_node=start, to_node=end, length_mm=length, travel="increasing")
        for name, start, end, length in shape
    )
    switch = Switch(id="s", node="s", stem="stem", left="left", right="right")
    return Line(name="fork", version="1", nodes=nodes, edges=edges, switches=(switch,), **more)


def group(identity: int, edge: str, *places_mm: int, **more: Any) -> BaliseGroup:
    """A balise group with balises at these places, and a location accuracy of 300 mm."""
    balises = tuple(Balise(position_mm=place) for place in places_mm)
    figures = {"location_accuracy_mm": 300, **more}
    return BaliseGroup(id=f"g{identity}", edge=edge, identity=identity, balises=balises, **figures)


def marker(identity: int, edge: str, place_mm: int, accuracy_mm: int | None = 300) -> Marker:
    """A marker that lies within 300 mm of its place."""
    return Marker(id=f"m{identity}", edge=edge, position_mm=place_mm, identity=identity, accuracy_mm=accuracy_mm)


def reflector(name: str, edge: str, place_mm: int, model: str = "A", **more: Any) -> Reflector:
    """A reflector whose view zone lies from 100 m to 3 m before it."""
    figures: dict[str, Any] = {"view_from_mm": 100_000, "view_to_mm": 3_000, "direction": "increasing", **more}
    return Reflector(id=name, edge=edge, position_mm=place_mm, model=model, **figures)


def stop(name: str, edge: str, place_mm: int, of: str, **more: Any) -> StopPoint:
    """A stop point 8 m before its reflector, with a window of 450 mm to either side."""
    way: Direction = "increasing"
    figures = {"standstill_distance_mm": 8_000, "window_before_mm": 450, "window_after_mm": 450, **more}
    return StopPoint(id=name, edge=edge, position_mm=place_mm, direction=way, reflector=of, **figures)
