"""The sources of many localizers as arrays of the composition's inputs: each is simulated as the source of one vehicle is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from safeloc.language.system import TransitionSystem, lower
from safeloc.models import odometry
from safeloc.models.balise.simulation.many import Line
from safeloc.models.balise.simulation.many import simulate_many as simulate_balises
from safeloc.models.balise.simulation.passages import Antenna, antenna_timing
from safeloc.models.localizer.simulation.anchored_radars import anchored_inputs
from safeloc.models.localizer.simulation.columns import Columns, arrays_of
from safeloc.models.localizer.simulation.front_ends import common, fibre, links, satellite
from safeloc.models.localizer.simulation.journey import WHEEL, Vehicles
from safeloc.models.localizer.simulation.off_the_map import misplaced, reflectors_err
from safeloc.models.motion.simulate import Measured, measured_by_many
from safeloc.models.motion.world import CHECK_LAWFUL, ODOMETER_LAWFUL
from safeloc.models.odometry.many import faulty_unit, simulate_shared
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.reflector.simulation.draws import ByPurpose
from safeloc.models.reflector.simulation.many import sensed
from safeloc.models.reflector.simulation.many import simulate_many as simulate_radars
from safeloc.models.reflector.simulation.scene import KINDS, Scene
from safeloc.simulation.many_runs import Array, ManyRuns, absent_everywhere
from safeloc.simulation.physics.map_errors import REFLECTORS


@dataclass(frozen=True, eq=False)
class Fleet:
    """Vehicles on one journey, and the localizer with its world that their inputs are for.

    libraries  folder for compiled machines; None: a temporary one
    """

    vehicles: Vehicles
    system: TransitionSystem
    libraries: Path | None

    def inputs(self) -> dict[str, Array]:
        """Return all inputs: name -> array [cycle, vehicle]."""
        return dict(self.runs().inputs)

    def runs(self) -> ManyRuns:
        """Return all inputs, and the first values of what the world chooses for good by hindsight: which unit keeps its law, and which not."""
        vehicles = self.vehicles
        measured = measured_by_many(
            WHEEL,
            vehicles.config.motion,
            vehicles.motions,
            vehicles.seeds,
            vehicles.passed_on("motion"),
            self.libraries,
            vehicles.met,
        )
        found = self._of(common(vehicles, measured)) | self._of(links(vehicles))
        for name in vehicles.config.arbitration.sources:
            found |= _SOURCES[name](self, measured, found)
        return ManyRuns(absent_everywhere(self.system, *vehicles.shape, but=found), self._chosen(measured, found))

    def _chosen(self, measured: Measured, found: Mapping[str, Array]) -> dict[str, Array]:
        """Return the lawful unit of motion, and the faulty one of odometry, of each vehicle, where the world has such a choice."""
        config, chosen = self.vehicles.config, dict[str, Array]()
        if config.motion.check is not None:
            chosen["motion.lawful_unit"] = np.where(measured.lawful.is_check, CHECK_LAWFUL.value, ODOMETER_LAWFUL.value)
        if "odometry" in config.sources and config.odometry.single_fault_safe:
            told = {f"front_{WHEEL}": (measured.odometer.distance_mm, measured.odometer.present)}
            if measured.check is not None:
                told["front_radar"] = measured.check.distance_mm, measured.check.present
            for name in (f"rear_{WHEEL}", "rear_radar"):
                if f"odometry.{name}_mm" in found:
                    told[name] = found[f"odometry.{name}_mm"], found[f"odometry.{name}_mm.present"]
            chosen["odometry.faulty_unit"] = faulty_unit(config.odometry, self.vehicles.met, told)
        if self.vehicles.survey(REFLECTORS).errs.any() and "reflector.next_radar_bias_nm" in found:
            errs = reflectors_err(self.vehicles)
            chosen["reflector.radar_bias_nm"] = np.where(errs, found["reflector.next_radar_bias_nm"][0], 0)
        return chosen

    def _of(self, columns: Columns) -> dict[str, Array]:
        return arrays_of(columns, self.system, self.vehicles.shape)

    def named(self, machine: str, inputs: Mapping[str, Array]) -> dict[str, Array]:
        """Return a machine's own inputs under the names of the composition, without those wired to other machines."""
        known = {var.name for var in self.system.inputs}
        return {f"{machine}.{name}": values for name, values in inputs.items() if f"{machine}.{name}" in known}


