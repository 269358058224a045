"""The map's look-up of routes: those that begin at the group that is read.

No machine on board: it computes nothing. The route machine counts the distance of each route from the start's place.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Bool, BoolVar, Num, NumVar, Optional, boolean, maximum, number, optional
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.units import COUNT, MM
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig

NAME = "starts"
_MOST_ROUTES_AHEAD = 1_000


@dataclass(frozen=True, eq=False)
class Starts:
    """The machine and its inputs.

    place            the common start of the routes that lead on from the group that is read, mm; absent where none begin
    routes_ahead     how many routes begin there
    candidates       per route that is carried: it is one of them
    most             the most routes that are carried
    """

    machine: Machine
    place: Optional
    routes_ahead: NumVar
    candidates: tuple[BoolVar, ...]
    most: int

    @property
    def few(self) -> Bool:
        """As many routes begin as can be carried, or fewer."""
        return self.routes_ahead <= self.most

    def away(self, position: Num, below: Num, above: Num) -> Num:
        """Return the distance from the start to the farther end of an interval, mm."""
        return maximum(position + above - self.place.value, self.place.value - (position - below))


def starts(config: ReflectorDeviceConfig) -> Starts:
    """Build the machine with fresh inputs."""
    declared, table, limit = Declared(), modes("KNOWN"), config.motion.position_limit_mm
    place = declared.sensor(optional("start_position_mm", MM, -limit, limit))
    ahead = declared.sensor(number("routes_ahead", COUNT, 0, _MOST_ROUTES_AHEAD))
    numbers = range(1, config.route.routes + 1)
    candidates = tuple(declared.sensor(boolean(f"route_{one}_candidate")) for one in numbers)
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs={},
        transitions=[Transition("map looked up", table[0], table[0], TRUE, {}, ("RFL-D6",), 0)],
        doc="The routes that begin at a group. Nothing is assumed here.",
    )
    return Starts(made, place, ahead, candidates, config.route.routes)
