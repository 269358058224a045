"""Simulated runs through a switch as step streams, ghosts included: the reflector device's run, and the map's answers for each route.

`python -m safeloc.models.reflector_route.simulate` writes the recordings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.reflector.simulate import Scene as RadarScene
from safeloc.models.reflector_device import simulate as device
from safeloc.models.reflector_route import NAME
from safeloc.models.reflector_route.configuration import ReflectorRouteConfig
from safeloc.models.turn_off import COURSE
from safeloc.models.turn_off.simulate import SwitchAhead
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_runs
from safeloc.runtime.streams.steps import Cell

FOLDER, SEED = Path(__file__).with_name("recordings"), 7
_OTHERS = ("stop_point.", "travel_direction.", "line.switch_", "line.route_contradicted")
"""Machines and inputs of the reflector device that are not composed here, or that a machine gives."""
_OF_THE_FRAME = ("frame_present", "range_mm", "error_mm", "model", "intensity_cdb", "lateral_mm")
"""Inputs of the reflector machine that the radar's frame shares with it, by the ends of their names."""
_BEFORE_MM, _BEHIND_MM = 330_000, 380_000
_STRAIGHT, _LEFT, _RIGHTLY_MAPPED = 1, 2, 3


@dataclass(frozen=True)
class Course:
    """A run along the reflector device's line, on which a switch lies at 330 m.

    driven     the run of the reflector device
    starts     group -> the routes that begin there; the vehicle runs along the last one, which is also the permitted one
    routes     route -> its reflectors on the map: model and place, mm
    courses    route -> its course at the switch, where the map is asked for it
    """

    driven: device.Scene
    starts: Mapping[int, tuple[int, ...]]
    routes: Mapping[int, Mapping[str, int]]
    says: str
    courses: Mapping[int, str] = field(default_factory=dict)


def _driven(length_mm: int, *, switch: bool = False) -> device.Scene:
    seen = SwitchAhead(_BEFORE_MM, "LEFT", _BEHIND_MM) if switch else None
    return device.Scene(
        [(length_mm, 20_000, 700, 2.0)],
        device.GROUPS,
        RadarScene(device.LINE, pauses=0, dropout=0),
        switch=seen,
        authorised="LEFT" if switch else "UNDECIDED",
    )


COURSES: Mapping[str, Course] = {
    "turn-off": Course(
        _driven(450_000, switch=True),
        {102: (_STRAIGHT, _LEFT)},
        {_STRAIGHT: {"A": 380_000}, _LEFT: {"A": 380_000, "B": 700_000}},
        "Two routes begin at the second group, and both have a reflector A behind the switch: its sighting decides nothing. The image of A moves to the "
        "right, so the vehicle turned off to the left: from that cycle on this branch is told. The host keeps its position.",
        courses={_STRAIGHT: "STRAIGHT", _LEFT: "LEFT"},
    ),
    "undecided": Course(
        _driven(650_000),
        {102: (_STRAIGHT, _LEFT)},
        {_STRAIGHT: {"A": 380_000, "C": 700_000}, _LEFT: {"A": 380_000, "B": 700_000}},
        "The same switch, of which no turn is seen: both branches are carried over it, and the host keeps its position, until reflector B is sighted, which "
        "only the left branch has.",
    ),
    "lost": Course(
        _driven(400_000),
        {102: (_STRAIGHT, _LEFT), 103: (_RIGHTLY_MAPPED,)},
        {_STRAIGHT: {"C": 700_000}, _LEFT: {"B": 700_000}, _RIGHTLY_MAPPED: {"A": 380_000, "B": 700_000}},
        "By the map neither route that begins at the second group has a reflector A. When A is sighted no route is left, and the position ends in that cycle. At "
        "the third group a route begins that has it: branch and position are back.",
    ),
}
"""The runs, by the end of the recordings' names."""


def simulate(config: ReflectorRouteConfig, course: Course, *, seed: int) -> Steps:
    """Return a run along the line as steps: inputs, and ghosts that obey every law."""
    run = _Run(config, course)
    return [run.step(one) for one in device.simulate(config.device, course.driven, seed=seed)]


