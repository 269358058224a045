"""Journeys of a localizer over the switches of fig. 3, as steps of the localizer on the map, its ghosts included.

The localizer's own simulation gives what its sensors say. The map is asked before the interval of the cycle is known, so with that of the
cycle before, widened. On two journeys the vehicle takes the branch that was not announced. The balise machine refuses the groups of that
branch, and they tell the track; or the reflector behind the switch has told it before.

`python -m safeloc.models.localizer_track.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.nodes import Value
from safeloc.language.system import without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group
from safeloc.models.localizer.simulation.journey import Journey
from safeloc.models.localizer.simulation.junction import Junction
from safeloc.models.localizer.simulation.simulate import first_state as localizer_first
from safeloc.models.localizer.simulation.simulate import simulate as simulate_localizer
from safeloc.models.localizer_track import NAME, LocalizerTrackConfig, compose_machines
from safeloc.models.localizer_track.switch_seen import seen, watches
from safeloc.models.occupied_track.look_up import LookUp
from safeloc.models.occupied_track.simulate import TrueTrack, route_of
from safeloc.models.turn_off import STRAIGHT
from safeloc.models.turn_off.simulate import SwitchAhead
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.streams.steps import Cell
from safeloc.simulated import SimulatedRun
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg

_WIDER_MM = 15_000
"""By how much the interval of the cycle before is widened for the map: a cycle's run, and a jump of the position."""
_READ_ERROR_MM = 10_000
"""Farthest from a group that its telegram is handed over."""
_SWITCH_MM = 300_000
_ACCURATE_MM = 1_000
_RUN = [Leg(20_000, 60.0), Leg(0, 5.0)]
_STEM = [Group(number, place, accuracy_mm=_ACCURATE_MM) for number, place in enumerate((60_000, 180_000), 1)]
_AHEAD = [Group(number, place, accuracy_mm=_ACCURATE_MM) for number, place in enumerate((400_000, 600_000, 720_000), 3)]
_ASIDE = [Group(number, place, accuracy_mm=_ACCURATE_MM) for number, place in enumerate((420_000, 620_000), 11)]


@dataclass(frozen=True)
class Scene:
    """A journey, the reflector models along the route that the vehicle really takes, and the groups that it passes.

    switch, node  a facing switch whose reflector the radar measures, and its node on the map
    """

    journey: Journey
    models: str
    passed: tuple[Group, ...]
    switch: SwitchAhead | None = None
    node: str = ""


_JUNCTION = Junction(_SWITCH_MM, 100_000, _ASIDE)
SCENES: Mapping[str, tuple[str, Scene]] = {
    f"{NAME}-as-announced": (
        "Behind the first switch both branches are carried; the first announced group on one of them ends the other.",
        Scene(Journey(_RUN, groups=[*_STEM, *_AHEAD]), "ADAB", (*_STEM, *_AHEAD)),
    ),
    f"{NAME}-other-branch": (
        "The vehicle takes the branch that was not announced: its groups are refused as references, and tell the track as long as the "
        "position lasts.",
        Scene(
            Journey(
                _RUN, groups=[*_STEM, *_AHEAD], junction=_JUNCTION, troubles=[Fault("other branch taken", "", 0, 10_000)]
            ),
            "ACD",
            (*_STEM, *_ASIDE),
        ),
    ),
    f"{NAME}-turn-seen": (
        "The same branch, and the turn is seen by the reflector behind the switch: it ends the announced branch before any group of the other "
        "is read. Then the odometer falls silent, and with the position the track is lost.",
        Scene(
            Journey(
                [Leg(20_000, 38.0)],
                groups=[*_STEM, *_AHEAD],
                junction=_JUNCTION,
                troubles=[
                    Fault("other branch taken", "", 0, 10_000),
                    Fault("uplink silent", "", 260, 280),
                    Fault("odometer silent", "", 338, 380),
                ],
            ),
            "ACD",
            (*_STEM, *_ASIDE),
            SwitchAhead(_SWITCH_MM, "RIGHT", _SWITCH_MM + 55_000),
            "302",
        ),
    ),
}  # fmt: skip


@lru_cache(maxsize=2)
def _on_board(config: str) -> Compiled:
    """Return the composition without its world, cached for further runs with the same configuration (JSON)."""
    whole = compose_machines(LocalizerTrackConfig.model_validate_json(config))
    return compile_system(without_ghosts(whole.composition.system))


def simulate(config: LocalizerTrackConfig, scene: Scene, *, seed: int) -> Steps:
    """Return the journey as steps: inputs, ghosts, and the remark `truth_mm` (the true place on the true edge, rounded down)."""
    return list(_Run(config, scene).steps(seed))


def drawn(config: LocalizerTrackConfig, seed: int) -> SimulatedRun:
    """Return a journey of one of the scenes, which the seed selects; each seed draws errors of its own."""
    scenes = [scene for _, scene in SCENES.values()]
    run = _Run(config, scenes[seed % len(scenes)])
    first = run.first  # before the vehicle leaves its first edge
    return SimulatedRun(list(run.steps(seed)), first)


