"""Properties of the precise stop at a platform (RFL-D7).

They read the true place and speed of the front end, the inputs, and the figures of the requirement: the window of the stop on
the map, the guaranteed braking distance, the reduced speed.
"""

from __future__ import annotations

from safeloc.language.spec import Property
from safeloc.models.stop_point import StopPoint
from safeloc.properties.stop_point.beyond import beyond
from safeloc.properties.stop_point.going_on import going_on
from safeloc.properties.stop_point.orders import orders
from safeloc.properties.stop_point.selection import selection
from safeloc.properties.stop_point.standing import standing
from safeloc.properties.stop_point.towards import towards


def properties(model: StopPoint) -> list[Property]:
    """Return every property of the stop-point machine."""
    return [prop for maker in (towards, going_on, standing, beyond, selection, orders) for prop in maker(model)]
