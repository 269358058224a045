"""The map's answers on routes, simulated: which begin at a group, and which reflectors each of them has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group
from safeloc.models.reflector.simulate import Route as ReflectorsAhead
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.runtime.streams.steps import Cell


@dataclass(frozen=True)
class Routes:
    """The routes of a map.

    starts     group -> the routes that begin there; the vehicle runs along the last one, which is also the permitted one
    reflectors route -> its reflectors on the map: model and place, mm
    courses    route -> its course at the switch, where the map is asked for it
    """

    starts: Mapping[int, tuple[int, ...]]
    reflectors: Mapping[int, Mapping[str, int]]
    courses: Mapping[int, str] = field(default_factory=dict)


def every_group_a_start(groups: Sequence[Group], ahead: ReflectorsAhead) -> Routes:
    """Return the map of a line without switches: one route, which begins at each group."""
    return Routes({one.identity: (1,) for one in groups}, {1: {one.model: one.position_mm for one in ahead.reflectors}})


class RouteMap:
    """The map, asked cycle by cycle; `begun`: the place from which the routes count, and those that began there."""

    def __init__(self, config: ReflectorDeviceConfig, routes: Routes, places: Mapping[int, int]) -> None:
        self._config, self._routes, self._places = config, routes, places
        self._numbers = range(1, config.route.routes + 1)
        self._begun: tuple[int, tuple[int, ...]] = (0, ())

    def started(self, group: int) -> dict[str, Cell]:
        """Return the look-up of the routes that begin at the group that is read; 0: none is."""
        routes = self._routes.starts.get(group, ())
        found: dict[str, Cell] = {"routes_ahead": len(routes)}
        found |= {f"route_{one}_candidate": one in routes for one in self._numbers}
        if routes:
            found["start_position_mm"] = self._places[group]
        return {f"starts.{name}": cell for name, cell in found.items()}

    def begin(self, group: int, reported: Mapping[str, Value]) -> None:
        """Take up the routes of a group, if the device reports that they begin in this cycle."""
        routes = self._routes.starts.get(group, ())
        if routes and reported["balise.reference_accepted"]:
            place, low, high = self._places[group], *_interval(reported)
            if 0 <= max(high - place, place - low) <= self._config.route.start_error_mm:
                self._begun = place, routes

    def seen(self, step: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return the answer to a sighting, the courses, the authority, and the ghosts of the sighted reflector."""
        place, routes = self._begun
        taken = routes[-1] if routes else 1
        answer: dict[str, Cell] = {"authorised_route": taken, "start_route": taken, "sighted_elsewhere": False}
        for one in self._numbers:
            course = self._routes.courses.get(one, "UNDECIDED")
            answer |= {f"route_{one}_model": "NONE", f"route_{one}_course": course, f"route_{one}_other_in_view": False}
        echo = self._sighting(step)
        model = "NONE" if echo is None else str(step[f"{echo}_model"])
        away = 0 if echo is None else int(step[f"reflector.{echo}_map_place_mm"]) - place
        for one in routes if echo else ():
            if model in self._routes.reflectors[one]:
                there = self._routes.reflectors[one][model] - place
                answer |= {f"route_{one}_reflector_mm": there, f"route_{one}_model": model}
        answer |= {"sighted_place_nm": away * NM_PER_MM, "sighted_model": model}
        return {f"route.{name}": cell for name, cell in answer.items()}

    def _sighting(self, step: Mapping[str, Cell]) -> str | None:
        """Return the first echo that shows a model with the minimum intensity, and is not too close."""
        figures = self._config.reflector
        least, near = figures.minimum_intensity_cdb, max(figures.near_range_mm, figures.radar_offset_mm)
        for number in range(1, figures.echo_slots + 1):
            name = f"echo_{number}"
            strong = int(step.get(f"{name}_range_mm", -1)) >= near and int(step[f"{name}_intensity_cdb"]) >= least
            if strong and step[f"{name}_model"] != "NONE":
                return name
        return None


def _interval(reported: Mapping[str, Value]) -> tuple[int, int]:
    place, below, above = (int(reported[f"balise.{name}_mm"]) for name in ("position", "margin_below", "margin_above"))
    return place - below, place + above
