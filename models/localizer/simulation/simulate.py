"""A vehicle's journey with all its ways of locating, as one step stream of the localizer, its ghosts included.

It is one vehicle of `sources`: all sources measure the same motion, and those that use the vehicle's odometer get the same distances. The
modules of odometry, balises and reflectors simulate these sources; for satellites and the fibre, `front_ends` simulates the output of
their front ends. Faults have names (`KINDS`). A fault that breaks an assumption makes a stream without ghosts; there only the remark
`truth_mm` shows the truth.
"""

from __future__ import annotations

from functools import lru_cache

from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.units import NM_PER_MM
from safeloc.models.localizer import LocalizerConfig, compose_machines
from safeloc.models.localizer.simulation.columns import steps_of
from safeloc.models.localizer.simulation.journey import (
    KINDS,
    PASSED_ON,
    Journey,
    Stretch,
    Vehicles,
    motion_of,
    motions_of,
    speeds_um_s,
)
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.models.motion.world import ODOMETER_LAWFUL
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.vehicle_seed import VehicleSeed

__all__ = ["KINDS", "PASSED_ON", "Journey", "Steps", "Stretch", "first_state", "motion_of", "simulate", "with_truth"]

Steps = list[dict[str, Cell]]
FIRST_SPEED = "position.true_speed_um_s"
"""The open variable of the vehicle's speed."""


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
    system = _composed(config.model_dump_json())
    vehicle = Vehicles(config, [journey], [VehicleSeed(seed)])
    steps = steps_of(system, Fleet(vehicle, system, None).inputs(), 0)
    truths = (vehicle.motions.position_nm[:, 0] // NM_PER_MM).tolist()
    return [{**step, "truth_mm": truth} for step, truth in zip(steps, truths, strict=True)]


@lru_cache(maxsize=8)
def _composed(config: str) -> TransitionSystem:
    """Return a localizer with this configuration (JSON), and its world."""
    return compose_machines(LocalizerConfig.model_validate_json(config)).composition.system


@lru_cache(maxsize=8)
def _ghosts(config: str) -> frozenset[str]:
    """Return the names of its ghosts."""
    return frozenset(var.name for var in _composed(config).ghosts)


def first_state(config: LocalizerConfig, journey: Journey) -> dict[str, Value]:
    """Return first values of the open variables: place and speed of the vehicle, and its train."""
    return {
        **first_but_speed(config, journey),
        **_speed(config, speeds_um_s(motions_of(config, [journey]))[0, 0].item()),
    }


def _speed(config: LocalizerConfig, speed_um_s: int) -> dict[str, Value]:
    return {FIRST_SPEED: speed_um_s} if "satellite" in config.arbitration.sources else {}


def first_but_speed(config: LocalizerConfig, journey: Journey) -> dict[str, Value]:
    """Return the same without the speed, which differs from vehicle to vehicle (`FIRST_SPEED`)."""
    used: dict[str, Value] = {"truth_nm": 0}
    if config.motion.check is not None:
        used |= {
            "odometer_wander_nm": 0, "motion.lawful_wander_nm": 0, "motion.lawful_unit": ODOMETER_LAWFUL.value
        }  # fmt: skip
    open_: dict[str, dict[str, Value]] = {
        "odometry": {"odometry.faulty_unit": 0} if config.odometry.single_fault_safe else {},
        "fibre": {"verification.true_axles": journey.axles, "verification.true_length_um": journey.length_mm * 1_000},
    }
    for name in config.arbitration.sources:
        used |= open_.get(name, {})
    return used
