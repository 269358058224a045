"""Simulated runs of the reflector device as step streams, ghosts included: odometer, groups, and a radar along one route.

The map is simulated too: its next reflector is the one ahead of the reported position, so each stream is made step by step with
the whole device running. `python -m safeloc.models.reflector_device.simulate` writes the recordings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.nodes import Value
from safeloc.language.system import without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise import simulate as balise_streams
from safeloc.models.balise.groups import Group
from safeloc.models.motion.simulate import Measured, measured_by
from safeloc.models.motion.world import ODOMETER_LAWFUL
from safeloc.models.reflector.simulate import Radar, Reflector, Route, next_on_map, stopping
from safeloc.models.reflector.simulate import Scene as RadarScene
from safeloc.models.reflector.step_inputs import completed
from safeloc.models.reflector_device import NAME, compose_machines
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.map_neighbours import neighbours
from safeloc.models.reflector_device.route_map import RouteMap, Routes, every_group_a_start
from safeloc.models.stop_point.simulate import StopPlace, places, run_out_nm, speed_error
from safeloc.models.turn_off import COURSE
from safeloc.models.turn_off.simulate import SwitchAhead, shift_mm
from safeloc.proof.drawn_runs.worked import WorkedRun, write_runs
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Motion

Steps = list[dict[str, Cell]]
FOLDER, SEED = Path(__file__).with_name("recordings"), 7
_OF_THE_MAP = ("next_position_mm", "next_reference_mm")
"""Inputs of the reflector machine that are inputs of the line here."""
_OF_THE_FRAME = ("frame_present", "echo_")
"""Beginnings of the inputs of the radar's frame, which three machines hear."""
_NOISE_MM = 100
_OF_THE_VEHICLE = ("odometer_mm", "odometer_more_nm", "odometer_next_wander_nm", "true_cycle_distance_nm", "truth_mm")
"""Names of the balise machine's own steps that the vehicle gives here."""


_STRAIGHT, _LEFT, _RIGHTLY_MAPPED = 1, 2, 3


@dataclass(frozen=True)
class Scene:
    """A run along a route, and what is to come of it in words.

    moves         from standstill to standstill: distance (mm, negative: backwards), top speed (mm/s), acceleration and brake
                  (mm/s2), and the time it then stands (s)
    groups        balise groups, on the map and on the track
    radar         reflectors, and disturbances of the radar
    at_groups     faults of groups, by identity; `odometer`: faults of the odometer `wheel`, in cycles
    switch        a facing switch on the way; map and movement authority name the course `authorised` there
    along         the line counts in the direction of the run, which is the permitted one; else the vehicle runs against it
    stops         stop points of a platform; the mission selects the first one, and leaves it in the last cycle
    routes        the routes of the map; without any, one begins at each group, and has all reflectors
    """

    moves: Sequence[tuple[int, int, int, float]]
    groups: Sequence[Group]
    radar: RadarScene
    at_groups: Sequence[Fault] = ()
    odometer: Sequence[Fault] = ()
    switch: SwitchAhead | None = None
    authorised: str = "UNDECIDED"
    along: bool = True
    stops: tuple[StopPlace, ...] = ()
    routes: Routes | None = None
    says: str = ""


