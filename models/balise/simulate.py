"""Simulated balise groups, linking and odometer as step streams of the balise machine, its ghosts included.

The map is simulated too: it announces groups when the machine asks for them, so each stream is made step by step
together with the machine as it runs on board. Because a stream contains the ghosts, the interpreter can check on it
that it obeys the assumption.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.errors import InputError
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise import machine
from safeloc.models.balise.groups import Group, Orientation, Reaction, announcement, telegram
from safeloc.models.balise.variables import BaliseConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation import sensors
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move, plan
from safeloc.simulation.sensors import Distances, measure

_DISPLACED_MM = 40_000
"""Displacement of a group beyond twice the tolerance and twice its accuracy."""
Steps = list[dict[str, Cell]]
KINDS = Kinds(
    "a balise group",
    plain(
        "missed", "corrupted", "incomplete", "wrong way", "early", "late", "duplicate", "stale", "malformed",
        "other identity",
    ),
)  # fmt: skip
"""Each at one group, by its identity, for the whole run. `early` and `late` displace the group farther than any interval reaches."""


@dataclass(frozen=True)
class RouteSet:
    """A route set in `cycle`: from then on the map announces these groups instead, and linking begins anew with REPLACE."""

    cycle: int
    groups: Sequence[Group]


@dataclass(frozen=True)
class Passage:
    """The antenna's passage over one group: the time at balise 1 (ms since the start), and the places of front end and balise 1 (nm)."""

    group: Group
    time_ms: float
    front_nm: int
    spot_nm: int
    fault: str = ""


def vehicle_of(config: BaliseConfig) -> VehicleConfig:
    """Return a vehicle that stays within the configured limits."""
    return VehicleConfig(max_speed_mm_s=max(100, int(config.max_speed_mm_s * 0.9)))


def line(first_mm: int = 100_000, spacing_mm: int = 150_000, count: int = 60) -> list[Group]:
    """Return groups a fixed distance apart: one to four balises, both orientations, with and without an accuracy of their own."""
    reactions: tuple[Reaction, ...] = ("SERVICE_BRAKE", "TRAIN_TRIP", "NONE")
    groups = []
    for number in range(count):
        accuracy = None if number % 5 == 4 else 1_000 + 500 * (number % 4)
        orientation: Orientation = "REVERSE" if number % 3 == 2 else "NOMINAL"
        reflector = 80_000 if number % 4 == 0 else None
        search = None if reflector is None else 30_000
        groups.append(
            Group(
                number + 1, first_mm + number * spacing_mm, 1 + number % 4, orientation, accuracy,
                reactions[number % 3], True, reflector, search,
            )
        )  # fmt: skip
    return groups


def simulate(
    config: BaliseConfig,
    *,
    seed: int,
    seconds: float = 300.0,
    groups: Sequence[Group] | None = None,
    routes: Sequence[RouteSet] = (),
    dropout: float = 0.01,
    missed: float = 0.03,
    foreign: float = 0.002,
    counted: float = 0.5,
    national_accuracy_mm: int | None = 5_000,
    legs: Sequence[Leg] | None = None,
    motion: Motion | None = None,
    faults: Sequence[Fault] = (),
    sensor_faults: Sequence[Fault] = (),
    measured: Distances | None = None,
) -> Steps:
    """Return one run as steps: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    groups   those that the vehicle passes
    routes   the groups that the map announces from a cycle on, by default the same ones; the map knows no place of a group
             that is not on the route set last
    missed   the share of groups that are not read
    foreign  the share of cycles without another telegram that bring one of another track
    counted  the share of readings with a latched counter
    national_accuracy_mm  received in the first cycle; None: the default applies
    motion   the vehicle's run; without it, the run over `legs`, or over a random service
    faults   named faults of groups (`KINDS`); none of them breaks the assumption
    sensor_faults  named faults of `odometer`; while one is active the assumption may be broken
    measured  the odometer's distances, if other machines use the same odometer; they contain its faults already
    InputError for a fault of a group that the line does not have, and for two routes that are set in one cycle.
    """
    rng = np.random.default_rng(seed)
    known = list(groups) if groups is not None else line()
    vehicle = vehicle_of(config)
    if motion is None:
        motion = move(vehicle, legs or plan(vehicle, seconds, rng, reversals=False), config.period_ms)
    sensors.KINDS.require(sensor_faults, places=["odometer"], length=len(motion.position_nm))
    KINDS.require(faults, places=[group.identity for group in known], timed=False)
    _check_routes(routes)
    distances = measured or measure("odometer", motion, config.odometer, rng, dropout=dropout, faults=sensor_faults)
    in_force = config.default_accuracy_mm if national_accuracy_mm is None else national_accuracy_mm
    spots = _spots(config, known, in_force, rng, faults)
    passages = list(_passages(motion, spots, config.period_ms, rng, missed))
    ahead = {0: known} | {one.cycle: one.groups for one in routes}
    run = _Run(config, motion, distances, ahead, rng, foreign, national_accuracy_mm, counted)
    return [run.step(number, passages) for number in range(len(motion.position_nm))]