class _Run:
    """A journey under way, with the composition on board."""

    def __init__(self, config: LocalizerTrackConfig, scene: Scene) -> None:
        topology = Topology(find_line("fig3"))
        self._config, self._scene = config, scene
        self._map = LookUp(topology, config.track)
        self._world = TrueTrack(route_of(topology, scene.models))

    @cached_property
    def _board(self) -> Compiled:
        return _on_board(self._config.model_dump_json())

    @cached_property
    def _inputs(self) -> frozenset[str]:
        """The names of the inputs, those that may be absent without the mark of their presence."""
        return frozenset(name.removesuffix(".present") for name in self._board.input_names)

    @property
    def first(self) -> dict[str, Value]:
        """First values of open variables: the vehicle stands at the beginning of track 301."""
        track: dict[str, Value] = {
            "true_edge": self._map.number(self._world.run), "true_origin_mm": 0, "true_length_mm": self._world.length_mm,
            "true_place_nm": 0,
        }  # fmt: skip
        first = localizer_first(self._config.localizer, self._scene.journey)
        course: dict[str, Value] = {"true_switch_mm": 0, "true_course": STRAIGHT.value, "true_lateral_mm": 0}
        return {
            **first,
            **{f"turn_off.{name}": value for name, value in course.items()},
            **{f"occupied_track.{name}": value for name, value in track.items()},
        }

    def steps(self, seed: int) -> Iterator[dict[str, Cell]]:
        """Yield each cycle's inputs and ghosts."""
        before, self._state = 0, self._board.first()
        for given in simulate_localizer(self._config.localizer, self._scene.journey, seed=seed):
            distance_nm = given["true_cycle_distance_nm"]
            assert isinstance(distance_nm, int)
            yield self._cycle(dict(given), before, before + distance_nm)
            before += distance_nm

    def _cycle(self, given: dict[str, Cell], before_nm: int, truth_nm: int) -> dict[str, Cell]:
        self._world.go(truth_nm)
        cells = given | self._course(truth_nm) | self._track(given, before_nm, truth_nm)
        cells["truth_mm"] = truth_nm // NM_PER_MM - self._world.origin_mm
        on_board = {name: cell for name, cell in cells.items() if name in self._inputs}
        self._state, _ = self._board.step(self._state, self._board.read(on_board))
        return cells

    def _course(self, truth_nm: int) -> dict[str, Cell]:
        """Return what the course at switches is given."""
        outputs = self._board.named_outputs(self._state)
        high = None if outputs["delocalized.restrictive"] else self._interval(outputs)[1]
        cells = seen(self._config.turn_off, self._scene.switch, truth_nm, high, self._watching)
        return {f"turn_off.{name}": cell for name, cell in cells.items()}

    @property
    def _watching(self) -> bool:
        state = dict(zip(self._board.state_names, self._state, strict=True))
        return watches(state, self._scene.switch)

    def _track(self, given: Mapping[str, Cell], before_nm: int, truth_nm: int) -> dict[str, Cell]:
        outputs = self._board.named_outputs(self._state)
        told = {name.removeprefix("occupied_track."): value for name, value in outputs.items()}
        low, high = self._interval(outputs)
        edge = self._map.number(self._world.run)
        cells: dict[str, Cell] = {
            "surely_not_ahead": truth_nm <= before_nm,
            "surely_not_back": truth_nm >= before_nm,
            "start_edge": edge,
            "start_origin_mm": self._world.origin_mm,
            "start_length_mm": self._world.length_mm,
            "group_place_mm": 0,
            "group_error_mm": 0,
            **self._map.answer(self._map.carried(told), low, high, watched=self._scene.node if self._watching else ""),
            **self._group(given, edge),
            "entered_edge": edge,
            "entered_length_mm": self._world.length_mm,
        }
        return {f"occupied_track.{name}": cell for name, cell in cells.items()}

    def _interval(self, outputs: Mapping[str, Value]) -> tuple[int, int]:
        """Return the interval for the map: that of the cycle before, widened; the place 0 while there is none."""
        if outputs["delocalized.restrictive"]:
            return 0, 0
        position = int(outputs["delocalized.position_mm"])
        below, above = (int(outputs[f"delocalized.margin_{side}_mm"]) for side in ("below", "above"))
        return position - below - _WIDER_MM, position + above + _WIDER_MM

    def _group(self, given: Mapping[str, Cell], edge: int) -> dict[str, Cell]:
        """Return what a telegram tells of the track, by the map of the whole line: of any group that is read."""
        read = next((one for one in self._scene.passed if one.identity == given.get("balise.telegram_group")), None)
        if read is None:
            return {}
        return {
            "group_edge": edge,
            "group_place_mm": read.place_mm - self._world.origin_mm,
            "group_error_mm": _READ_ERROR_MM,
        }


def _named(outcome: str, scene: Scene, seed: int) -> WorkedRun[LocalizerTrackConfig]:
    return WorkedRun(
        outcome, lambda config: simulate(config, scene, seed=seed), _Run(LocalizerTrackConfig(), scene).first
    )


RUNS: Mapping[str, WorkedRun[LocalizerTrackConfig]] = {
    name: _named(outcome, scene, seed) for seed, (name, (outcome, scene)) in enumerate(SCENES.items(), 1)
}
"""The recordings that ship, by name."""

if __name__ == "__main__":
    write_named(__file__, RUNS, {}, LocalizerTrackConfig())