LINE = Route(
    (),
    (Reflector(380_000, "A", 100_000), Reflector(700_000, "B", 150_000), Reflector(1_400_000, "C", 120_000),
     Reflector(1_480_000, "D", 120_000)),
)  # fmt: skip
GROUPS = (
    Group(101, 100_000, accuracy_mm=1_000), Group(102, 200_000, accuracy_mm=1_000),
    Group(103, 300_000, accuracy_mm=1_000, reflector_mm=80_000),
    Group(104, 900_000, accuracy_mm=1_000), Group(105, 1_100_000, accuracy_mm=1_000),
    Group(106, 1_300_000, accuracy_mm=1_000, reflector_mm=100_000, search_mm=10_000),
)  # fmt: skip
SCENES: Mapping[str, Scene] = {
    "line": Scene(
        [(1_600_000, 20_000, 700, 2.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        says="The second group confirms the first. The telegram of the third tells the distance to reflector A: it is measured there, "
        "and passes the self-test. Reflector B is found 170 m after A is passed. Far from any group and reflector the tolerance is "
        "exceeded; two groups later the position is back, and the last telegram lets the search begin too late for a self-test. Reflectors B and C, before and "
        "behind these groups, tell that the vehicle runs along the line, as it is permitted to.",
    ),
    "rejected": Scene(
        [(1_600_000, 20_000, 700, 2.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        at_groups=(Fault("corrupted", 103),),
        says="The telegram of the third group is corrupted. The balise machine rejects it, and the reflector machine gets nothing of it, "
        "neither a place nor the distance to reflector A: no self-test, and no reflector counts. The position is lost, and comes back "
        "with the next groups that are accepted.",
    ),
    "wrong-way": Scene(
        [(1_600_000, 20_000, 700, 2.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        along=False,
        says="The run along the line, on one that counts the other way: the models are met in the other order, and the vehicle runs against the "
        "direction that it is permitted to. The host gets no position from the cycle in which reflector C shows that.",
    ),
    "stop": Scene(
        [(354_500, 15_000, 600, 4.0), (-4_500, 600, 300, 4.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        stops=(StopPlace(350_000, 10_000, 10_000),),
        says="A stop on the measured distance: the vehicle runs over, repositions backwards, and stands in place.",
    ),
    "astray": Scene(
        [(450_000, 15_000, 700, 2.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        switch=SwitchAhead(330_000, "LEFT", 380_000),
        authorised="STRAIGHT",
        says="The vehicle turns off to the left where it is permitted to run straight on. The image of reflector A, behind the switch, moves "
        "to the right, and the host gets no position from the cycle in which that is seen.",
    ),
    "turn-off": Scene(
        [(450_000, 20_000, 700, 2.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        switch=SwitchAhead(330_000, "LEFT", 380_000),
        authorised="LEFT",
        routes=Routes(
            {102: (_STRAIGHT, _LEFT)},
            {_STRAIGHT: {"A": 380_000}, _LEFT: {"A": 380_000, "B": 700_000}},
            courses={_STRAIGHT: "STRAIGHT", _LEFT: "LEFT"},
        ),
        says="Two routes begin at the second group, and both have a reflector A behind the switch: its sighting decides nothing. The image of A moves to the "
        "right, so the vehicle turned off to the left: from that cycle on this branch is told. The host keeps its position.",
    ),
    "undecided": Scene(
        [(650_000, 20_000, 700, 2.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        routes=Routes(
            {102: (_STRAIGHT, _LEFT)},
            {_STRAIGHT: {"A": 380_000, "C": 700_000}, _LEFT: {"A": 380_000, "B": 700_000}},
        ),
        says="The same switch, of which no turn is seen: both branches are carried over it, and the host keeps its position, until reflector B is sighted, which "
        "only the left branch has.",
    ),
    "lost": Scene(
        [(400_000, 20_000, 700, 2.0)],
        GROUPS,
        RadarScene(LINE, pauses=0, dropout=0),
        routes=Routes(
            {102: (_STRAIGHT, _LEFT), 103: (_RIGHTLY_MAPPED,)},
            {_STRAIGHT: {"C": 700_000}, _LEFT: {"B": 700_000}, _RIGHTLY_MAPPED: {"A": 380_000, "B": 700_000}},
        ),
        says="By the map neither route that begins at the second group has a reflector A. When A is sighted no route is left, and the position ends: for the host "
        "in that cycle, at the reflector machine in the next. At the third group a route begins that has it: branch and position are back.",
    ),
}  # fmt: skip
"""The scenes, by the end of the recordings' names."""


def simulate(config: ReflectorDeviceConfig, scene: Scene, *, seed: int) -> Steps:
    """Return the scene as steps: inputs, and ghosts that obey every law unless a fault breaks one."""
    motion = motion_of(config, scene)
    measured = measured_by("wheel", config.motion, motion, np.random.default_rng(seed), scene.odometer)
    groups = balise_streams.simulate(
        config.balise, seed=seed, motion=motion, groups=scene.groups, missed=0, foreign=0, counted=1.0, national_accuracy_mm=1_000, faults=scene.at_groups,
        measured=measured.reported,
    )  # fmt: skip
    return _Run(config, scene, motion, measured, np.random.default_rng(seed + 1)).steps(groups)


def first_state(config: ReflectorDeviceConfig, scene: Scene) -> dict[str, Value]:
    """Return first values of the open variables: the vehicle stands at place 0, in the direction of the run, before any switch."""
    first: dict[str, Value] = {"truth_nm": 0, "travel_direction.runs_along": scene.along, "route.truth_nm": 0}
    first_ways, *_ = (scene.routes or every_group_a_start(scene.groups, scene.radar.route)).starts.values()
    first["route.true_route"] = first_ways[-1]
    if config.motion.check is not None:
        first |= {"odometer_wander_nm": 0, "motion.lawful_wander_nm": 0, "motion.lawful_unit": ODOMETER_LAWFUL.value}
    if scene.switch is not None:
        first |= {
            "turn_off.true_switch_mm": scene.switch.position_mm,
            "turn_off.true_course": next(label.value for label in COURSE if label.label == scene.switch.course),
            "turn_off.true_lateral_mm": scene.switch.lateral_mm,
        }
    return first


def simulated(config: ReflectorDeviceConfig, seed: int) -> Steps:
    """Return the run along the line; the seed gives the errors of the sensors."""
    return simulate(config, SCENES["line"], seed=seed)


def motion_of(config: ReflectorDeviceConfig, scene: Scene) -> Motion:
    """Return the vehicle's run, which begins at place 0."""
    return stopping(config.motion.period_ms, scene.moves)


@lru_cache(maxsize=4)
def _on_board(config: str) -> Compiled:
    """Return the device without its world, compiled once for each configuration (JSON)."""
    whole = compose_machines(ReflectorDeviceConfig.model_validate_json(config))
    return compile_system(without_ghosts(whole.composition.system))


class _Run:
    """One run, cycle by cycle, with the device in the loop: its reports decide the map's answers."""

    def __init__(
        self, config: ReflectorDeviceConfig, scene: Scene, motion: Motion, measured: Measured, rng: np.random.Generator
    ) -> None:
        self._config, self._scene, self._motion, self._measured = config, scene, motion, measured
        self._radar, self._rng = Radar(config.reflector, scene.radar, rng), rng
        self._places = {group.identity: group.place_mm for group in scene.groups}
        self._board = _on_board(config.model_dump_json())
        self._known = {var.name for var in self._board.system.inputs}
        self._state = self._board.first()
        self._ways = RouteMap(
            config, scene.routes or every_group_a_start(scene.groups, scene.radar.route), self._places
        )

    def steps(self, groups: Sequence[Mapping[str, Cell]]) -> Steps:
        """Return all cycles; `groups` are the balise machine's own steps."""
        return [self._step(cycle, read) for cycle, read in enumerate(groups)]

    def _step(self, cycle: int, read: Mapping[str, Cell]) -> dict[str, Cell]:
        group = int(read.get("telegram_group", 0))
        own = {f"balise.{name}": cell for name, cell in read.items() if name not in _OF_THE_VEHICLE}
        step = {**self._vehicle(cycle), **own, **self._reflectors(cycle, read), **self._platform(cycle)}
        step |= self._switch(cycle, step) | self._direction(group)
        step |= self._ways.started(group)
        if group:
            self._ways.begin(group, self._after(step | self._ways.seen(step)))
        step |= self._ways.seen(step)
        self._state = self._moved(step)
        return step

    def _moved(self, step: Mapping[str, Cell]) -> tuple[Value, ...]:
        given = {name: cell for name, cell in step.items() if name in self._known}
        moved, _ = self._board.step(self._state, self._board.read(given))
        return moved

    def _after(self, step: Mapping[str, Cell]) -> Mapping[str, Value]:
        """Return what the device would report after the cycle; it is not made."""
        return self._board.named_outputs(self._moved(step))

    def _vehicle(self, cycle: int) -> dict[str, Cell]:
        measured = self._measured
        step: dict[str, Cell] = {"true_cycle_distance_nm": int(self._motion.distance_nm[cycle])}
        units = {"motion.odometer_mm": measured.odometer, "motion.check_mm": measured.check}
        step |= {name: int(one.distance_mm[cycle]) for name, one in units.items() if one and one.present[cycle]}
        wander = int(measured.odometer.wander_nm[cycle])
        names: tuple[str, ...] = ("balise.odometer_next_wander_nm", "reflector.next_wander_nm", "route.next_wander_nm")
        if measured.check is not None:
            names = ("odometer_next_wander_nm", "motion.lawful_next_wander_nm")
            if self._config.motion.unmeasured is not None:
                step["motion.next_between_pulses_nm"] = 0
        return step | dict.fromkeys(names, wander)

    def _reflectors(self, cycle: int, read: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return map and radar in a cycle."""
        now, step = int(self._motion.position_nm[cycle]), int(self._motion.distance_nm[cycle])
        seen = {**self._map(read), **self._radar.frame(cycle, step, now)}
        whole = {**self._radar.no_origins(), **completed(self._config.reflector, seen)}
        whole |= {"next_radar_bias_nm": self._radar.bias_mm(cycle) * NM_PER_MM}
        del whole["route_contradicted"]  # the route machine tells it
        return {self._named(name): cell for name, cell in whole.items()}

    def _named(self, name: str) -> str:
        """Return the name in the device of an input of the reflector machine: the map's and the frame's are not its own."""
        if name in _OF_THE_MAP:
            return f"line.{name}"
        return name if name in self._known and name.startswith(_OF_THE_FRAME) else f"reflector.{name}"

    def _direction(self, group: int) -> dict[str, Cell]:
        """Return the models beside a group that is read (0: none), and the permitted direction."""
        seen = dict(neighbours(self._scene.radar.route.reflectors, self._places.get(group), along=self._scene.along))
        return {f"travel_direction.{name}": cell for name, cell in {**seen, "route_direction": "ALONG"}.items()}

    def _switch(self, cycle: int, step: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return map and ghosts of the switch in a cycle, and the image of the reflector behind it, which moves as the vehicle turns off."""
        switch = self._scene.switch
        if switch is None:
            return {"turn_off.authorised_course": "UNDECIDED", **_ghosts("STRAIGHT", 0, 0)}
        shift = shift_mm(self._config.turn_off, switch, int(self._motion.position_nm[cycle]))
        seen: dict[str, Cell] = {
            "line.switch_position_mm": switch.position_mm, "line.switch_reflector_mm": switch.reflector_mm,
            "turn_off.authorised_course": self._scene.authorised, **_ghosts(switch.course, switch.lateral_mm, shift),
        }  # fmt: skip
        for name, origin in step.items():
            if name.endswith("_origin_nm") and origin == switch.reflector_mm * NM_PER_MM:
                noise = int(self._rng.integers(-_NOISE_MM, _NOISE_MM + 1))
                seen[name.removeprefix("reflector.").replace("origin_nm", "lateral_mm")] = (
                    switch.lateral_mm + shift + noise
                )
        return seen

    def _platform(self, cycle: int) -> dict[str, Cell]:
        """Return mission, platform and speed in a cycle; without a platform there is nothing to stop at."""
        config, stops = self._config.stop, self._scene.stops
        true_speed = int(self._motion.speed_mm_s[cycle])
        measured = true_speed if true_speed == 0 else true_speed + speed_error(self._rng, config)
        step: dict[str, Cell] = {
            "speed_mm_s": measured, "reposition_permitted": bool(stops), "released": False,
            "departure": cycle == len(self._motion.position_nm) - 1,
            "next_true_speed_mm_s": true_speed, "next_run_out_nm": run_out_nm(config, true_speed),
        }  # fmt: skip
        step |= places(config, stops)
        if stops:
            step["selected_stop"] = 1
        return {f"stop_point.{name}": cell for name, cell in step.items()}

    def _map(self, read: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return the map's next reflector, beyond the group that was read, and its distance from there if the telegram tells one."""
        reported = self._board.named_outputs(self._state)
        own = {name.removeprefix("reflector."): value for name, value in reported.items()}
        place = self._places.get(int(read.get("telegram_group", 0)))
        found = next_on_map(self._scene.radar.route, own, place)
        if place is None or not found or "telegram_reflector_mm" not in read:
            return found
        return {**found, "next_reference_mm": int(found["next_position_mm"]) - place}


def _ghosts(course: str, lateral_mm: int, shift_mm: int) -> dict[str, Cell]:
    """Return what is really so at a switch."""
    true: dict[str, Cell] = {"next_true_course": course, "next_true_lateral_mm": lateral_mm, "true_shift_mm": shift_mm}
    return {f"turn_off.{name}": cell for name, cell in true.items()}


def _worked(scene: Scene) -> WorkedRun[ReflectorDeviceConfig]:
    first = first_state(ReflectorDeviceConfig(), scene)
    return WorkedRun(scene.says, lambda config: simulate(config, scene, seed=SEED), first)


def write(folder: Path = FOLDER) -> list[Path]:
    """Write all recordings, each with its first state; return their paths."""
    runs = {f"{NAME}-{name}": _worked(scene) for name, scene in SCENES.items()}
    return write_runs(folder, runs, ReflectorDeviceConfig(), short=True)


if __name__ == "__main__":
    print(*write(), sep="\n")
