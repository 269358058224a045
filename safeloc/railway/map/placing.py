"""Adds balise groups to a line, at distances along a route that the user gives."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.railway.map.elements import Balise, BaliseGroup, Direction
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Route


def with_balise_groups(
    route: Route, positions_mm: Sequence[int], *, first_identity: int = 1, accuracy_mm: int | None = None
) -> Line:
    """Return the route's line with a group of one balise at each distance, numbered from `first_identity` on.

    accuracy_mm  Q_LOCACC of the new groups; None: the national value applies
    The nominal direction is that of the route. Raises InputError for a distance beyond the route, ValidationError for
    an identity that the line already has.
    """
    groups = []
    for identity, position in enumerate(positions_mm, first_identity):
        place = route.place(position)
        groups.append(
            BaliseGroup(
                id=f"placed {identity}",
                edge=place.edge,
                identity=identity,
                balises=(Balise(position_mm=place.position_mm),),
                nominal_direction=_direction(route, place.edge),
                location_accuracy_mm=accuracy_mm,
            )
        )
    line = route.topology.line
    content = {name: getattr(line, name) for name in Line.model_fields}
    return Line(**{**content, "checksum": None, "balise_groups": (*line.balise_groups, *groups)})


def _direction(route: Route, edge: str) -> Direction:
    return next(run.direction for run in route.runs if run.edge == edge)
