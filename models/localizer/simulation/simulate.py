"""A vehicle's journey with all its ways of locating, as one step stream of the localizer, its ghosts included.

All sources measure the same motion, and those that use the vehicle's odometer get the same distances. The modules of odometry,
balises and reflectors simulate these sources; for satellites and the fibre, this module simulates the output of their front
ends. Faults have names (`KINDS`). A fault that breaks an assumption makes a stream without ghosts; there only the remark
`truth_mm` shows the truth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise import simulate as balise_streams
from safeloc.models.balise.groups import Group
from safeloc.models.balise.simulate import RouteSet
from safeloc.models.localizer import LocalizerConfig, compose_machines
from safeloc.models.localizer.simulation.junction import Junction
from safeloc.models.localizer.simulation.sky import signals, solution
from safeloc.models.motion.simulate import Measured, measured_by
from safeloc.models.motion.world import ODOMETER_LAWFUL
from safeloc.models.odometry import simulate as odometry_streams
from safeloc.models.reflector import simulate as reflector_streams
from safeloc.models.reflector.simulate import Scene
from safeloc.models.verification import VerificationConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move

Steps = list[dict[str, Cell]]
WIRED = (
    "odometer_mm", "odometer_more_nm", "step_mm", "step_more_nm", "truth_mm", "true_step_nm",
)  # fmt: skip
CHECKED = ("odometer_next_wander_nm", "next_wander_nm")
"""Ghosts that the machines share, in addition to `WIRED`, if a check unit lets the odometer's error law be proved."""
KINDS = Kinds(
    "a journey",
    plain(
        "odometer silent", "odometer slides", "satellites lost", "multipath", "spoofing", "fibre miscount", "fibre error",
        "downlink silent", "uplink silent", "radar blind", "radar shifted", "marker misplaced", "balise corrupted",
        "balise missed", "balise displaced", "other branch taken", "linking not replaced",
    ),
)  # fmt: skip
"""Faults act in a span of cycles; those of balises name the group. A miscount and the faults at the junction act once on a journey,
and a fault of a group acts for the whole journey, whatever their cycles."""
UNLAWFUL = ("odometer slides", "spoofing", "radar shifted", "marker misplaced")
"""Kinds that break an assumption of a source about its sensors; the others keep every assumption."""
SPOOFED_MM, SHIFTED_MM, BLOCK_CYCLES = 800, 60_000, 5
"""Shift of all solutions in a cycle of spoofing, mm; shift of the radar, mm; length of a fibre's block, cycles."""


PASSED_ON: Mapping[str, Mapping[str, Fault]] = {
    "motion": {"odometer silent": Fault("drop-out", "wheel"), "odometer slides": Fault("slide", "wheel")},
    "odometry": {"marker misplaced": Fault("misplaced", "front_marker", figures={"reach": 1})},
    "balise": {
        "balise corrupted": Fault("corrupted"),
        "balise missed": Fault("missed"),
        "balise displaced": Fault("late"),
    },
    "reflector": {"radar blind": Fault("blind"), "radar shifted": Fault("shift", figures={"by_mm": SHIFTED_MM})},
}
"""Machine -> fault of the journey -> fault of the machine's own simulation."""


@dataclass(frozen=True)
class Stretch:
    """A part of the line, mm."""

    begin_mm: int
    end_mm: int

    def holds(self, place_mm: int) -> bool:
        """Return whether a place, mm, lies in the stretch."""
        return self.begin_mm <= place_mm < self.end_mm


@dataclass(frozen=True)
class Journey:
    """A vehicle's run, its line and the faults on it.

    dark        stretches without satellites; elsewhere `satellites` are in view, as far as the receiver has channels
    fibre       the stretch with a fibre along the track, with an axle counter at its beginning
    groups      balise groups along the route that is set, those behind the junction included
    junction    the switch at which another branch leaves that route; there is no fibre along the branch
    """

    legs: Sequence[Leg]
    markers: Sequence[tuple[int, int]] = ()
    groups: Sequence[Group] = ()
    reflectors: reflector_streams.Route = field(default_factory=lambda: reflector_streams.Route((), ()))
    dark: Sequence[Stretch] = ()
    satellites: int = 16
    fibre: Stretch | None = None
    junction: Junction | None = None
    axles: int = 16
    length_mm: int = 60_000
    acceleration_mm_s2: int = 700
    troubles: Sequence[Fault] = ()

    @property
    def lawful(self) -> bool:
        """No fault breaks an assumption."""
        return not any(one.kind in UNLAWFUL for one in self.troubles)

    @property
    def astray(self) -> Junction | None:
        """The junction if the vehicle takes the other branch there than the route says, else None."""
        return self.junction if any(one.kind == "other branch taken" for one in self.troubles) else None

    @property
    def passed(self) -> list[Group]:
        """The groups that the vehicle passes."""
        return list(self.groups) if self.astray is None else self.astray.branched(self.groups)

    @property
    def announced(self) -> list[Group]:
        """The groups that linking announces in the end: behind the switch those of the other branch, if linking is not replaced."""
        stale = any(one.kind == "linking not replaced" for one in self.troubles)
        return self.junction.branched(self.groups) if stale and self.junction else list(self.groups)

    def undecided(self, place_mm: int) -> bool:
        """Return whether either branch is possible at a place, so that no satellite signal can be predicted."""
        return self.junction is not None and self.junction.undecided(place_mm, self.passed, self.announced)

    def trouble(self, kind: str, cycle: int) -> Fault | None:
        """Return the fault of a kind that acts in a cycle, if there is one."""
        return next((one for one in self.troubles if one.kind == kind and one.active(cycle)), None)


