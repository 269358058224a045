"""Simulated runs over a map with facing switches, as steps of the occupied track, its ghosts included.

A vehicle runs along a route of the line of source 001, fig. 3, to which groups behind the last switches are added. The localizer is
drawn: an interval around the front end. The map answers to what the machine on board carries.

`python -m safeloc.models.occupied_track.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from random import Random

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.occupied_track import machine
from safeloc.models.occupied_track.look_up import LookUp, Track
from safeloc.models.occupied_track.variables import OccupiedTrackConfig
from safeloc.proof.drawn_runs.worked import WorkedRun, write_named
from safeloc.railway.map.elements import Balise, BaliseGroup
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Route, through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Run, Topology
from safeloc.runtime.streams.steps import Cell
from safeloc.simulated import SimulatedRun
from safeloc.simulation.motion import Leg, VehicleConfig, move

_MARGIN_MM = 12_000
_DRIFT_MM = 1_000  # of the estimate's error in a cycle
_GROUP_ERROR_MM = 1_000
_SEEN_BEHIND_MM = 30_000  # a turn shows when the vehicle is through the turnout
_REACH_MM = 5_000  # farthest that a vehicle is simulated beyond a place in one cycle
_ADDED = {"302-304": 100_000, "309": 80_000, "310": 80_000}
"""Edge -> place of a group that fig. 3 does not have, mm."""


@dataclass(frozen=True)
class Scene:
    """A run along one of the routes of the line.

    models     the reflector models along the route, by which fig. 3 names it
    legs       the vehicle's movement from standstill at the beginning of the route
    turns      the turn-off machine sees the course at every facing switch
    points     the interlocking states the points of every facing switch, from 50 m before it
    unlocated  from here to there along the route the localizer gives no position, mm
    """

    models: str
    legs: Sequence[Leg]
    turns: bool = False
    points: bool = False
    unlocated: tuple[int, int] = (0, 0)


@lru_cache(maxsize=1)
def line() -> Line:
    """Return fig. 3 with groups of its own behind some switches, which tell the branch."""
    plain = find_line("fig3")
    added = (
        BaliseGroup(id=f"of {edge}", edge=edge, identity=400 + number, balises=(Balise(position_mm=place),))
        for number, (edge, place) in enumerate(_ADDED.items())
    )
    return plain.model_copy(update={"balise_groups": (*plain.balise_groups, *added)})


def route_of(topology: Topology, models: str) -> Route:
    """Return the route of fig. 3 with these reflector models along it."""
    routes = [one for one in through_routes(topology, 100) if one.runs[0].direction == "increasing"]
    return next(one for one in routes if one.models() == models)


def simulate(config: OccupiedTrackConfig, scene: Scene, *, seed: int) -> SimulatedRun:
    """Return a run as steps: inputs, ghost inputs, and the remark `truth_mm` (the true place on the true edge, rounded down)."""
    run = _Run(config, scene, Random(seed))
    return SimulatedRun(list(run.steps()), run.first)


def drawn(config: OccupiedTrackConfig, seed: int) -> SimulatedRun:
    """Return a run of one of the scenes, which the seed selects; each seed draws errors of its own."""
    scenes = [scene for _, scene in SCENES.values()]
    return simulate(config, scenes[seed % len(scenes)], seed=seed)


@lru_cache(maxsize=4)
def _on_board(config: str) -> Compiled:
    """Return the machine without its world, cached for further runs with the same configuration (JSON)."""
    return compile_system(without_ghosts(lower(machine(OccupiedTrackConfig.model_validate_json(config)))))


@dataclass
class TrueTrack:
    """The true edge and where it begins, along a route from coordinate 0."""

    route: Route
    index: int = 0
    origin_mm: int = 0

    @property
    def run(self) -> Run:
        """The true edge, in the direction of growing coordinates."""
        return self.route.runs[self.index]

    @property
    def length_mm(self) -> int:
        """Length of the true edge."""
        return self.route.topology.length_mm(self.run)

    def go(self, truth_nm: int) -> str:
        """Move to a coordinate; return the node of the facing switch that was passed ahead, or nothing."""
        topology, runs = self.route.topology, self.route.runs
        if truth_nm > (self.origin_mm + self.length_mm) * NM_PER_MM:
            self.origin_mm += self.length_mm
            self.index += 1
            passage = topology.passage(runs[self.index - 1], runs[self.index])
            return topology.end(runs[self.index - 1]) if passage and passage.facing else ""
        if truth_nm < self.origin_mm * NM_PER_MM:
            self.index -= 1
            self.origin_mm -= self.length_mm
        return ""


class _Run:
    """A run under way, with the machine on board."""

    def __init__(self, config: OccupiedTrackConfig, scene: Scene, rng: Random) -> None:
        topology = Topology(line())
        self._route = route_of(topology, scene.models)
        self._scene, self._rng, self._config = scene, rng, config
        self._map, self._world = LookUp(topology, config), TrueTrack(self._route)
        self._watched: tuple[str, int] | None = None
        self._error_mm = 0

    @cached_property
    def _board(self) -> Compiled:
        return _on_board(self._config.model_dump_json())

    @property
    def first(self) -> dict[str, Value]:
        """The first values of the ghosts: the vehicle stands at the beginning of its route."""
        run = self._route.runs[0]
        length = self._route.topology.length_mm(run)
        return {
            "true_edge": self._map.number(run),
            "true_origin_mm": 0,
            "true_length_mm": length,
            "truth_nm": 0,
            "true_place_nm": 0,
        }

    def steps(self) -> Iterator[dict[str, Cell]]:
        """Yield each cycle's inputs and ghosts."""
        vehicle = VehicleConfig(max_speed_mm_s=self._config.max_speed_mm_s)
        before, self._state = 0, self._board.first()
        for position in move(vehicle, self._scene.legs, self._config.period_ms).position_nm:
            yield self._cycle(before, int(position))
            before = int(position)

    def _cycle(self, before_nm: int, truth_nm: int) -> dict[str, Cell]:
        switch = self._world.go(truth_nm)
        if switch:
            self._watched = (switch, self._world.origin_mm)
        low, high = self._interval(truth_nm)
        seen = self._turn_seen(before_nm, truth_nm)
        course = self._course(seen)
        inputs: dict[str, Cell] = {
            "located": not self._scene.unlocated[0] <= truth_nm // NM_PER_MM < self._scene.unlocated[1],
            "front_low_mm": low,
            "front_high_mm": high,
            "surely_not_ahead": truth_nm <= before_nm,
            "surely_not_back": truth_nm >= before_nm,
            "course_taken": course,
            **self._map.answer(self._carried(), low, high, points=self._points(truth_nm), watched=seen),
            **self._groups(before_nm, truth_nm),
        }
        self._state, _ = self._board.step(self._state, self._board.read(inputs))
        edge = self._map.number(self._world.run)
        ghosts: dict[str, Cell] = {
            "next_truth_nm": truth_nm,
            "entered_edge": edge,
            "entered_length_mm": self._world.length_mm,
            "true_course": course,
        }
        return {**inputs, **ghosts, "truth_mm": truth_nm // NM_PER_MM - self._world.origin_mm}

    def _carried(self) -> list[Track | None]:
        """Return what the machine on board carries."""
        return self._map.carried(self._board.named_outputs(self._state))

    def _interval(self, truth_nm: int) -> tuple[int, int]:
        """Return the localizer's interval: of a margin that holds, around an estimate whose error drifts."""
        self._error_mm += round(self._rng.uniform(-_DRIFT_MM, _DRIFT_MM))
        self._error_mm = max(-_MARGIN_MM + 1, min(self._error_mm, _MARGIN_MM - 1))
        estimate = truth_nm // NM_PER_MM + self._error_mm
        return estimate - _MARGIN_MM, estimate + _MARGIN_MM

    def _turn_seen(self, before_nm: int, truth_nm: int) -> str:
        """Return the node of the switch whose course is seen in this cycle: when the vehicle is through the turnout."""
        if self._watched is None or not self._scene.turns:
            return ""
        node, place = self._watched
        through = (place + _SEEN_BEHIND_MM) * NM_PER_MM
        return node if before_nm < through <= truth_nm else ""

    def _course(self, node: str) -> str:
        """Return the course taken at a switch of the route."""
        for before, after in zip(self._route.runs, self._route.runs[1:], strict=False):
            passage = self._route.topology.passage(before, after)
            if passage is not None and self._route.topology.end(before) == node:
                return self._route.topology.course(passage)
        return "UNDECIDED"

    def _points(self, truth_nm: int) -> dict[str, str]:
        """Return the points that the interlocking states: those of the route's facing switches, near the vehicle."""
        if not self._scene.points:
            return {}
        near = 50_000
        return {
            met.passage.switch.node: met.passage.branch
            for met in self._route.switches()
            if met.passage.facing and abs(met.position_mm - truth_nm // NM_PER_MM) <= near
        }

    def _groups(self, before_nm: int, truth_nm: int) -> dict[str, Cell]:
        """Return what a group that is passed tells: the track where none is carried, else which of those that are."""
        quiet: dict[str, Cell] = {
            "start_given": False, "start_edge": 1, "start_origin_mm": 0, "start_length_mm": self._config.shortest_edge_mm, "group_place_mm": 0, "group_error_mm": 0,
        }  # fmt: skip
        passed = [
            met for met in self._route.objects()
            if isinstance(met.element, BaliseGroup) and before_nm < met.position_mm * NM_PER_MM <= truth_nm
        ]  # fmt: skip
        if not passed:
            return quiet
        edge, origin = self._map.number(self._world.run), self._world.origin_mm
        if not any(self._carried()):
            return quiet | {
                "start_given": True,
                "start_edge": edge,
                "start_origin_mm": origin,
                "start_length_mm": self._world.length_mm,
            }
        place = passed[-1].position_mm - origin
        return quiet | {"group_edge": edge, "group_place_mm": place, "group_error_mm": _GROUP_ERROR_MM + _REACH_MM}


# ------------------------------------------------------------------ named runs

_THROUGH = [Leg(25_000, 51.0)]
_BACK = [Leg(20_000, 30.0), Leg(0, 40.0), Leg(-6_000, 30.0), Leg(0, 15.0), Leg(20_000, 40.0)]
SCENES: Mapping[str, tuple[str, Scene]] = {
    "occupied_track-told-by-a-group": (
        "Behind each facing switch both branches are carried, up to the group that tells the one taken.",
        Scene("ADAB", _THROUGH),
    ),
    "occupied_track-turns-seen": (
        "At each facing switch the turn that is seen ends the other branch; the vehicle rolls back over one, and on again.",
        Scene("ACD", _BACK, turns=True),
    ),
    "occupied_track-points-stated": (
        "The points are stated, so one edge is known all the time; the position fails, and a group begins anew.",
        Scene("ADAD", _THROUGH, points=True, unlocated=(330_000, 345_000)),
    ),
}


def _named(outcome: str, scene: Scene, seed: int) -> WorkedRun[OccupiedTrackConfig]:
    return WorkedRun(outcome, lambda config: simulate(config, scene, seed=seed), _first(OccupiedTrackConfig()))


def _first(config: OccupiedTrackConfig) -> Mapping[str, Value]:
    """Return first values: every run begins at the western end of track 301."""
    return _Run(config, SCENES["occupied_track-turns-seen"][1], Random(0)).first


RUNS: Mapping[str, WorkedRun[OccupiedTrackConfig]] = {
    name: _named(outcome, scene, seed) for seed, (name, (outcome, scene)) in enumerate(SCENES.items(), 1)
}
"""The recordings that ship, by name."""

if __name__ == "__main__":
    write_named(__file__, RUNS, {}, OccupiedTrackConfig())
