"""One end of a train as the detector follows it, as steps of the fibre machine, with the truth.

The amplitude at an end is taken from 10 to 50 m inside it, so a section's edge is noticed when the end is 30 m beyond
it, whichever way it runs; the places of the map are shifted by as much. The map's answers depend, as a host's do, on the
count that the machine itself reports.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from safeloc.language.nodes import Value
from safeloc.language.units import MM_PER_M, NM_PER_MM
from safeloc.models.fibre.scenes.map_host import MapHost
from safeloc.models.fibre.scenes.scene import Moment, Scene
from safeloc.models.fibre.simulate import on_board
from safeloc.models.fibre.variables import FibreConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.sensing.fibre.features import End, TrainSeen
from safeloc.sensing.fibre.run_meter import RunMeter
from safeloc.sensing.fibre.step_inputs import step_inputs
from safeloc.simulation.fibre.scene import TrainTruth

Steps = list[dict[str, Cell]]
Side = Literal["low", "high"]
GHOSTS = ("true_run_nm", "next_true_edge_nm", "next_true_count", "next_section_is_real")


@dataclass(frozen=True)
class Followed:
    """The end of a train that a machine follows, and its further inputs.

    train        number of the train in the scene; side: its end towards smaller or greater places
    referred_mm  axle counters that give place and count when the end has passed them; none: the code has to give them
    flight       the time of flight is an input
    """

    train: int = 0
    side: Side = "high"
    referred_mm: tuple[int, ...] = ()
    flight: bool = True


class EndHost:
    """The host between detector and machine for one end of one train: run, map, reference, and the ghosts."""

    def __init__(self, scene: Scene, followed: Followed, config: FibreConfig | None = None) -> None:
        rules = scene.config.sections
        inside = rules.inset_mm + rules.window_mm // 2
        self._config, self._followed, self._points = config or FibreConfig(), followed, dict(scene.points or {})
        self.map = MapHost(self._config, scene.sections, inside if followed.side == "high" else -inside)
        self._meter = RunMeter(scene.config)
        self._truth_mm: int | None = None
        self._ghosts = _Ghosts(self.map)

    def before(self, train: TrainSeen | None, moment: Moment) -> None:
        """Let the run settle: a moment before the first step."""
        self._meter.follow(train, moment.time_ms)
        self._truth_mm = self.truth_mm(moment.truth[self._followed.train])
        self._ghosts.begin(self._truth_mm)

    def heard(self, train: TrainSeen | None, moment: Moment, outputs: Mapping[str, Value]) -> dict[str, Cell]:
        """Return the inputs of one step, with the truth as a remark; `outputs` are the machine's after the previous step."""
        run = self._meter.follow(train, moment.time_ms)
        now = None if train is None else self._end(train)
        made: dict[str, Cell] = {**step_inputs(now, None, self._points)}
        if not self._followed.flight:
            made.pop("flight_position_mm", None)
        if run is None:
            made.pop("amplitude_cdb", None)
        else:
            made["run_mm"] = run
        truth = self.truth_mm(moment.truth[self._followed.train])
        return made | self.map.answer(outputs) | self._reference(run, truth) | {"truth_mm": truth}

    def _end(self, train: TrainSeen) -> End | None:
        return train.high if self._followed.side == "high" else train.low

    def truth_mm(self, truth: TrainTruth) -> int:
        """Return the true place of the end, mm."""
        return round(MM_PER_M * (truth.high_m if self._followed.side == "high" else truth.low_m))

    def _reference(self, run: int | None, truth_mm: int) -> dict[str, Cell]:
        """Return the reference of an axle counter that the end passed in this cycle with a run: its place, and half a run beyond."""
        before, self._truth_mm = self._truth_mm, truth_mm
        passed = [
            place
            for place in self._followed.referred_mm
            if before is not None and min(before, truth_mm) < place <= max(before, truth_mm)
        ]
        if not passed or run is None:
            return {"reference_accepted": False, "reference_count": 0, "reference_position_mm": 0}
        place = passed[0] + run // 2
        return {"reference_accepted": True, "reference_count": self.map.below(place), "reference_position_mm": place}

    def ghosts(
        self, step: Mapping[str, Cell], was: Mapping[str, Value], outputs: Mapping[str, Value]
    ) -> dict[str, Cell]:
        """Return the ghost inputs of the step, from the machine's outputs before and after it."""
        return self._ghosts.follow(step, was, outputs)


class _Ghosts:
    """The edge really passed when the amplitude changed, and the true number of sections below an end that runs up."""

    def __init__(self, map_host: MapHost) -> None:
        self._sections = map_host.sections
        self._truth_mm: int | None = None
        self._edge_nm, self._count, self._real = 0, 0, False

    def begin(self, truth_mm: int) -> None:
        """Set the place of the end before the first step."""
        self._truth_mm = truth_mm

    def follow(
        self, step: Mapping[str, Cell], was: Mapping[str, Value], outputs: Mapping[str, Value]
    ) -> dict[str, Cell]:
        """Return the ghost inputs of one step."""
        truth = int(step["truth_mm"])
        run = 0 if self._truth_mm is None else truth - self._truth_mm
        self._truth_mm = truth
        if outputs["in_section"] != was["in_section"]:
            self._passes(truth, bool(outputs["in_section"]))
        elif not outputs["in_section"] and self._unseen(truth):
            self._count += 1
        if step["reference_accepted"]:
            self._count = int(step["reference_count"])
        return dict(zip(GHOSTS, (run * NM_PER_MM, self._edge_nm, self._count, self._real), strict=True))

    def _passes(self, truth_mm: int, enters: bool) -> None:
        edges = [(edge, number) for number, one in enumerate(self._sections, 1) for edge in (one.low_mm, one.high_mm)]
        edge, number = min(edges, key=lambda one: abs(one[0] - truth_mm))
        if enters:
            self._real = abs(edge - truth_mm) <= _REAL_MM
            self._count = number if self._real else self._count
        self._edge_nm = (edge if self._real else truth_mm) * NM_PER_MM

    def _unseen(self, truth_mm: int) -> bool:
        """Return the condition that a section lies behind that was not noticed."""
        return sum(one.high_mm + _REAL_MM < truth_mm for one in self._sections) > self._count


_REAL_MM = 100_000
"A change of the amplitude that lies farther from any section is a false one."


def steps_of(
    scene: Scene,
    moments: Sequence[Moment],
    followed: Followed,
    *,
    config: FibreConfig | None = None,
    ghosts: bool = True,
) -> Steps:
    """Return the steps of the fibre machine; `ghosts=False` if the detector exceeds its bounds, as with a drifting index."""
    host = EndHost(scene, followed, config)
    code = on_board((config or FibreConfig()).model_dump_json())
    state, steps = code.first(), Steps()
    for moment in moments:
        was = code.named_outputs(state)
        step = host.heard(_the_only(moment), moment, was)
        state, _ = code.step(state, code.read({name: cell for name, cell in step.items() if name != "truth_mm"}))
        truth = host.ghosts(step, was, code.named_outputs(state)) if ghosts else {}
        steps.append({**step, **truth})
    return steps


def _the_only(moment: Moment) -> TrainSeen | None:
    """Return the only pattern, in scenes with a single train."""
    return moment.trains[0] if len(moment.trains) == 1 else None