def simulate(config: LocalizerConfig, journey: Journey, *, seed: int) -> Steps:
    """Return the journey as steps: inputs, the ghosts if no fault breaks an assumption, and the remark `truth_mm`."""
    steps = with_truth(config, journey, seed=seed)
    if journey.lawful:
        return steps
    hidden = _ghosts(config.model_dump_json())
    return [{key: cell for key, cell in step.items() if key not in hidden} for step in steps]


def with_truth(config: LocalizerConfig, journey: Journey, *, seed: int) -> Steps:
    """Return the journey as steps with all ghosts: those of a journey whose faults break assumptions break their laws."""
    KINDS.require(journey.troubles)
    rng = np.random.default_rng(seed)
    motion = motion_of(config, journey)
    measured = _measured(config, journey, motion, rng)
    parts = [_common(motion, measured), _links(config, journey, len(motion.position_nm))]
    parts += [_SOURCES[name](config, journey, motion, measured, seed) for name in config.arbitration.sources]
    return [{key: cell for part in row for key, cell in part.items()} for row in zip(*parts, strict=True)]


@lru_cache(maxsize=8)
def _ghosts(config: str) -> frozenset[str]:
    """Return the names of the ghosts of a localizer with this configuration (JSON)."""
    system = compose_machines(LocalizerConfig.model_validate_json(config)).composition.system
    return frozenset(var.name for var in system.ghosts)


def first_state(config: LocalizerConfig, journey: Journey) -> dict[str, Value]:
    """Return first values of the open variables: place and speed of the vehicle, and its train."""
    motion = motion_of(config, journey)
    used: dict[str, Value] = {"truth_nm": motion.start_nm}
    if config.motion.check is not None:
        used |= {
            "odometer_wander_nm": 0, "motion.lawful_wander_nm": 0, "motion.lawful_unit": ODOMETER_LAWFUL.value
        }  # fmt: skip
    open_: dict[str, dict[str, Value]] = {
        "odometry": {"odometry.faulty_unit": 0} if config.odometry.single_fault_safe else {},
        "satellite": {"position.true_speed_um_s": int(_speeds_um_s(motion)[0])},
        "fibre": {"verification.true_axles": journey.axles, "verification.true_length_um": journey.length_mm * 1_000},
    }
    for name in config.arbitration.sources:
        used |= open_.get(name, {})
    return used


def motion_of(config: LocalizerConfig, journey: Journey) -> Motion:
    """Return the vehicle's run, which begins at place 0."""
    vehicle = VehicleConfig(
        max_speed_mm_s=int(config.motion.max_speed_mm_s * 0.9), acceleration_mm_s2=journey.acceleration_mm_s2,
        brake_mm_s2=journey.acceleration_mm_s2, length_mm=journey.length_mm,
    )  # fmt: skip
    return move(vehicle, journey.legs, config.motion.period_ms)


# ------------------------------------------------------------------ inputs that all sources share


def _measured(config: LocalizerConfig, journey: Journey, motion: Motion, rng: np.random.Generator) -> Measured:
    return measured_by("wheel", config.motion, motion, rng, _passed_on("motion", journey))


def _passed_on(machine: str, journey: Journey) -> list[Fault]:
    """Return the troubles of the journey as faults of the machine's own simulation."""
    known = PASSED_ON[machine]
    return [replace(known[one.kind], begin=one.begin, end=one.end) for one in journey.troubles if one.kind in known]


