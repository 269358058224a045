"""A junction on a journey: a switch at which another branch leaves the route.

The localizer has one coordinate, the distance along the route. Up to the switch both branches share it. Behind the switch, a
place (the true one included) is the distance along the vehicle's branch; the number does not tell which branch that is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.models.balise.groups import Group


@dataclass(frozen=True)
class Junction:
    """A switch on the route.

    switch_mm  place at which the branches part
    set_mm     place of the front end when the route is set; until then the route, and linking, are those of the other branch
    other      groups of the other branch behind the switch; their places count along it
    """

    switch_mm: int
    set_mm: int
    other: Sequence[Group]

    def branched(self, groups: Sequence[Group]) -> list[Group]:
        """Return the groups of a route up to the switch, followed by those of the other branch."""
        return [*(group for group in groups if group.place_mm < self.switch_mm), *self.other]

    def undecided(
        self, places_mm: NDArray[np.int64], passed: Sequence[Group], announced: Sequence[Group]
    ) -> NDArray[np.bool_]:
        """Return at which places either branch is possible: behind the switch, where no announced group there was passed yet."""
        known = {group.identity for group in announced}
        on_it = [one.place_mm for one in passed if one.place_mm >= self.switch_mm and one.identity in known]
        undecided = places_mm >= self.switch_mm
        return np.asarray(undecided & (places_mm < min(on_it)) if on_it else undecided, dtype=np.bool_)
