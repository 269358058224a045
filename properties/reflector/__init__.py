"""Properties of the reflector machine (RFL-1 to RFL-3, -5, -6, -8, -10, -15, -D2, -D3).

They read the true places of end A and of the echoes' origins, the inputs, and the machine's outputs and state. Their figures
come from the requirement (`figures`), not from terms of the machine.
"""

from __future__ import annotations

from safeloc.language.spec import Property
from safeloc.models.reflector import ReflectorMachine
from safeloc.properties.reflector.figures import LAW
from safeloc.properties.reflector.found import found
from safeloc.properties.reflector.leaving import leaving
from safeloc.properties.reflector.not_found import not_found
from safeloc.properties.reflector.others import others
from safeloc.properties.reflector.room import layout_of, room
from safeloc.properties.reflector.safety import safety
from safeloc.properties.reflector.search import search
from safeloc.properties.reflector.self_test import self_test
from safeloc.properties.reflector.view import view
from safeloc.properties.reflector.zones import zones

__all__ = ["LAW", "layout_of", "properties"]


def properties(model: ReflectorMachine) -> list[Property]:
    """Return every property of the reflector machine."""
    makers = (safety, view, search, zones, leaving, self_test, found, not_found, others, room)
    return [prop for maker in makers for prop in maker(model)]
