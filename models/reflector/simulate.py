"""Simulated radar frames, odometer and balises as step streams of the reflector machine, its ghosts included.

The map is simulated too: its next reflector is the one ahead of the reported position, so each stream is made step by step with
the machine running. A stream contains the ghosts: the interpreter checks on it that the assumption holds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import NM_PER_MM, PPM_PER_ONE
from safeloc.models.reflector import machine
from safeloc.models.reflector.step_inputs import completed
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation import sensors
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from safeloc.simulation.sensors import Distances, measure

_CDB_A_DOUBLING = 1_200
"""Range law: 12 dB less for each doubling of range."""
Steps = list[dict[str, Cell]]
NOWHERE = "NONE"


@dataclass(frozen=True)
class Reflector:
    """A reflector of the line; lengths in mm along the route.

    clear_mm  distance to the nearest other one of its model on any track; None: computed from the reflectors of this route
    """

    position_mm: int
    model: str
    view_from_mm: int = 120_000
    view_to_mm: int = 5_000
    clear_mm: int | None = None


@dataclass(frozen=True)
class Balise:
    """A balise; `reference`: its first reflector serves the self-test."""

    identity: int
    position_mm: int
    accuracy_mm: int = 1_000
    reference: bool = True
    search_from_mm: int | None = None


@dataclass(frozen=True)
class Route:
    """Balises and reflectors along one route, on the map and on the track.

    missing  positions of reflectors that are on the map, but not on the track
    beside   reflectors of other tracks that the radar sees from this one, at their places along this route
    """

    balises: tuple[Balise, ...]
    reflectors: tuple[Reflector, ...]
    missing: frozenset[int] = frozenset()
    beside: tuple[Reflector, ...] = ()

    def clear_mm(self, one: Reflector) -> int:
        """Return the distance to the nearest other reflector of the same model; the whole line's length if there is none."""
        if one.clear_mm is not None:
            return one.clear_mm
        others = [abs(other.position_mm - one.position_mm) for other in self.reflectors
                  if other is not one and other.model == one.model]  # fmt: skip
        return min(others, default=1_000_000)

    def ahead(self, position_mm: int) -> Reflector | None:
        """Return the first reflector beyond a position."""
        return min((r for r in self.reflectors if r.position_mm > position_mm), key=_position, default=None)


def _position(one: Reflector) -> int:
    return one.position_mm


FIGURE_1 = Route((Balise(106, 100_000),), (Reflector(180_000, "A", 100_000), Reflector(600_000, "B", 150_000)))
"""Source fig. 1, 100 m from the start: balise 106, reflectors 109 (model A) and 111 (model B)."""
FIGURE_2 = Route(
    (Balise(202, 100_000),),
    (Reflector(180_000, "A", 100_000), Reflector(360_000, "B"), Reflector(410_000, "C")),
)
"""Source fig. 2, 100 m from the start: balise 202, reflector 204, and 205 and 208 of the stop points 207 and 210."""
STOPS_MM = (350_000, 400_000)
"""Places of end A at the stop points 207 and 210: 10 m before their reflectors."""


KINDS = Kinds(
    "the radar",
    {
        **plain("pause", "blind", "weak"),
        "shift": {"by_mm": 0},
        "drift": {"by_mm": 0},
        "scale": {"by_ppm": 0},
        "decoy": {"by_mm": 0, "model": "A"},
    },
)
"""Of the only radar, in cycles.

pause     no radar frames                 blind   frames without any reflector
weak      all echoes 20 dB weaker         shift   the radar measures `by_mm` too far
drift     the radar's error grows by `by_mm` every cycle, as long as it lasts
scale     the radar measures `by_ppm` of the range too far
decoy     a strong echo of model `model` at `by_mm` ahead (breaks the law on clutter)
"""


@dataclass(frozen=True)
class Scene:
    """The conditions of one run: `disturbances` of the radar (`KINDS`), `sensor_faults` of the odometer `wheel`.

    The assumption still holds with a drop-out, with a shift of the radar from the first cycle to the last, and with a drift and
    a scale within the figures of the configuration.
    """

    route: Route = FIGURE_1
    error_mm: int = 200
    clutter: float = 0.3
    pauses: float = 0.02
    dropout: float = 0.005
    disturbances: tuple[Fault, ...] = field(default=())
    sensor_faults: tuple[Fault, ...] = ()


