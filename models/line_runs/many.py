"""Many vehicles of one kind on the routes of a line, for campaigns: each machine simulated as arrays over vehicles."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from safeloc.errors import InputError
from safeloc.language.renamed import hint
from safeloc.language.system import TransitionSystem
from safeloc.models.balise.simulation import many as balise_runs
from safeloc.models.balise.simulation.many import Line
from safeloc.models.balise.simulation.passages import ANTENNA_FIGURES, KINDS, Antenna, antenna_timing
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.line_runs.configs import SPEED_SHARE, LineVehicle, fitting
from safeloc.models.line_runs.drive import STAND_S
from safeloc.models.line_runs.route_choice import Chosen
from safeloc.models.line_runs.ways import accuracies, groups, limits, markers
from safeloc.models.odometry.many import Drives, figures_of, kinds_of, simulate_many
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.railway.map.routes import Route
from safeloc.simulation import sensors
from safeloc.simulation.faults import Fault, Kinds
from safeloc.simulation.many_runs import Drawn, DrawnFigure, ManyRuns, joined
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import SEVERITY, measure_many
from safeloc.simulation.speed_profile import Halt, drive

TOP, ROUTE = "top_share", "route"
_TOP_FIGURE = DrawnFigure(
    "share", 0.05, 1, 1.0, "share of the highest permitted speed at which it drives", discrete=True
)


@dataclass(frozen=True, eq=False)
class OnLine:
    """Vehicles of one kind on the routes of a line; each drives one route, any of them alike.

    made_with, system  the configuration of their machine, and the machine with its world
    libraries          folder for compiled machines; None: a temporary one
    """

    vehicle: LineVehicle
    routes: Sequence[Chosen]
    made_with: OdometryConfig | BaliseConfig
    system: TransitionSystem
    libraries: Path | None = None

    @property
    def period_ms(self) -> int:
        """The length of a cycle."""
        return self.made_with.period_ms

    @cached_property
    def _motions(self) -> dict[tuple[str, float, int], Motion]:
        return {}

    def motion(self, route: Route, top_share: float, gate_mm_s: int, period_ms: int, cycles: int) -> Motion:
        """Return the motion from standstill to the end of the route, where it stands; or only its first cycles."""
        key = route.name, top_share, cycles
        if key not in self._motions:
            self._motions[key] = self._driven(route, top_share, gate_mm_s, period_ms, cycles)
        return self._motions[key]

    def _driven(self, route: Route, top_share: float, gate_mm_s: int, period_ms: int, cycles: int) -> Motion:
        top = min(self.vehicle.motion.max_speed_mm_s, int(gate_mm_s * SPEED_SHARE))
        stand_s = max(STAND_S, cycles * period_ms / 1_000)
        halts = [Halt(route.length_mm, stand_s, max(1, int(top * top_share)))]
        motion = drive(self.vehicle.motion, halts, limits(route), period_ms)
        return replace(motion, position_nm=motion.position_nm[:cycles], speed_mm_s=motion.speed_mm_s[:cycles])


class OdometryOnLine(OnLine):
    """Vehicles with the odometry machine, simulated as arrays."""

    @cached_property
    def config(self) -> OdometryConfig:
        """The configuration of the machine."""
        assert isinstance(self.made_with, OdometryConfig)
        return self.made_with

    @property
    def figures(self) -> Mapping[str, DrawnFigure]:
        """The figures that may be drawn, by name."""
        return {TOP: _TOP_FIGURE, **figures_of(self.config)}

    @property
    def kinds(self) -> Mapping[str | int, Kinds]:
        """The places that may be faulty, each with its kinds of fault."""
        return kinds_of(self.config)

    @property
    def timeless(self) -> Collection[str | int]:
        """No faults act for the whole run."""
        return ()

    def runs(self, drawn: Drawn, cycles: int) -> ManyRuns:
        """Return the runs of the vehicles."""
        taken = _taken(drawn, len(self.routes))
        parts: list[tuple[np.ndarray, ManyRuns]] = []
        for number in np.unique(taken):
            which = np.flatnonzero(taken == number)
            parts.append((which, self._on_route(self.routes[number].route, _some(drawn, which), cycles)))
        return joined(parts, drawn.vehicles)

    def _on_route(self, route: Route, drawn: Drawn, cycles: int) -> ManyRuns:
        tops, of_vehicle = np.unique(drawn.figures[TOP], return_inverse=True)
        gate, period = self.config.max_speed_mm_s, self.config.period_ms
        places = [self.motion(route, float(top), gate, period, cycles).position_nm for top in tops]
        readers = self.vehicle.readers
        known = accuracies(route, self.vehicle.national_mm, self.vehicle.detection_mm, readers)
        drives = Drives(np.stack(places, axis=1), of_vehicle)
        return simulate_many(self.config, self.system, drives, markers(route, readers), known, drawn)


class BaliseOnLine(OnLine):
    """Vehicles with the balise machine, simulated cycle by cycle: what the map announces follows from what the machines ask for."""

    @cached_property
    def config(self) -> BaliseConfig:
        """The configuration of the machine."""
        assert isinstance(self.made_with, BaliseConfig)
        return self.made_with

    @property
    def figures(self) -> Mapping[str, DrawnFigure]:
        """The figures that may be drawn, by name."""
        return {
            TOP: _TOP_FIGURE,
            "missed": DrawnFigure("share", 0, 1, 0.0, "groups that the reader does not report"),
            "foreign": DrawnFigure(
                "share", 0, 1, 0.0, "cycles without another telegram that bring one of another track"
            ),
            "counted": DrawnFigure("share", 0, 1, 0.5, "readings with a latched counter"),
            "odometer_dropout": DrawnFigure("share", 0, 1, 0.0, "cycles in which the odometer measures nothing"),
            **ANTENNA_FIGURES,
        }

    @property
    def kinds(self) -> Mapping[str | int, Kinds]:
        """The places that may be faulty: the odometer, and each group by its identity on board."""
        met = {group.identity for one in self.routes for group in groups(one.route)}
        return {"odometer": sensors.KINDS, **dict.fromkeys(sorted(met), KINDS)}

    @property
    def timeless(self) -> Collection[str | int]:
        """The groups: each has its fault for the whole run."""
        return [place for place in self.kinds if isinstance(place, int)]

    def runs(self, drawn: Drawn, cycles: int) -> ManyRuns:
        """Return the runs of the vehicles."""
        taken = _taken(drawn, len(self.routes))
        parts: list[tuple[np.ndarray, ManyRuns]] = []
        for number in np.unique(taken):
            which = np.flatnonzero(taken == number)
            parts.append((which, self._on_route(self.routes[number].route, _some(drawn, which), cycles)))
        return joined(parts, drawn.vehicles)

    def _on_route(self, route: Route, drawn: Drawn, cycles: int) -> ManyRuns:
        config, figures = self.config, drawn.figures
        motions = [
            self.motion(route, top, config.max_speed_mm_s, config.period_ms, cycles) for top in figures[TOP].tolist()
        ]
        known = groups(route)
        distances = measure_many(
            "odometer", np.stack([one.distance_nm for one in motions], axis=1), config.period_ms, config.odometer,
            [seed.rng("odometer") for seed in drawn.seeds],
            dropout=figures["odometer_dropout"].tolist(), severity=[SEVERITY] * drawn.vehicles,
            faults=[[fault for fault in faults if fault.where == "odometer"] for faults in drawn.faults],
        )  # fmt: skip
        met = {group.identity for group in known}
        of_groups = [[fault for fault in faults if fault.where in met] for faults in drawn.faults]
        shares = (figures[name].tolist() for name in ("missed", "foreign", "counted"))
        rngs = [seed.rng("antenna") for seed in drawn.seeds]
        antennas = [
            Antenna(rng, missed, foreign, counted, own, None, antenna_timing(figures, run, drawn.seeds[run]))
            for run, (rng, missed, foreign, counted, own) in enumerate(zip(rngs, *shares, of_groups, strict=True))
        ]
        line = Line(known, [{0: known}] * drawn.vehicles, self.vehicle.national_mm, self.libraries)
        return ManyRuns(balise_runs.simulate_many(config, line, motions, distances, antennas).inputs)


ON_LINE: Mapping[str, type[OdometryOnLine | BaliseOnLine]] = {"odometry": OdometryOnLine, "balise": BaliseOnLine}
"""Machines that a campaign drives along a line."""


def configured(machine: str, vehicle: LineVehicle) -> OdometryConfig | BaliseConfig:
    """Return the configuration of a machine for a vehicle; InputError for a machine that no campaign drives along a line."""
    if machine not in ON_LINE:
        raise InputError(
            f"a campaign drives no {machine} along a line; it drives {', '.join(ON_LINE)}.{hint(machine, ON_LINE)}"
        )
    config = fitting(vehicle, machine)
    assert isinstance(config, OdometryConfig | BaliseConfig)
    return config


def _some(drawn: Drawn, which: np.ndarray) -> Drawn:
    faults: list[Sequence[Fault]] = [drawn.faults[run] for run in which]
    figures = {name: values[which] for name, values in drawn.figures.items()}
    return Drawn(len(which), figures, faults, [drawn.seeds[run] for run in which])


def _taken(drawn: Drawn, routes: int) -> np.ndarray:
    """Return the number of the route that each vehicle takes."""
    return np.array([seed.rng("route").integers(0, routes) for seed in drawn.seeds])
