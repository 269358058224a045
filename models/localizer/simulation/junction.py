"""A junction on a journey: where another branch leaves the route.

The localizer has one coordinate, the distance along the route. Up to the switch both branches share it. Behind the switch a
place, and the truth, is the distance run along the branch that the vehicle is on: the number says nothing of which one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.models.balise.groups import Group


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

    def undecided(self, place_mm: int, passed: Sequence[Group], announced: Sequence[Group]) -> bool:
        """Whether, at a place, no group behind the switch that was announced has been passed: either branch is possible then."""
        known = {group.identity for group in announced}
        on_it = (one.place_mm for one in passed if one.place_mm >= self.switch_mm and one.identity in known)
        return place_mm >= self.switch_mm and not any(one <= place_mm for one in on_it)