@lru_cache(maxsize=8)
def _odometry_system(config: str) -> TransitionSystem:
    return lower(odometry.machine(OdometryConfig.model_validate_json(config)))


def _odometry(fleet: Fleet, measured: Measured, _: Mapping[str, Array]) -> dict[str, Array]:
    vehicles, config = fleet.vehicles, fleet.vehicles.config.odometry
    made = simulate_shared(
        config, _odometry_system(config.model_dump_json()), vehicles.motions, vehicles.seeds, vehicles.passed_on("odometry"),
        vehicles.first.markers, [measured.odometer, measured.check], vehicles.met, vehicles.maps,
    )  # fmt: skip
    return fleet.named("odometry", made)


def _balise(fleet: Fleet, measured: Measured, _: Mapping[str, Array]) -> dict[str, Array]:
    vehicles = fleet.vehicles
    antennas = [
        Antenna(
            rng,
            0,
            0,
            vehicles.first.latched,
            own,
            wrong,
            antenna_timing(vehicles.figures, vehicle, vehicles.seeds[vehicle]),
        )
        for vehicle, (rng, own, wrong) in enumerate(
            zip(vehicles.rngs("antenna"), vehicles.faulty_groups(), vehicles.maps, strict=True)
        )
    ]
    motions = [vehicles.motions.of(vehicle) for vehicle in range(len(antennas))]
    line = Line(vehicles.first.passed, vehicles.routes(), 5_000, fleet.libraries)
    made = simulate_balises(vehicles.config.balise, line, motions, measured.reported, antennas)
    return fleet.named("balise", made.inputs)


def _reflector(fleet: Fleet, measured: Measured, found: Mapping[str, Array]) -> dict[str, Array]:
    vehicles, route = fleet.vehicles, fleet.vehicles.first.reflectors
    disturbed, anchored = vehicles.passed_on("reflector"), "balise" in vehicles.config.sources
    for own in disturbed:
        KINDS.require(own, places=[""], length=vehicles.shape[0])
    draws = ByPurpose(vehicles.seeds, vehicles.shape[0])
    if not anchored:
        made = simulate_radars(
            vehicles.config.reflector, Scene(route, pauses=0, dropout=0), vehicles.motions, measured.reported, disturbed, draws,
            fleet.libraries, misplaced(vehicles, route.balises),
        )  # fmt: skip
        return fleet.named("reflector", made)
    scene = Scene(replace(route, balises=()), pauses=0, dropout=0)
    radars, _ = sensed(
        vehicles.config.reflector, scene, vehicles.motions, measured.reported, disturbed, draws, misplaced(vehicles, ())
    )
    groups = {group.identity: group for group in (*vehicles.first.groups, *vehicles.first.passed)}
    made = anchored_inputs(vehicles.config, route, list(groups.values()), radars, found, fleet.libraries)
    known = {var.name for var in fleet.system.inputs}
    return {name: values for name, values in made.items() if name in known}


def _satellite(fleet: Fleet, _: Measured, __: Mapping[str, Array]) -> dict[str, Array]:
    return arrays_of(satellite(fleet.vehicles), fleet.system, fleet.vehicles.shape)


def _fibre(fleet: Fleet, _: Measured, __: Mapping[str, Array]) -> dict[str, Array]:
    return arrays_of(fibre(fleet.vehicles), fleet.system, fleet.vehicles.shape)


_SOURCES = {
    "odometry": _odometry,
    "balise": _balise,
    "reflector": _reflector,
    "satellite": _satellite,
    "fibre": _fibre,
}
