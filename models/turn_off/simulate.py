"""Simulated runs over switches as step streams of the turn-off machine, its ghosts included.

The reflector machine, on a simulated run, reports the position and whether it measures the reflector behind a switch. This
module adds the image's lateral motion: none before a switch; beyond it none, or growing to the other side.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.reflector.simulate import Scene, outputs_along
from safeloc.models.reflector.simulate import simulate as simulate_reflectors
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.turn_off import TurnOffConfig, machine
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.motion import Motion

Steps = list[dict[str, Cell]]
OTHER = {"STRAIGHT": "LEFT", "LEFT": "STRAIGHT", "RIGHT": "STRAIGHT"}
"""Course of a movement authority that sends the vehicle the other way."""


@dataclass(frozen=True)
class SwitchAhead:
    """A facing switch on the way, mm along it: its place, the course taken, and the first reflector behind it.

    lateral_mm  lateral place of the reflector's image before the switch, positive to the left
    """

    position_mm: int
    course: str
    reflector_mm: int
    lateral_mm: int = -2_500


def simulate(
    config: TurnOffConfig,
    source: ReflectorConfig,
    scene: Scene,
    switches: Sequence[SwitchAhead],
    motion: Motion,
    *,
    seed: int,
    wrong_authority: bool = False,
) -> Steps:
    """Return a run as steps: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    wrong_authority  map and movement authority name another course at every switch than the one taken
    """
    seen = outputs_along(source, simulate_reflectors(source, seed=seed, scene=scene, motion=motion))
    run = _Run(config, switches, random.Random(seed), wrong_authority)
    return [run.step(int(position), one) for position, one in zip(motion.position_nm, seen, strict=True)]


@lru_cache(maxsize=8)
def _on_board(config: str) -> Compiled:
    """Return the machine without its world, cached for further runs with the same configuration (JSON)."""
    return compile_system(without_ghosts(lower(machine(TurnOffConfig.model_validate_json(config)))))


class _Run:
    """A run under way, with the machine on board: the switch that it watches decides which one the map gives next."""

    def __init__(
        self, config: TurnOffConfig, switches: Sequence[SwitchAhead], rng: random.Random, wrong_authority: bool
    ) -> None:
        self._config, self._switches, self._rng = config, {one.position_mm: one for one in switches}, rng
        self._wrong_authority = wrong_authority
        self._board: Compiled = _on_board(config.model_dump_json())
        self._state = self._board.first()

    def step(self, truth_nm: int, reported: Mapping[str, Value]) -> dict[str, Cell]:
        """Return the inputs and ghosts of one cycle, and run it in the machine on board."""
        low, high = self._interval(reported)
        watched = self._switches.get(self._here())
        ahead = self._ahead(high)
        meant = ahead if ahead is not None and _measures(reported, ahead) else watched
        measured = meant is not None and _measures(reported, meant)
        shift = 0 if watched is None else shift_mm(self._config, watched, truth_nm)
        place = 0 if meant is None else meant.lateral_mm
        inputs: dict[str, Cell] = {
            "reflector_measured": measured,
            "lateral_mm": place + (shift if meant is watched else 0) + self._noise_mm() if measured else 0,
            "position_low_mm": low,
            "position_high_mm": high,
            "authorised_course": "UNDECIDED" if meant is None else self._authorised(meant.course),
        }
        if measured and meant is ahead and ahead is not None:
            inputs["switch_position_mm"] = ahead.position_mm
        self._state, _ = self._board.step(self._state, self._board.read(inputs))
        ghosts: dict[str, Cell] = {
            "next_true_course": "STRAIGHT" if meant is None else meant.course,
            "next_true_lateral_mm": place,
            "true_shift_mm": shift,
        }
        return {**inputs, **ghosts, "truth_mm": truth_nm // NM_PER_MM}

    def _interval(self, reported: Mapping[str, Value]) -> tuple[int, int]:
        """Return the reported interval; the whole line while nothing is reported."""
        limit = self._config.position_limit_mm
        if not reported["valid"]:
            return -limit, limit
        position = int(reported["position_mm"])
        return position - int(reported["margin_below_mm"]), position + int(reported["margin_above_mm"])

    def _here(self) -> int:
        return int(dict(zip(self._board.state_names, self._state, strict=True))["switch_here_mm"])

    def _ahead(self, high_mm: int) -> SwitchAhead | None:
        """Return the next switch that surely lies ahead."""
        places = [place for place in self._switches if place > high_mm]
        return self._switches[min(places)] if places else None

    def _noise_mm(self) -> int:
        return int(self._rng.uniform(-0.45, 0.45) * self._config.lateral_error_mm)

    def _authorised(self, course: str) -> str:
        return OTHER[course] if self._wrong_authority else course


def _measures(reported: Mapping[str, Value], switch: SwitchAhead) -> bool:
    """Return whether the reflector machine measures the reflector behind the switch."""
    return bool(reported["precise"]) and reported["reflector_position_mm"] == switch.reflector_mm


def shift_mm(config: TurnOffConfig, switch: SwitchAhead, truth_nm: int) -> int:
    """Return the motion of the image: growing from the switch on, up to a fifth more than the least shift where it must show."""
    beyond = truth_nm // NM_PER_MM - switch.position_mm
    if beyond <= 0 or switch.course == "STRAIGHT":
        return 0
    share = min(1.0, beyond / max(1.0, 0.8 * config.decide_mm))
    size = round(1.2 * config.least_shift_mm * share)
    return -size if switch.course == "LEFT" else size