def _check_routes(routes: Sequence[RouteSet]) -> None:
    cycles = [one.cycle for one in routes]
    if len(set(cycles)) < len(cycles):
        raise InputError(f"routes are set in cycles {cycles}: only one can be set in a cycle; leave the others out.")


def _spots(
    config: BaliseConfig,
    groups: Sequence[Group],
    national_mm: int,
    rng: np.random.Generator,
    faults: Sequence[Fault],
) -> list[Passage]:
    """Return the true places of balise 1 and of the front end at each reading, with up to nine tenths of the permitted errors."""
    kinds = {fault.where: fault.kind for fault in faults}
    signs = {"early": -1, "late": 1}
    spots = []
    for group in groups:
        fault = kinds.get(group.identity, "")
        accuracy = national_mm if group.accuracy_mm is None else min(national_mm, group.accuracy_mm)
        error, detection = rng.uniform(-0.9, 0.9) * accuracy, rng.uniform(-0.9, 0.9) * config.detection_mm
        shift = signs.get(fault, 0) * _displaced_mm(config, group, national_mm)
        spot = int((group.place_mm + shift + error) * NM_PER_MM)
        front = spot + int((config.antenna_mm + detection) * NM_PER_MM)
        spots.append(Passage(group, 0.0, front, spot, fault))
    return spots


def _displaced_mm(config: BaliseConfig, group: Group, national_mm: int) -> int:
    """Return the distance of a displaced group from its place on the map."""
    return 2 * (config.tolerance_mm + max(national_mm, group.accuracy_mm or 0)) + _DISPLACED_MM


def _passages(
    motion: Motion, spots: Sequence[Passage], period_ms: int, rng: np.random.Generator, missed: float
) -> Iterator[Passage]:
    """Yield every passage over a group, cycle by cycle."""
    before = motion.start_nm
    for number, front in enumerate(motion.position_nm):
        after = int(front)
        for spot in spots:
            if before < spot.front_nm <= after:
                share = (spot.front_nm - before) / (after - before)
                lost = not spot.fault and rng.random() < missed
                yield replace(spot, time_ms=(number + share) * period_ms, fault="missed" if lost else spot.fault)
        before = after


@lru_cache(maxsize=8)
def _on_board(config: str) -> Compiled:
    """Return the machine without its world, compiled once for each configuration (JSON)."""
    return compile_system(without_ghosts(lower(machine(BaliseConfig.model_validate_json(config)))))


