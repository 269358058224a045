"""What must hold of position by reflectors and odometry between them (RFL-1 to RFL-3, -5, -6, -8, -10, -D2, -D3).

Said of where end A and the origins of echoes truly are, of what was put in, and of what the machine reports and keeps, in
figures of the requirement (`figures`).
"""

from __future__ import annotations

from safeloc.language.spec import Property
from safeloc.models.reflector import ReflectorMachine
from safeloc.properties.reflector.figures import LAW
from safeloc.properties.reflector.leaving import leaving
from safeloc.properties.reflector.not_found import not_found
from safeloc.properties.reflector.room import layout_of, room
from safeloc.properties.reflector.safety import safety
from safeloc.properties.reflector.search import search
from safeloc.properties.reflector.self_test import self_test
from safeloc.properties.reflector.view import view
from safeloc.properties.reflector.zones import zones

__all__ = ["LAW", "layout_of", "properties"]


def properties(model: ReflectorMachine) -> list[Property]:
    """Every property of the reflector machine."""
    makers = (safety, view, search, zones, leaving, self_test, not_found, room)
    return [prop for maker in makers for prop in maker(model)]