def simulate(
    config: ReflectorConfig,
    *,
    seed: int,
    scene: Scene | None = None,
    legs: Sequence[Leg] | None = None,
    motion: Motion | None = None,
    measured: Distances | None = None,
) -> Steps:
    """Return a run as steps: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    legs, motion  the vehicle's movement, from 0 on; 20 m/s and a stop beyond fig. 1 by default
    measured      distances of an odometer that other machines read as well, with its faults
    """
    scene, rng = scene or Scene(), np.random.default_rng(seed)
    if motion is None:
        vehicle = VehicleConfig(max_speed_mm_s=int(config.max_speed_mm_s * 0.9))
        motion = move(vehicle, legs or [Leg(20_000, 45), Leg(0, 25)], config.period_ms)
    sensors.KINDS.require(scene.sensor_faults, places=["wheel"], length=len(motion.position_nm))
    KINDS.require(scene.disturbances, places=[""], length=len(motion.position_nm))
    odometer = measured or measure(
        "wheel", motion, config.odometer, rng, dropout=scene.dropout, faults=scene.sensor_faults
    )
    return _Run(config, scene, motion, odometer, rng).steps()


@lru_cache(maxsize=8)
def _on_board(config: str) -> Compiled:
    """Return the machine without its world, cached for further runs with the same configuration (JSON)."""
    return compile_system(without_ghosts(lower(machine(ReflectorConfig.model_validate_json(config)))))


def next_on_map(route: Route, reported: Mapping[str, Value], passed_mm: int | None) -> dict[str, Cell]:
    """Return the map's next reflector: beyond the balise that was passed, else the target, else the reported position.

    reported  outputs of the machine after the last step
    """
    if passed_mm is None and not reported["valid"]:
        return {}
    sighted = reported["reflector_model"] != 0
    here = reported["reflector_position_mm"] if sighted else reported["position_mm"] - reported["margin_below_mm"]
    found = route.ahead(int(here) if passed_mm is None else passed_mm)
    if found is None:
        return {}
    return {
        "next_position_mm": found.position_mm,
        "next_model": found.model,
        "next_view_from_mm": found.view_from_mm,
        "next_view_to_mm": found.view_to_mm,
        "next_clear_mm": route.clear_mm(found),
    }


