"""What must hold of route recognition (RFL-D6): the true route is always among those carried, and no sequence decides alone.

Said of the route that the vehicle really runs on, of what is seen and what the map says of it, and of what the machine
reports and keeps, in figures of the requirement (`figures`).
"""

from __future__ import annotations

from safeloc.language.spec import Property
from safeloc.models.route import Route
from safeloc.properties.route.figures import LAW
from safeloc.properties.route.refutation import refutation
from safeloc.properties.route.reports import reached, reports
from safeloc.properties.route.safety import safety

__all__ = ["LAW", "properties"]


def properties(model: Route) -> list[Property]:
    """Every property of the route machine."""
    return [prop for maker in (safety, refutation, reports, reached) for prop in maker(model)]