class _Run:
    """One run, cycle by cycle; `begun`: the place from which the routes count, and those that began there."""

    def __init__(self, config: ReflectorRouteConfig, course: Course) -> None:
        self._config, self._course = config, course
        self._places = {group.identity: group.place_mm for group in course.driven.groups}
        self._begun: tuple[int, tuple[int, ...]] = (0, ())

    def step(self, driven: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return a cycle of the device that is driven, as one of this device."""
        own = {_named(name): cell for name, cell in driven.items() if not name.startswith(_OTHERS)}
        own |= {f"starts.{name}": cell for name, cell in self._started(driven).items()}
        own |= dict(self._image(driven))
        if self._config.motion.check is None:
            own["route.next_wander_nm"] = driven["reflector.next_wander_nm"]
        return own | {f"route.{name}": cell for name, cell in self._seen(driven).items()}

    def _started(self, driven: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return the map's look-up of routes and switch; a start is taken for accepted, as the groups of these runs are."""
        numbers = range(1, self._config.route.routes + 1)
        group = driven.get("balise.telegram_group")
        routes = self._course.starts.get(int(group), ()) if isinstance(group, int) else ()
        found: dict[str, Cell] = {"routes_ahead": len(routes)}
        found |= {f"route_{one}_candidate": one in routes for one in numbers}
        if routes and isinstance(group, int):
            self._begun = self._places[group], routes
            found["start_position_mm"] = self._places[group]
        if "line.switch_position_mm" in driven:
            found["switch_position_mm"] = driven["line.switch_position_mm"]
        return found

    def _image(self, driven: Mapping[str, Cell]) -> Iterator[tuple[str, Cell]]:
        """Yield whether the reflector behind the switch is measured, and its lateral place."""
        switch, found = self._course.driven.switch, None
        for number in self._slots():
            origin = driven.get(f"reflector.echo_{number}_origin_nm")
            if switch is not None and origin == switch.reflector_mm * NM_PER_MM:
                found = driven[f"reflector.echo_{number}_lateral_mm"]
        yield "turn_off.reflector_measured", found is not None
        yield "turn_off.lateral_mm", 0 if found is None else found

    def _seen(self, driven: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return the map's answer to a sighting, the courses, the authority, and the ghosts of the sighted reflector."""
        place, routes = self._begun
        taken = routes[-1] if routes else 1
        answer: dict[str, Cell] = {"authorised_route": taken, "start_route": taken, "sighted_elsewhere": False}
        for one in range(1, self._config.route.routes + 1):
            answer |= {f"route_{one}_model": "NONE", f"route_{one}_course": self._course.courses.get(one, "UNDECIDED")}
            answer[f"route_{one}_other_in_view"] = False
        sighted = self._sighting(driven)
        if sighted is None:
            return answer | {"sighted_place_nm": 0, "sighted_model": "NONE"}
        model, stands = str(driven[f"reflector.echo_{sighted}_model"]), driven[f"reflector.echo_{sighted}_map_place_mm"]
        for one in routes:
            if model in self._course.routes[one]:
                away = self._course.routes[one][model] - place
                answer |= {f"route_{one}_reflector_mm": away, f"route_{one}_model": model}
        return answer | {"sighted_place_nm": (int(stands) - place) * NM_PER_MM, "sighted_model": model}

    def _sighting(self, driven: Mapping[str, Cell]) -> int | None:
        """Return the number of the first echo that shows a model with the minimum intensity, and is not too close."""
        figures = self._config.reflector
        least, near = figures.minimum_intensity_cdb, max(figures.near_range_mm, figures.radar_offset_mm)
        for number in self._slots():
            name = f"reflector.echo_{number}"
            strong = int(driven.get(f"{name}_range_mm", -1)) >= near and int(driven[f"{name}_intensity_cdb"]) >= least
            if strong and driven[f"{name}_model"] != "NONE":
                return number
        return None

    def _slots(self) -> range:
        return range(1, self._config.reflector.echo_slots + 1)


def _named(name: str) -> str:
    """Return the name of an input of the reflector device in this one: those of the radar's frame belong to no single machine."""
    machine, _, own = name.partition(".")
    of_an_echo = own.startswith("echo_") and own.partition("_")[2].partition("_")[2] in _OF_THE_FRAME
    return own if machine == "reflector" and (of_an_echo or own == "frame_present") else name


def simulated(config: ReflectorRouteConfig, seed: int) -> Steps:
    """Return the run whose turn is seen; the seed gives the errors of the sensors."""
    return simulate(config, COURSES["turn-off"], seed=seed)


def first_state(config: ReflectorRouteConfig, course: Course) -> dict[str, Value]:
    """Return first values of the open variables: the vehicle stands at place 0, before the switch."""
    first, *_ = course.starts.values()
    ghosts: dict[str, Value] = {"route.true_route": first[-1], "route.truth_nm": 0}
    switch = course.driven.switch
    if switch is not None:
        [turned] = [label.value for label in COURSE if label.label == switch.course]
        ghosts |= {
            "turn_off.true_switch_mm": switch.position_mm,
            "turn_off.true_course": turned,
            "turn_off.true_lateral_mm": switch.lateral_mm,
        }
    driven = {name: value for name, value in device.first_state(config.device).items() if not name.startswith(_OTHERS)}
    return {**driven, **ghosts}


def _worked(course: Course) -> WorkedRun[ReflectorRouteConfig]:
    return WorkedRun(
        course.says,
        lambda config: simulate(config, course, seed=SEED),
        first_state(ReflectorRouteConfig(), course),
    )


def write(folder: Path = FOLDER, courses: Sequence[str] = tuple(COURSES)) -> list[Path]:
    """Write recordings, each with its first state; return their paths."""
    runs = {f"{NAME}-{name}": _worked(COURSES[name]) for name in courses}
    return write_runs(folder, runs, ReflectorRouteConfig(), short=True)


if __name__ == "__main__":
    print(*write(), sep="\n")