class _Run:
    """One run, cycle by cycle, with the machine in the loop: its reports decide the map's answers."""

    def __init__(
        self, config: ReflectorConfig, scene: Scene, motion: Motion, odometer: Distances, rng: np.random.Generator
    ) -> None:
        self._config, self._scene, self._motion, self._odometer, self._rng = config, scene, motion, odometer, rng
        self._radar = Radar(config, scene, rng)
        self._code: Compiled = _on_board(config.model_dump_json())
        self._state = self._code.first()
        self._wander = 0

    def steps(self) -> Steps:
        """Return all cycles."""
        return [self._step(cycle) for cycle in range(len(self._motion.position_nm))]

    def _step(self, cycle: int) -> dict[str, Cell]:
        before = self._motion.start_nm if cycle == 0 else int(self._motion.position_nm[cycle - 1])
        now = int(self._motion.position_nm[cycle])
        reported = self._measured(cycle)
        balise = self._passed(before, now)
        if balise is not None:
            reported |= self._balise(balise, now)
        reported |= self._map(balise)
        reported |= self._radar.frame(cycle, now - before, now)
        reported = completed(self._config, reported)
        reported = {
            **self._radar.no_origins(), **reported, "next_radar_bias_nm": self._radar.bias_mm(cycle) * NM_PER_MM,
        }  # fmt: skip
        own = {name: value for name, value in reported.items() if not _is_ghost(name) and name != "next_radar_bias_nm"}
        self._state, _ = self._code.step(self._state, self._code.read(own))
        ghosts = {"true_step_nm": now - before, "next_wander_nm": self._wander, "truth_mm": now // NM_PER_MM}
        return {**reported, **ghosts}

    def _measured(self, cycle: int) -> dict[str, Cell]:
        inputs: dict[str, Cell] = {"step_more_nm": self._odometer.more(cycle)} if self._config.checked_distance else {}
        if not self._odometer.present[cycle]:
            return inputs
        self._wander = int(self._odometer.wander_nm[cycle])
        return {**inputs, "step_mm": int(self._odometer.step_mm[cycle])}

    def _passed(self, before: int, now: int) -> Balise | None:
        low, high = sorted((before, now))
        return next((b for b in self._scene.route.balises if low < b.position_mm * NM_PER_MM <= high), None)

    def _balise(self, balise: Balise, now: int) -> dict[str, Cell]:
        since = round(now / NM_PER_MM) - balise.position_mm + int(self._rng.uniform(-0.8, 0.8) * balise.accuracy_mm)
        limit = self._config.max_step_mm
        inputs = {
            "balise": balise.identity,
            "balise_position_mm": balise.position_mm,
            "balise_accuracy_mm": balise.accuracy_mm,
            "balise_since_mm": max(-limit, min(limit, since)),
        }
        search = {} if balise.search_from_mm is None else {"balise_search_from_mm": balise.search_from_mm}
        return {**inputs, **search}

    def _map(self, balise: Balise | None) -> dict[str, Cell]:
        """Return the map's next reflector: beyond the balise, the target, or the reported position."""
        out, route = self._code.named_outputs(self._state), self._scene.route
        found = next_on_map(route, out, None if balise is None else balise.position_mm)
        reference: dict[str, Cell] = {}
        if balise and balise.reference and found:
            reference = {"next_reference_mm": int(found["next_position_mm"]) - balise.position_mm}
        return {**found, **reference}


# ------------------------------------------------------------------ radar


class Radar:
    """The radar of one run, and what it meets along the route."""

    def __init__(self, config: ReflectorConfig, scene: Scene, rng: np.random.Generator) -> None:
        self._config, self._scene, self._rng = config, scene, rng

    def no_origins(self) -> dict[str, Cell]:
        """Return the ghosts of slots without an echo."""
        slots = range(1, self._config.echo_slots + 1)
        real: dict[str, Cell] = {f"echo_{number}_from_reflector": False for number in slots}
        wrong: dict[str, Cell] = {f"echo_{number}_scaled_nm": 0 for number in slots}
        return {**real, **{f"echo_{number}_origin_nm": 0 for number in slots}, **wrong}

    def frame(self, cycle: int, step_nm: int, now: int) -> dict[str, Cell]:
        """Return the frame of a cycle that the vehicle ends at `now`, with the echoes' ghosts."""
        if self._rng.random() < self._scene.pauses or self._hit("pause", cycle):
            return {"frame_present": False}
        share = self._config.frame_latency_ms / self._config.period_ms * float(self._rng.uniform(0, 0.8))
        at_frame = now - int(step_nm * share)
        echoes = [*self._reflected(cycle, at_frame), *self._decoys(cycle), *self._clutter(at_frame)]
        values: dict[str, Cell] = {"frame_present": True}
        for number, echo in enumerate(echoes[: self._config.echo_slots], 1):
            values |= {f"echo_{number}_{name}": value for name, value in echo.items()}
        return values

    def _hit(self, kind: str, cycle: int) -> Fault | None:
        return next((one for one in self._scene.disturbances if one.kind == kind and one.active(cycle)), None)

    def _reflected(self, cycle: int, at_frame: int) -> list[dict[str, Cell]]:
        """Return the echoes of the reflectors ahead, the nearest first."""
        if self._hit("blind", cycle):
            return []
        seen = []
        for one in sorted((*self._scene.route.reflectors, *self._scene.route.beside), key=_position):
            range_mm = round(one.position_mm - at_frame / NM_PER_MM) + self._config.radar_offset_mm
            if one.position_mm not in self._scene.route.missing and one.view_to_mm <= range_mm < 2 * one.view_from_mm:
                seen.append(self._echo(one, range_mm, cycle))
        return seen

    def _echo(self, one: Reflector, range_mm: int, cycle: int) -> dict[str, Cell]:
        noise = int(self._rng.uniform(-0.8, 0.8) * (self._scene.error_mm - 1))
        scaled, most = self._scaled_mm(cycle, range_mm), self._config.range_limit_mm
        off = self.bias_mm(cycle) + scaled + noise
        weaker = 2_000 if self._hit("weak", cycle) else 0
        return {
            "range_mm": max(0, min(most, range_mm + off)),
            "error_mm": self._scene.error_mm,
            "model": one.model,
            "intensity_cdb": intensity_cdb(range_mm, one.view_from_mm, self._config.minimum_intensity_cdb) - weaker,
            "lateral_mm": 3_000 + int(self._rng.uniform(-100, 100)),
            "from_reflector": True,
            "origin_nm": one.position_mm * NM_PER_MM,
            "scaled_nm": scaled * NM_PER_MM,
        }

    def bias_mm(self, cycle: int) -> int:
        """Return by how much the radar measures every range too long, mm."""
        shift, drift = self._hit("shift", cycle), self._hit("drift", cycle)
        shifted = KINDS.figure(shift, "by_mm") if shift else 0
        return int(shifted + (KINDS.figure(drift, "by_mm") * (cycle - drift.begin + 1) if drift else 0))

    def _scaled_mm(self, cycle: int, range_mm: int) -> int:
        """Return by how much the radar measures this range too long in proportion, mm."""
        scale = self._hit("scale", cycle)
        return int(range_mm * KINDS.figure(scale, "by_ppm")) // PPM_PER_ONE if scale else 0

    def _decoys(self, cycle: int) -> list[dict[str, Cell]]:
        decoy = self._hit("decoy", cycle)
        return [] if decoy is None else [_thing(KINDS.figure(decoy, "by_mm"), KINDS.figure(decoy, "model"), -5_000)]

    def _clutter(self, at_frame: int) -> list[dict[str, Cell]]:
        """Return strong echoes of no model, and echoes with a reflector's signature that are too weak."""
        if self._rng.random() >= self._scene.clutter:
            return []
        range_mm = int(self._rng.uniform(2_000, 150_000))
        if self._rng.random() < 0.5:
            return [_thing(range_mm, NOWHERE, -4_000)]
        return [_thing(range_mm, "AB"[at_frame % 2], self._config.minimum_intensity_cdb - 1)]


def intensity_cdb(range_mm: int, view_from_mm: int, minimum_cdb: int) -> int:
    """Return the intensity: the minimum where the view zone begins, and 12 dB more for each halving of the range."""
    return minimum_cdb + math.floor(_CDB_A_DOUBLING * math.log2(view_from_mm / max(1, range_mm)))


def _thing(range_mm: int, model: str, intensity: int) -> dict[str, Cell]:
    return {
        "range_mm": range_mm,
        "error_mm": 200,
        "model": model,
        "intensity_cdb": intensity,
        "lateral_mm": -4_000,
        "from_reflector": False,
        "origin_nm": 0,
        "scaled_nm": 0,
    }


def _is_ghost(name: str) -> bool:
    return name.endswith(("from_reflector", "origin_nm", "scaled_nm"))


def board(step: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return a simulated step without ghosts and remarks, as the vehicle itself gets it."""
    left_out = ("true_step_nm", "next_wander_nm", "next_radar_bias_nm", "truth_mm")
    return {name: value for name, value in step.items() if not _is_ghost(name) and name not in left_out}


def outputs_along(config: ReflectorConfig, stream: Sequence[Mapping[str, Cell]]) -> list[Mapping[str, Value]]:
    """Return the outputs of the machine on board after each step of a simulated stream."""
    code = _on_board(config.model_dump_json())
    state, outputs = code.first(), list[Mapping[str, Value]]()
    for record in stream:
        state, _ = code.step(state, code.read(board(record)))
        outputs.append(code.named_outputs(state))
    return outputs


def lawful(step: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return a simulated step with its ghosts, without the remark."""
    return {name: value for name, value in step.items() if name != "truth_mm"}


# ------------------------------------------------------------------ motion to a stop


def stopping(period_ms: int, moves: Sequence[tuple[int, int, int, float]]) -> Motion:
    """Return a motion made of moves, each from standstill to standstill: distance (mm, negative: backwards), top speed (mm/s),
    acceleration and brake (mm/s2), and the time it then stands (s). It begins at 0."""
    period = period_ms / 1_000
    speeds: list[float] = []
    place = 0.0
    places: list[float] = []
    for distance, top, rate, stand in moves:
        for share, speed in _trapezoid(abs(distance), top, rate, period):
            places.append(place + math.copysign(share, distance))
            speeds.append(math.copysign(speed, distance))
        place += distance
        rest = max(1, round(stand / period))
        places += [place] * rest
        speeds += [0.0] * rest
    position = np.rint(np.array(places) * NM_PER_MM).astype(np.int64)
    return Motion(period_ms, position, np.array(speeds), 0)


def _trapezoid(distance: int, top: int, rate: int, period: float) -> list[tuple[float, float]]:
    """Return distance and speed at the end of each cycle: speed up, run, brake."""
    top_speed = min(float(top), math.sqrt(distance * rate))
    ramp = top_speed / rate
    cruise = (distance - top_speed * ramp) / top_speed
    made = []
    for number in range(1, math.ceil((2 * ramp + cruise) / period)):
        t = number * period
        left = 2 * ramp + cruise - t
        if t < ramp:
            made.append((rate * t * t / 2, rate * t))
        elif left > ramp:
            made.append((rate * ramp * ramp / 2 + top_speed * (t - ramp), top_speed))
        else:
            made.append((distance - rate * left * left / 2, rate * left))
    return made