def _common(motion: Motion, measured: Measured) -> Steps:
    true, steps = motion.step_nm, list[dict[str, Cell]]()
    units = {"motion.odometer_mm": measured.odometer, "motion.check_mm": measured.check}
    for cycle, place in enumerate(motion.position_nm):
        step: dict[str, Cell] = {"true_step_nm": int(true[cycle]), "truth_mm": int(place) // NM_PER_MM}
        step |= {name: int(one.step_mm[cycle]) for name, one in units.items() if one and one.present[cycle]}
        if measured.check is not None:
            step["odometer_next_wander_nm"] = int(measured.odometer.wander_nm[cycle])
            step["motion.lawful_next_wander_nm"] = int(measured.odometer.wander_nm[cycle])
        steps.append(step)
    return steps


def _links(config: LocalizerConfig, journey: Journey, cycles: int) -> Steps:
    """Return the inputs of the radio links: every fifth cycle a report that arrives two cycles later; fibre reports arrive at once."""
    steps: Steps = []
    for cycle in range(cycles):
        silent = journey.trouble("uplink silent", cycle) is not None
        step: dict[str, Cell] = {
            "uplink.sent": cycle % BLOCK_CYCLES == 0, "uplink.arrived": cycle % BLOCK_CYCLES == 2 and not silent
        }  # fmt: skip
        if "fibre" in config.sources:
            step["downlink.arrived"] = journey.trouble("downlink silent", cycle) is None
        steps.append(step)
    return steps


def _named(machine: str, steps: Sequence[Mapping[str, Cell]], received: Sequence[str] = ()) -> Steps:
    """Return a machine's own steps under the names of the composition, without the inputs wired to other machines."""
    known = (*WIRED, *received)
    return [{f"{machine}.{key}": cell for key, cell in step.items() if key not in known} for step in steps]


def _units_received(config: LocalizerConfig) -> tuple[str, ...]:
    """Return odometry's inputs that are wired to the vehicle's own units."""
    first, second = (f"front_{unit.kind}_mm" for unit in (config.odometry.first_unit, config.odometry.second_unit))
    return (first,) if config.motion.check is None else (first, second)


def _check_inputs(measured: Measured) -> tuple[str, ...]:
    """Return the ghosts that all users of a checked odometer share; none without a check unit."""
    return CHECKED if measured.check is not None else ()


# ------------------------------------------------------------------ on-board sources with a simulation of their own


def _odometry(config: LocalizerConfig, journey: Journey, motion: Motion, measured: Measured, seed: int) -> Steps:
    return _named(
        "odometry",
        odometry_streams.simulate(
            config.odometry, seed=seed, motion=motion, markers=journey.markers, dropout=0, missed=0, foreign=0,
            faults=_passed_on("odometry", journey), first_unit=measured.odometer, second_unit=measured.check,
        ),
        _units_received(config),
    )  # fmt: skip


def _balise(config: LocalizerConfig, journey: Journey, motion: Motion, measured: Measured, seed: int) -> Steps:
    passed, known = journey.passed, PASSED_ON["balise"]
    met = {group.identity for group in passed}
    faults = [
        replace(known[one.kind], where=one.where) for one in journey.troubles if one.kind in known and one.where in met
    ]
    return _named(
        "balise",
        balise_streams.simulate(
            config.balise, seed=seed, motion=motion, groups=passed, routes=_routes(journey, motion), missed=0,
            foreign=0, faults=faults, measured=measured.reported,
        ),
        _check_inputs(measured),
    )  # fmt: skip


def _routes(journey: Journey, motion: Motion) -> list[RouteSet]:
    """Return linking for the other branch until the route is set, and for the route from then on, unless linking is not replaced."""
    if journey.junction is None:
        return []
    first = RouteSet(0, journey.junction.branched(journey.groups))
    reached = np.flatnonzero(motion.position_nm >= journey.junction.set_mm * NM_PER_MM)
    if not len(reached) or any(one.kind == "linking not replaced" for one in journey.troubles):
        return [first]
    return [first, RouteSet(int(reached[0]), journey.groups)]


def _reflector(config: LocalizerConfig, journey: Journey, motion: Motion, measured: Measured, seed: int) -> Steps:
    disturbed = tuple(_passed_on("reflector", journey))
    scene = Scene(journey.reflectors, pauses=0, dropout=0, disturbances=disturbed)
    return _named(
        "reflector",
        reflector_streams.simulate(config.reflector, seed=seed, scene=scene, motion=motion, measured=measured.reported),
        _check_inputs(measured),
    )


# ------------------------------------------------------------------ satellites: output of their front end


def _speeds_um_s(motion: Motion) -> NDArray[np.int64]:
    """Return the speed at the end of each cycle, the initial one first: the mean over the cycles before and after."""
    step = np.concatenate([motion.step_nm[:1], motion.step_nm, motion.step_nm[-1:]])
    return np.asarray((step[:-1] + step[1:]) // (2 * motion.period_ms), dtype=np.int64)


def _satellite(config: LocalizerConfig, journey: Journey, motion: Motion, _: Measured, seed: int) -> Steps:
    rng, speeds = np.random.default_rng(seed + 1), _speeds_um_s(motion)
    received, drawn, steps = 0, 0, list[dict[str, Cell]]()
    for cycle, place in enumerate(motion.position_nm):
        truth = int(place) // NM_PER_MM
        dark = any(one.holds(truth) for one in journey.dark) or journey.trouble("satellites lost", cycle) is not None
        missing = "TWO_PORTIONS" if journey.undecided(truth) else "NO_EPOCH"
        received = 0 if dark or missing == "TWO_PORTIONS" else received + 1
        drawn += SPOOFED_MM if journey.trouble("spoofing", cycle) else 0
        far = journey.trouble("multipath", cycle) is not None
        selection, speed = config.satellite.selection, int(speeds[cycle + 1])
        step = signals(selection, rng, journey.satellites, received, far)
        step |= solution(selection, rng, journey.satellites, received, far, truth + drawn, speed, missing)
        steps.append(step | {"position.next_speed_um_s": speed})
    return steps


# ------------------------------------------------------------------ the fibre: output of its front end and of the axle counter


def _fibre(config: LocalizerConfig, journey: Journey, motion: Motion, _: Measured, seed: int) -> Steps:
    rng, steps, before = np.random.default_rng(seed + 2), list[dict[str, Cell]](), False
    for cycle, place in enumerate(motion.position_nm):
        front = int(place) // NM_PER_MM
        away = journey.astray is not None and front >= journey.astray.switch_mm
        inside = journey.fibre is not None and journey.fibre.holds(front) and not away
        ghosts: dict[str, Cell] = {
            "next_true_axles": journey.axles, "next_true_length_um": journey.length_mm * 1_000
        }  # fmt: skip
        speed = int(motion.speed_mm_s[cycle])
        step = _record(journey, front, speed, due=inside and not before) | ghosts
        step |= _pattern(config.fibre, journey, rng, cycle, front, speed, inside)
        steps.append(step | {"train_leaves": before and not inside})
        before = inside
    return _named("verification", steps)


def _record(journey: Journey, front: int, speed: int, *, due: bool) -> dict[str, Cell]:
    """Return the report of the axle counter at the area's border, in the cycle in which the front passes it."""
    miscounts = any(one.kind == "fibre miscount" for one in journey.troubles)
    return {
        "reference_due": due, "reference_from": "AXLE_COUNTER" if due else "NOBODY", "record_sound": True,
        "record_axles": journey.axles + (2 if miscounts else 0), "record_length_low_mm": journey.length_mm - 2_000,
        "record_length_high_mm": journey.length_mm + 2_000, "record_speed_low_mm_s": speed - 300,
        "record_speed_high_mm_s": speed + 300, "record_place_low_mm": front - 5_000,
        "record_place_high_mm": front + 5_000, "record_age_cycles": 0,
    }  # fmt: skip


def _pattern(
    config: VerificationConfig,
    journey: Journey,
    rng: np.random.Generator,
    cycle: int,
    front: int,
    speed: int,
    inside: bool,
) -> dict[str, Cell]:
    """Return the features that the fibre determines in a block, every fifth cycle; nothing between them."""
    located = inside and cycle % BLOCK_CYCLES == 0
    step: dict[str, Cell] = {
        "associated": located, "fibre_located": located, "fibre_margin_above_mm": 12_000, "fibre_margin_below_mm": 12_000,
        "fibre_error": inside and journey.trouble("fibre error", cycle) is not None,
        "chain_tested": inside, "chain_failed": False,
    }  # fmt: skip
    if not located:
        return step
    seen: dict[str, Cell] = {
        "fibre_position_mm": front + int(rng.integers(-8_000, 8_000)),
        "fibre_speed_mm_s": speed + int(rng.integers(-300, 300)),
        "fibre_axles": journey.axles,
        "fibre_length_mm": journey.length_mm + int(rng.uniform(-0.4, 0.4) * config.length_tolerance_mm),
    }
    return step | seen


_SOURCES = {
    "odometry": _odometry,
    "balise": _balise,
    "reflector": _reflector,
    "satellite": _satellite,
    "fibre": _fibre,
}
