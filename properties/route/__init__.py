"""Properties of route recognition (RFL-D6): the true route is always among the possible ones, and no sequence decides alone.

They read the true route, the sightings, the map's answers, and the machine's outputs and state. Their figures come from the
requirement (`figures`), not from terms of the machine.
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
    """Return every property of the route machine."""
    return [prop for maker in (safety, refutation, reports, reached) for prop in maker(model)]
