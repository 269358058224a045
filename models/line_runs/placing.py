"""Place of a named fault on a route: the group or reflector, the cycles, and the fault's name in each simulation."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.language.units import NM_PER_MM
from safeloc.models.line_runs.faults import FAULTS, Asked
from safeloc.models.line_runs.ways import MODELS, balise_groups, identities, reflectors
from safeloc.railway.map.elements import BaliseGroup, Reflector
from safeloc.railway.map.routes import Route
from safeloc.simulation.faults import Fault, Figure
from safeloc.simulation.motion import Motion

SHIFT_MM, DECOY_MM = 20_000, 30_000
WITHIN = re.compile(r"(\d+)-(\d+)")


@dataclass(frozen=True)
class Struck:
    """A fault at its place on one route.

    at, identity, place_mm  name of the group or reflector on the map, its number on board, its place
    begin, end              cycles from `begin` up to, not including, `end`
    model                   a model that no reflector of the line has
    """

    name: str
    outcome: dict[str, str]
    begin: int
    end: int
    at: str = ""
    identity: int = 0
    place_mm: int = 0
    model: str = "NONE"

    def of_group(self) -> list[Fault]:
        """Return the fault for the balise simulation."""
        return [Fault(kind, self.identity) for kind in self._kinds("group")]

    def of_reader(self) -> list[Fault]:
        """Return the fault for the front reader of the odometry simulation."""
        return [Fault(kind, "front_marker", self.begin, self.end) for kind in self._kinds("reader")]

    def of_distance(self, sensor: str, max_cycle_distance_mm: int) -> list[Fault]:
        """Return the fault for a distance sensor.

        A jump is farther than the vehicle can run in a cycle, but within the input's range: the border would refuse a farther one.
        """
        figures = {"by_mm": max_cycle_distance_mm + 500} if self.name == "distance-jump" else {}
        return [Fault(kind, sensor, self.begin, self.end, figures) for kind in self._kinds("distance")]

    def of_radar(self) -> list[Fault]:
        """Return the fault for the reflector simulation."""
        figures: dict[str, dict[str, Figure]] = {
            "echoes-shifted": {"by_mm": SHIFT_MM},
            "decoy": {"by_mm": DECOY_MM, "model": self.model},
        }
        more = figures.get(self.name, {})
        return [Fault(kind, "", self.begin, self.end, more) for kind in self._kinds("radar")]

    def _kinds(self, simulation: str) -> list[str]:
        """Return the fault's name in that simulation, or no name if it does not simulate the fault."""
        kind = FAULTS[self.name].kinds.get(simulation)
        return [] if kind is None else [kind]


def placed(asked: Asked, route: Route, motion: Motion) -> Struck | None:
    """Return the fault on this route; None if the group or reflector that it names is not on the route.

    A fault without a place strikes at the last group or reflector, or in the middle fifth. InputError for a place off the route, or a
    group or reflector that the line does not have.
    """
    match asked.fault.where:
        case "group":
            return _at_group(asked, route, motion)
        case "reflector":
            return _at_reflector(asked, route, motion)
        case "stretch":
            return _on_stretch(asked, route, motion)
        case "stop" | "run":
            return Struck(asked.fault.name, dict(asked.fault.outcomes), 0, len(motion.position_nm))


def _at_group(asked: Asked, route: Route, motion: Motion) -> Struck | None:
    met = [(one.position_mm, group) for one, group in balise_groups(route)]
    found = _named(asked, met, [group.id for group in route.topology.line.balise_groups])
    if found is None:
        return None
    place, group = found
    assert isinstance(group, BaliseGroup)
    begin = _reached(motion, place)
    number = identities(route.topology.line)[group.id]
    return Struck(asked.fault.name, dict(asked.fault.outcomes), begin, begin + 1, group.id, number, place)


def _at_reflector(asked: Asked, route: Route, motion: Motion) -> Struck | None:
    line = route.topology.line
    found = _named(asked, reflectors(route), [one.id for one in line.reflectors])
    if found is None:
        return None
    place, one = found
    assert isinstance(one, Reflector)
    view = one.view_from_mm // 2 if asked.fault.name == "echoes-shifted" else one.view_from_mm
    begin, end = _reached(motion, place - view), _reached(motion, place)
    free = [model for model in MODELS if model not in {other.model for other in line.reflectors}]
    if asked.fault.name in ("model-misread", "decoy") and not free:
        raise InputError(
            f"fault {asked.fault.name} needs a model that the line does not have, but the line has all of {', '.join(MODELS)}."
        )
    model = free[0] if free else "NONE"
    return Struck(asked.fault.name, dict(asked.fault.outcomes), begin, max(end, begin + 1), one.id, 0, place, model)


def _named(
    asked: Asked, met: Sequence[tuple[int, BaliseGroup | Reflector]], known: Sequence[str]
) -> tuple[int, BaliseGroup | Reflector] | None:
    if not asked.at:
        return met[-1] if met else None
    if asked.at not in known:
        raise InputError(
            f"fault {asked.fault.name}:{asked.at}: the line has no such {asked.fault.where}; it has {known}."
        )
    return next(((place, one) for place, one in met if one.id == asked.at), None)


def _on_stretch(asked: Asked, route: Route, motion: Motion) -> Struck:
    low, high = 2 * route.length_mm // 5, 3 * route.length_mm // 5
    if asked.at:
        found = WITHIN.fullmatch(asked.at)
        if found is None:
            raise InputError(f"fault {asked.fault.name}:{asked.at}: expected FROM-TO in mm along the route.")
        low, high = int(found[1]), int(found[2])
    begin, end = _reached(motion, low), _reached(motion, high)
    if not (low < high <= route.length_mm and begin < end):
        raise InputError(f"fault {asked.fault.name}: {low}-{high} is no stretch of a route of {route.length_mm} mm.")
    return Struck(asked.fault.name, dict(asked.fault.outcomes), begin, end)


def _reached(motion: Motion, place_mm: int) -> int:
    """Return the first cycle at whose end the front end is at or beyond a place; the last cycle if it never gets there."""
    beyond = motion.position_nm >= place_mm * NM_PER_MM
    return int(beyond.argmax()) if bool(beyond.any()) else len(motion.position_nm) - 1
