"""A vehicle's journey with all its ways of locating, as one step stream of the localizer, its ghosts included.

All sources measure the same motion, and those that use the vehicle's odometer get the same distances. The modules of odometry,
balises and reflectors simulate these sources; for satellites and the fibre, `front_ends` simulates the output of their front
ends. Faults have names (`KINDS`). A fault that breaks an assumption makes a stream without ghosts; there only the remark
`truth_mm` shows the truth. Many vehicles at once are simulated by `many`, from the same draws.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from safeloc.language.nodes import Value
from safeloc.models.balise import simulate as balise_streams
from safeloc.models.localizer import LocalizerConfig, compose_machines
from safeloc.models.localizer.simulation.columns import Columns, steps_of
from safeloc.models.localizer.simulation.front_ends import common, fibre, links, satellite
from safeloc.models.localizer.simulation.journey import (
    KINDS,
    PASSED_ON,
    Journey,
    Stretch,
    Vehicles,
    motion_of,
    speeds_um_s,
)
from safeloc.models.motion.simulate import Measured, measured_by
from safeloc.models.motion.world import ODOMETER_LAWFUL
from safeloc.models.odometry import simulate as odometry_streams
from safeloc.models.reflector import simulate as reflector_streams
from safeloc.models.reflector.simulate import Scene
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault

__all__ = ["KINDS", "PASSED_ON", "Journey", "Steps", "Stretch", "first_state", "motion_of", "simulate", "with_truth"]

Steps = list[dict[str, Cell]]
WIRED = (
    "odometer_mm", "odometer_more_nm", "distance_mm", "distance_more_nm", "truth_mm", "true_cycle_distance_nm",
)  # fmt: skip
CHECKED = ("odometer_next_wander_nm", "next_wander_nm")
"""Ghosts that the machines share, in addition to `WIRED`, if a check unit lets the odometer's error law be proved."""


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
    vehicle = Vehicles(config, [journey], [seed])
    (faults,) = vehicle.passed_on("motion")
    measured = measured_by("wheel", config.motion, vehicle.motion, np.random.default_rng(seed), faults)
    parts = [_alone(vehicle, common(vehicle, measured.as_columns)), _alone(vehicle, links(vehicle))]
    parts += [_SOURCES[name](vehicle, measured) for name in config.arbitration.sources]
    return [{key: cell for part in row for key, cell in part.items()} for row in zip(*parts, strict=True)]


def _alone(vehicle: Vehicles, columns: Columns) -> Steps:
    return steps_of(columns, vehicle.shape, 0)


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
        "satellite": {"position.true_speed_um_s": int(speeds_um_s(motion)[0])},
        "fibre": {"verification.true_axles": journey.axles, "verification.true_length_um": journey.length_mm * 1_000},
    }
    for name in config.arbitration.sources:
        used |= open_.get(name, {})
    return used


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


def _odometry(vehicle: Vehicles, measured: Measured) -> Steps:
    config, (faults,) = vehicle.config, vehicle.passed_on("odometry")
    return _named(
        "odometry",
        odometry_streams.simulate(
            config.odometry, seed=vehicle.seeds[0], motion=vehicle.motion, markers=vehicle.first.markers, dropout=0, missed=0,
            foreign=0, faults=faults, first_unit=measured.odometer, second_unit=measured.check,
        ),
        _units_received(config),
    )  # fmt: skip


def _balise(vehicle: Vehicles, measured: Measured) -> Steps:
    (faults,) = vehicle.faulty_groups()
    return _named(
        "balise",
        balise_streams.simulate(
            vehicle.config.balise, seed=vehicle.seeds[0], motion=vehicle.motion, groups=vehicle.first.passed,
            routes=vehicle.routes(), missed=0, foreign=0, faults=faults, measured=measured.reported,
        ),
        _check_inputs(measured),
    )  # fmt: skip


def _reflector(vehicle: Vehicles, measured: Measured) -> Steps:
    (disturbed,) = vehicle.passed_on("reflector")
    return _named(
        "reflector",
        reflector_streams.simulate(
            vehicle.config.reflector, seed=vehicle.seeds[0], scene=radar_scene(vehicle.first, tuple(disturbed)), motion=vehicle.motion,
            measured=measured.reported,
        ),
        _check_inputs(measured),
    )  # fmt: skip


def radar_scene(journey: Journey, disturbances: tuple[Fault, ...] = ()) -> Scene:
    """Return what the radar of a vehicle meets."""
    return Scene(journey.reflectors, pauses=0, dropout=0, disturbances=disturbances)


def _satellite(vehicle: Vehicles, _: Measured) -> Steps:
    return _alone(vehicle, satellite(vehicle))


def _fibre(vehicle: Vehicles, _: Measured) -> Steps:
    return _alone(vehicle, fibre(vehicle))


_SOURCES = {
    "odometry": _odometry,
    "balise": _balise,
    "reflector": _reflector,
    "satellite": _satellite,
    "fibre": _fibre,
}