class _Run:
    """A run under way: the machine on board, the groups that the map still has to announce, and telegrams on their way."""

    def __init__(
        self, config: BaliseConfig, motion: Motion, distances: Distances, routes: Mapping[int, Sequence[Group]],
        rng: np.random.Generator, foreign: float, national_mm: int | None, counted: float,
    ) -> None:  # fmt: skip
        self._config, self._motion, self._distances, self._rng, self._foreign = config, motion, distances, rng, foreign
        self._counted = counted
        self._routes = routes
        self._board: Compiled = _on_board(config.model_dump_json())
        self._state = self._board.first()
        self._outputs: Mapping[str, Cell] = self._board.named_outputs(self._state)
        self._set_route(routes[0])
        self._replaces = False
        self._waiting: list[Passage] = []
        self._wander = 0
        self._national: dict[str, Cell] = {} if national_mm is None else {"national_accuracy_mm": national_mm}

    def step(self, number: int, passages: Sequence[Passage]) -> dict[str, Cell]:
        """Make the inputs of one cycle, run the machine on board with them, and return them with the ghosts."""
        if number and number in self._routes:
            self._set_route(self._routes[number])
        inputs: dict[str, Cell] = (
            self._odometer(number) | self._announcement() | (self._national if number == 0 else {})
        )
        begin = number * self._config.period_ms
        self._waiting += [p for p in passages if begin < p.time_ms <= begin + self._config.period_ms]
        telegram, ghosts = self._telegram(number)
        inputs |= telegram
        self._state, _ = self._board.step(self._state, self._board.read(inputs))
        self._outputs = self._board.named_outputs(self._state)
        truth = int(self._motion.position_nm[number])
        return {**inputs, **ghosts, "true_step_nm": int(self._motion.step_nm[number]),
                "odometer_next_wander_nm": self._wander, "truth_mm": truth // NM_PER_MM}  # fmt: skip

    def _odometer(self, number: int) -> dict[str, Cell]:
        inputs: dict[str, Cell] = (
            {"odometer_more_nm": self._distances.more(number)} if self._config.checked_distance else {}
        )
        self._wander = int(self._distances.wander_nm[number])
        if not self._distances.present[number]:
            return inputs
        return {**inputs, "odometer_mm": int(self._distances.step_mm[number])}

    def _set_route(self, groups: Sequence[Group]) -> None:
        """Let the map announce these groups from now on."""
        self._groups = sorted((group for group in groups if group.linked), key=lambda group: group.place_mm)
        self._placed = {group.identity for group in groups}
        self._announced_mm: int | None = None
        self._replaces = True

    def _announcement(self) -> dict[str, Cell]:
        """Return the announcement of the next group ahead: when the machine asks for it, or at once after a new route was set."""
        if not self._outputs["valid"]:
            self._announced_mm, self._replaces = None, False
            return {}
        replaces, self._replaces = self._replaces, False
        if not (replaces or self._outputs["wants_linking"]):
            return {}
        here = int(self._outputs["position_mm"]) + int(self._outputs["margin_above_mm"]) - self._config.antenna_mm
        beyond = here if self._announced_mm is None else self._announced_mm
        ahead = [group for group in self._groups if group.place_mm > beyond]
        if not ahead:
            return {"linking_order": "WITHDRAW"} if replaces else {}
        self._announced_mm = ahead[0].place_mm
        return announcement(ahead[0], order="REPLACE" if replaces else "ADD")

    def _telegram(self, number: int) -> tuple[dict[str, Cell], dict[str, Cell]]:
        """Return the oldest waiting telegram (one in a cycle) and its ghosts; without one, sometimes a telegram of another track."""
        while self._waiting:
            passage = self._waiting.pop(0)
            if passage.fault == "missed":
                continue
            if passage.fault == "duplicate":
                self._waiting.append(replace(passage, fault=""))
            read, true = self._read(passage, number)
            return _with_fault(read, passage.fault), true
        here = int(self._motion.position_nm[number]) - self._config.antenna_mm * NM_PER_MM
        quiet: dict[str, Cell] = {"read_place_nm": here, "true_since_nm": 0, "reading_wander_nm": 0}
        if self._rng.random() < self._foreign:
            return self._cross_talk(number), quiet
        return {}, quiet

    def _cross_talk(self, number: int) -> dict[str, Cell]:
        """Return a complete and undamaged telegram of another track: only its identity shows that."""
        identity = 900_000 + number % 1_000
        group = Group(identity, 0, 2, linked=bool(self._rng.random() < 0.8))
        return telegram(group, age_ms=int(self._rng.integers(0, self._config.period_ms)), place=False)

    def _read(self, passage: Passage, number: int) -> tuple[dict[str, Cell], dict[str, Cell]]:
        """Return the telegram and its ghosts; the age is rounded up, and the latched counter's error is part of the ghost's wander."""
        front = int(self._motion.position_nm[number])
        run = front - passage.front_nm
        age = int(np.ceil((number + 1) * self._config.period_ms - passage.time_ms))
        ghosts: dict[str, Cell] = {
            "read_place_nm": passage.spot_nm, "true_since_nm": run, "reading_wander_nm": 0
        }  # fmt: skip
        read = telegram(passage.group, age_ms=age, place=passage.group.identity in self._placed)
        half = self._config.odometer.wander_nm
        since = round(run / NM_PER_MM + self._rng.uniform(-0.5, 0.5) * min(half / NM_PER_MM, 20))
        wander = self._wander - (run - since * NM_PER_MM)
        if self._rng.random() < self._counted and abs(wander) <= half:
            read["telegram_since_mm"] = since
            ghosts["reading_wander_nm"] = wander
        return read, ghosts


def _with_fault(read: dict[str, Cell], fault: str) -> dict[str, Cell]:
    match fault:
        case "corrupted":
            return {**read, "telegram_check": "FAILED", "telegram_position_mm": 12_345}
        case "incomplete":
            return _incomplete(read)
        case "wrong way":
            return {**read, "telegram_first": read["telegram_last"], "telegram_last": read["telegram_first"]}
        case "stale":
            return {**read, "telegram_age_ms": int(read["telegram_age_ms"]) + 5_000}
        case "malformed":
            return {name: value for name, value in read.items() if name != "telegram_age_ms"}
        case "other identity":
            return {**read, "telegram_group": 900_001}
        case _:
            return read  # other kinds change the time, place or number of passages, not the telegram


def _incomplete(read: dict[str, Cell]) -> dict[str, Cell]:
    """Return the telegram with only balise 1 of the group read."""
    total = max(2, int(read["telegram_total"]))
    return {**read, "telegram_total": total, "telegram_read": 1, "telegram_first": 1, "telegram_last": 1}
