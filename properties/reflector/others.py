"""Other vehicles on the line: whatever they send, and however many there are, none of their echoes gives a position (RFL-15).

For the radar another vehicle is a thing that sends echoes and is no reflector, and that hides the reflectors behind it. The world
admits both in any cycle.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import any_of
from safeloc.language.spec import Property, always
from safeloc.models.reflector import ReflectorMachine
from safeloc.properties.reflector.figures import LAW, strong


def others(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the property of a cycle in which every reflector is hidden."""
    own = model.own
    seen = any_of(strong(own, slot) & sent for slot, sent in zip(own.slots, own.ghosts.reflector, strict=True))
    yield always(
        "an echo of another vehicle is no measurement",
        seen | (~own.recognised_now & ~model.machine.flag("precise")),
        statement="in a cycle in which no reflector sends a strong echo, however strong those of other vehicles are, no reflector is recognised and "
        "none gives the position",
        requirements=("RFL-15",),
        assumption=LAW,
    )
