"""The picture of a run of the reflector machine, as in source 001, fig. 1."""

from __future__ import annotations

from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.railway.pictures import Deviation, Things
from safeloc.reported import Reported

STATION = {180_000: "204", 360_000: "205", 410_000: "208"}
CALLED = {"reflector-figure-1": {180_000: "109", 600_000: "111"}, "reflector-figure-2-overrun": STATION}
"""Numbers that the source's figures give the reflectors of the shipped recordings, by place in mm."""


def picture(config: ReflectorConfig) -> Deviation:
    """Return the deviation over distance, with balises, reflectors and view zones as the map gives them on the way."""
    zone = ("next_view_from_mm", "next_view_to_mm")
    things = (
        Things("balise", "balise_position_mm", "balise"),
        Things("reflector", "next_position_mm", "next_model", zone, CALLED),
    )
    return Deviation("Deviation of the reported position over distance", Reported(), config.tolerance_mm, things)
