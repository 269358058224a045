"""The conditions that vehicles meet: rail, ground and map of each, drawn from its figures, and what its wheels and speed radars tell there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics import map_errors, rail, speed_radar
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.physics.lawful_wander import Limits, can_be_run, lawful_wander
from safeloc.simulation.physics.line_process import LineProcess, line_process
from safeloc.simulation.physics.map_errors import MapError, map_error
from safeloc.simulation.physics.pulse_wheel import PulseWheels, figures_of_wheel
from safeloc.simulation.physics.rail import rail_of
from safeloc.simulation.physics.speed_radar import SpeedRadars, figures_of_radar
from safeloc.simulation.sensors import Distances, ErrorFigures, faulty
from safeloc.simulation.vehicle_seed import VehicleSeed


def figures_of(wheels: Sequence[str], radars: Sequence[str] = ()) -> dict[str, DrawnFigure]:
    """Return the figures of rail, ground, map, and of these wheels and speed radars, that may be drawn."""
    found = {**rail.FIGURES, **map_errors.FIGURES, **(speed_radar.FIGURES if radars else {})}
    for name in wheels:
        found |= figures_of_wheel(name)
    for name in radars:
        found |= figures_of_radar(name)
    return found


@dataclass(frozen=True)
class Unit:
    """A wheel or a speed radar that measures.

    figures    the name that stands before its figures
    stream     its name in the seeds
    behind_mm  how far it is behind the front end
    """

    figures: str
    stream: str
    law: ErrorFigures
    limits: Limits
    period_ms: int
    behind_mm: int = 0


@dataclass(frozen=True, eq=False)
class Conditions:
    """Rail, ground and map of vehicles.

    figures      of `figures_of`, arrays [vehicle]
    position_nm  of the front end at the end of each cycle, [cycle, vehicle]; true_nm: the distance of each cycle
    longest_mm   how far the last unit is behind the front end, at most
    """

    figures: Mapping[str, Floats]
    seeds: Sequence[VehicleSeed]
    position_nm: NDArray[np.int64]
    true_nm: NDArray[np.int64]
    longest_mm: int

    @property
    def by_physics(self) -> NDArray[np.bool_]:
        """Return which vehicles have wheels that are simulated from their physics."""
        return np.asarray(self.figures[rail.ADHESION] > 0)

    def radars_by_physics(self, name: str) -> NDArray[np.bool_]:
        """Return which vehicles have a speed radar with figures of this name that is simulated from its physics."""
        return SpeedRadars(name, name, self.figures, self.seeds).by_physics

    @property
    def _end_mm(self) -> int:
        return int(self.position_nm.max()) // NM_PER_MM

    @cached_property
    def _rail(self) -> LineProcess:
        medians, spreads, lengths = (self.figures[name] for name in (rail.ADHESION, rail.SPREAD, rail.CORRELATION))
        return rail_of(self.seeds, medians, spreads, lengths, -self.longest_mm, self._end_mm)

    @cached_property
    def _ground(self) -> LineProcess:
        return line_process(self.seeds, "ground", self.figures[speed_radar.GROUND], -self.longest_mm, self._end_mm)

    def _under(self, unit: Unit) -> NDArray[np.int64]:
        return self.position_nm - unit.behind_mm * NM_PER_MM

    def measured(self, wheel: Unit, by_law: Distances, faults: Sequence[Sequence[Fault]]) -> Distances:
        """Return what a wheel of each vehicle tells: by its physics where the vehicle has a rail, else as it is `by_law`.

        The wander is one that explains what was told, if the law allows any.
        """
        if not self.by_physics.any():
            return by_law
        made = PulseWheels(wheel.figures, wheel.stream, self.figures, self.seeds)
        adhesion = self._rail.at(self._under(wheel))
        told = made.told_mm(self.true_nm, adhesion, by_law.present, wheel.period_ms)
        return self._explained(wheel, told, self.by_physics, by_law, faults)

    def measured_by_radar(self, radar: Unit, by_law: Distances, faults: Sequence[Sequence[Fault]]) -> Distances:
        """Return the same of a speed radar: by its physics where it has noise."""
        made = SpeedRadars(radar.figures, radar.stream, self.figures, self.seeds)
        if not made.by_physics.any():
            return by_law
        told = made.told_mm(self.true_nm, self._ground.at(self._under(radar)), by_law.present, radar.period_ms)
        return self._explained(radar, told, made.by_physics, by_law, faults)

    def _explained(
        self,
        unit: Unit,
        told: NDArray[np.int64],
        which: NDArray[np.bool_],
        by_law: Distances,
        faults: Sequence[Sequence[Fault]],
    ) -> Distances:
        """Return what was told, with its faults, in the place of what is by law, and a wander that explains it."""
        for vehicle, own in enumerate(faults):
            struck = [fault for fault in own if fault.strikes(by_law.name)]
            if struck:
                found = faulty(by_law.name, told[:, vehicle], struck)
                told[:, vehicle] = np.where(by_law.present[:, vehicle], found, 0)
        counts = can_be_run(told, by_law.present, unit.limits)
        wander, _ = lawful_wander(self.true_nm, told, counts, unit.law, unit.period_ms)
        return replace(
            by_law,
            distance_mm=np.where(which, told, by_law.distance_mm),
            wander_nm=np.where(which, wander, by_law.wander_nm),
        )

    def maps(self, end_mm: int) -> list[MapError]:
        """Return the error of each vehicle's map up to the end of the line."""
        columns = (self.figures[name].tolist() for name in (map_errors.OFFSET, map_errors.WALK, map_errors.OWN))
        return [
            map_error(seed, offset, walk, own, end_mm)
            for seed, offset, walk, own in zip(self.seeds, *columns, strict=True)
        ]
