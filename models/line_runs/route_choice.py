"""Choice of the routes to drive on a line: those named, those between two places, or all from end to end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.railway.map.imports.geojson_path import route_over
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import Route, routes_between, through_routes
from safeloc.railway.map.topology import Topology

MOST_ROUTES = 100
_MOST_RIVALS = 16


@dataclass(frozen=True)
class Chosen:
    """A route to drive, and the routes among which the route machine has to recognise it; they include the route itself."""

    route: Route
    rivals: tuple[Route, ...]


def chosen_routes(topology: Topology, routes: Sequence[str], start: str | None, end: str | None) -> list[Chosen]:
    """Return the requested routes. InputError if there is none, or more than `MOST_ROUTES`."""
    if (start is None) != (end is None):
        raise InputError("--from and --to belong together: EDGE@MM each.")
    if start is not None and end is not None:
        if routes:
            raise InputError("give routes by --route, or by --from and --to, not by both.")
        found = routes_between(topology, _place(start, "--from"), _place(end, "--to"), MOST_ROUTES)
        every = found
    else:
        every = through_routes(topology, MOST_ROUTES + 1)
        found = [_over(topology, text) for text in routes] or every
    _check_number(found, topology, start, end)
    return [Chosen(one, _rivals(one, every)) for one in found]


def _over(topology: Topology, text: str) -> Route:
    """Return the route over these edges; its first direction may stand before them: `increasing: E1, E2`."""
    way, colon, edges = text.partition(":")
    first = way.strip()
    if not colon or first not in ("increasing", "decreasing"):
        return route_over([edge.strip() for edge in text.split(",")], topology)
    named = [edge.strip() for edge in edges.split(",")]
    return route_over(named, topology, first="increasing" if first == "increasing" else "decreasing")


def _place(text: str, option: str) -> Place:
    edge, _, position = text.rpartition("@")
    if not edge or not (position.isascii() and position.isdecimal()):
        raise InputError(f"{option} {text!r}: expected EDGE@MM, for instance 301@0.")
    return Place(edge, int(position))


def _check_number(found: Sequence[Route], topology: Topology, start: str | None, end: str | None) -> None:
    name = topology.line.name
    if not found and start is not None:
        raise InputError(f"{name}: no route leads from {start} to {end}.")
    if not found:
        raise InputError(f"{name}: no route leads onto the map and off it again; give --from and --to, or --route.")
    if len(found) > MOST_ROUTES:
        raise InputError(f"{name}: more than {MOST_ROUTES} routes lead over it; give --from and --to, or --route.")


def _rivals(route: Route, every: Sequence[Route]) -> tuple[Route, ...]:
    """Return the routes with the same first direction, or only those with the same first edge if there are too many."""
    same = [one for one in every if one.runs[0].direction == route.runs[0].direction]
    if len(same) > _MOST_RIVALS:
        same = [one for one in every if one.runs[0] == route.runs[0]]
    return tuple(same) if any(one.runs == route.runs for one in same) else (*same, route)
