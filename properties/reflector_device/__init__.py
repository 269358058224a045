"""Properties of the reflector device as one (RFL-1, RFL-5, RFL-9, RFL-12, RFL-D3 to RFL-D7).

host       what the host gets, and the words in which all claims are said
located    what a telegram does to the reflector machine, the course at a switch, and the stop at a platform
met        what the direction hears of the radar's frame
direction  a wrong direction ends the position, and only a wrong one does
route      the branch that is told is the true one, and a lost route ends the position
"""

from __future__ import annotations

from safeloc.language.spec import Property
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.properties.reflector_device import direction, located, met, route

__all__ = ["properties"]


def properties(whole: ReflectorDevice) -> list[Property]:
    """Return the properties of the whole device."""
    return [prop for part in (located, met, direction, route) for prop in part.properties(whole)]
