"""A junction on a journey: where another branch leaves the route.

The localizer has one coordinate, the distance along the route. Up to the switch both branches share it. Behind the switch a
place, and the truth, is the distance run along the branch that the vehicle is on: the number says nothing of which one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

from safeloc.models.balise_parts.groups import Group
from safeloc.models.localizer_sky import Off, directions

CROSSING = 9
"""A switch 1 in 9: the branch goes straight on at that slope to the route."""
ALONG, ACROSS = CROSSING / hypot(1, CROSSING), 1 / hypot(1, CROSSING)


@dataclass(frozen=True)
class Junction:
    """A switch on the route.

    switch_mm  where the branches part
    set_mm     where the front end is when the route is set; until then the other branch was, and linking is for that
    other      groups of the other branch, behind the switch; their places count along it
    """

    switch_mm: int
    set_mm: int
    other: Sequence[Group]

    def branched(self, groups: Sequence[Group]) -> list[Group]:
        """The groups of a route up to the switch, then those of the other branch."""
        return [*(group for group in groups if group.place_mm < self.switch_mm), *self.other]

    def off(self, channels: int, place_mm: int, speed_mm_s: float) -> list[Off]:
        """What satellites are off a prediction along the route, when the vehicle is on the other branch, as far along it."""
        run = max(0, place_mm - self.switch_mm)
        speed = speed_mm_s if run else 0.0
        return [
            Off(round(-(run * farther)), round(-(speed * farther)))
            for farther in (along * (ALONG - 1) + across * ACROSS for along, across in directions(channels))
        ]
