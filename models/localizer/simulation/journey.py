"""A vehicle's journey: its run, its line and the faults on it; and vehicles on one journey."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group
from safeloc.models.balise.simulation.passages import ANTENNA_FIGURES
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.junction import Junction
from safeloc.models.odometry.many import READER_FIGURES, SHARED_WHEEL
from safeloc.models.reflector import simulate as reflector_streams
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.motion import Leg, Motion, Motions, VehicleConfig, move_many
from safeloc.simulation.physics import conditions, fibre_coupling, multipath
from safeloc.simulation.physics.conditions import Conditions
from safeloc.simulation.physics.map_errors import REFLECTORS, SECTIONS, MapError, Survey, figures_of_survey
from safeloc.simulation.physics.speed_radar import SHARED_RADAR
from safeloc.simulation.vehicle_seed import VehicleSeed

KINDS = Kinds(
    "a journey",
    plain(
        "odometer silent", "odometer slides", "satellites lost", "multipath", "spoofing", "fibre miscount", "fibre error",
        "downlink silent", "uplink silent", "radar blind", "radar shifted", "marker misplaced", "balise corrupted",
        "balise missed", "balise displaced", "balise turned", "other branch taken", "linking not replaced",
    ),
)  # fmt: skip
"""Faults act in a span of cycles; those of balises name the group. A miscount and the faults at the junction act once on a journey,
and a fault of a group acts for the whole journey, whatever their cycles."""
UNLAWFUL = ("odometer slides", "spoofing", "radar shifted", "marker misplaced")
"""Kinds that break an assumption of a source about its sensors; the others keep every assumption."""
OF_THE_ROUTE = ("other branch taken", "linking not replaced")
"""Kinds that change which groups a vehicle passes, or the map announces."""
SPOOFED_MM, SHIFTED_MM, BLOCK_CYCLES = 800, 60_000, 5
"""Shift of all solutions in a cycle of spoofing, mm; shift of the radar, mm; length of a fibre's block, cycles."""


PASSED_ON: Mapping[str, Mapping[str, Fault]] = {
    "motion": {"odometer silent": Fault("drop-out", "wheel"), "odometer slides": Fault("slide", "wheel")},
    "odometry": {"marker misplaced": Fault("misplaced", "front_marker", figures={"reach": 1})},
    "balise": {
        "balise corrupted": Fault("corrupted"),
        "balise missed": Fault("missed"),
        "balise displaced": Fault("late"),
        "balise turned": Fault("wrong way"),
    },
    "reflector": {"radar blind": Fault("blind"), "radar shifted": Fault("shift", figures={"by_mm": SHIFTED_MM})},
}
"""Machine -> fault of the journey -> fault of the machine's own simulation."""


WHEEL = SHARED_WHEEL
SECTION_SPACING = "section_spacing_mm"
SPACING = {
    SECTION_SPACING: DrawnFigure(
        "mm", 1_000, 1e7, 100_000, "way from one section of the fibre to the next, whose place the map has"
    )
}
PHYSICS: Mapping[str, DrawnFigure] = {
    **conditions.figures_of([WHEEL], [SHARED_RADAR]), **multipath.FIGURES, **READER_FIGURES, **ANTENNA_FIGURES,
    **figures_of_survey(REFLECTORS), **figures_of_survey(SECTIONS), **SPACING, **fibre_coupling.FIGURES,
}  # fmt: skip
"""Figures of what is simulated from its physics: of rail, of both wheels and speed radars of a vehicle, of maps, reflected signals, readers and fibre."""


@dataclass(frozen=True)
class Stretch:
    """A part of the line, mm."""

    begin_mm: int
    end_mm: int

    def holds(self, places_mm: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return which places, mm, lie in the stretch."""
        return np.asarray((self.begin_mm <= places_mm) & (places_mm < self.end_mm), dtype=np.bool_)


@dataclass(frozen=True)
class Journey:
    """A vehicle's run, its line and the faults on it.

    dark        stretches without satellites; elsewhere `satellites` are in view, as far as the receiver has channels
    fibre       the stretch with a fibre along the track, with an axle counter at its beginning
    groups      balise groups along the route that is set, those behind the junction included
    latched     share of telegrams that come with the distance that the odometer counted since the group
    reflectors  reflectors, and as balises the groups from which the map has the distance to the next one
    junction    the switch at which another branch leaves that route; there is no fibre along the branch
    physics     figures of rail, wheels, map and reflected signals in place of their defaults (`PHYSICS`)
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
    latched: float = 0.5
    acceleration_mm_s2: int = 700
    troubles: Sequence[Fault] = ()
    physics: Mapping[str, float] = field(default_factory=dict)

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

    def undecided(self, places_mm: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return at which places either branch is possible, so that no satellite signal can be predicted."""
        if self.junction is None:
            return np.zeros(places_mm.shape, dtype=np.bool_)
        return self.junction.undecided(places_mm, self.passed, self.announced)


def motions_of(config: LocalizerConfig, journeys: Sequence[Journey]) -> Motions:
    """Return the vehicles' runs, which begin at place 0; all journeys must take the same number of cycles."""
    vehicles = [
        VehicleConfig(
            max_speed_mm_s=int(config.motion.max_speed_mm_s * 0.9), acceleration_mm_s2=one.acceleration_mm_s2,
            brake_mm_s2=one.acceleration_mm_s2, length_mm=one.length_mm,
        )
        for one in journeys
    ]  # fmt: skip
    return move_many(vehicles, [one.legs for one in journeys], config.motion.period_ms)


def motion_of(config: LocalizerConfig, journey: Journey) -> Motion:
    """Return the vehicle's run, which begins at place 0."""
    return motions_of(config, [journey]).of(0)


def speeds_um_s(motions: Motions) -> NDArray[np.int64]:
    """Return the speed at the end of each cycle, the initial one first, array [1 + cycle, vehicle]: the mean over the cycles before and
    after.
    """
    distance = motions.distance_nm
    step = np.concatenate([distance[:1], distance, distance[-1:]])
    return np.asarray((step[:-1] + step[1:]) // (2 * motions.period_ms), dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Vehicles:
    """Vehicles on one journey, each with its motion, satellites, times and groups of faults, and the seed of its sensors.

    They share line and train, and the branch taken: either all of them go astray, or miss the change of linking, or none.
    """

    config: LocalizerConfig
    journeys: Sequence[Journey]
    seeds: Sequence[VehicleSeed]

    @property
    def first(self) -> Journey:
        """The journey of the first one, for what they share."""
        return self.journeys[0]

    @cached_property
    def motions(self) -> Motions:
        """The run of each of them."""
        return motions_of(self.config, self.journeys)

    @property
    def shape(self) -> tuple[int, int]:
        """Cycles and vehicles."""
        return len(self.motions.position_nm), len(self.journeys)

    def rngs(self, sensor: str) -> list[np.random.Generator]:
        """Return a new generator of a sensor's stream for each vehicle."""
        return [seed.rng(sensor) for seed in self.seeds]

    @property
    def satellites(self) -> NDArray[np.int64]:
        """Satellites in view of each."""
        return np.array([one.satellites for one in self.journeys], dtype=np.int64)

    @cached_property
    def figures(self) -> Mapping[str, NDArray[np.float64]]:
        """The figures of `PHYSICS` of each: arrays [vehicle]."""
        return {
            name: np.array([one.physics.get(name, figure.default) for one in self.journeys], dtype=np.float64)
            for name, figure in PHYSICS.items()
        }

    @cached_property
    def met(self) -> Conditions:
        """Rail and map of each."""
        motions, longest = self.motions, self.config.odometry.vehicle_length_mm
        return Conditions(self.figures, self.seeds, motions.position_nm, motions.distance_nm, longest)

    @cached_property
    def maps(self) -> Sequence[MapError]:
        """The map's error of each, up to the last marker, group, reflector or section of the line."""
        journey = self.first
        places = [place for _, place in journey.markers]
        places += [group.place_mm for group in [*journey.groups, *journey.passed]]
        places += [one.position_mm for one in (*journey.reflectors.reflectors, *journey.reflectors.beside)]
        places += [journey.fibre.end_mm] if journey.fibre else []
        return self.met.maps(max(places, default=0))

    def survey(self, things: str) -> Survey:
        """Return the survey of reflectors, or of sections of the fibre."""
        return Survey(things, self.figures, self.seeds, self.maps)

    def acting(self, kind: str) -> NDArray[np.bool_]:
        """Return whether a fault of a kind acts: array [cycle, vehicle]."""
        found = np.zeros(self.shape, dtype=np.bool_)
        for vehicle, journey in enumerate(self.journeys):
            for one in journey.troubles:
                if one.kind == kind:
                    found[one.span, vehicle] = True
        return found

    def having(self, kind: str) -> NDArray[np.bool_]:
        """Return which vehicles have a fault of a kind."""
        return np.array(
            [any(one.kind == kind for one in journey.troubles) for journey in self.journeys], dtype=np.bool_
        )

    def passed_on(self, machine: str) -> list[list[Fault]]:
        """Return the troubles of each vehicle as faults of a machine's own simulation."""
        known = PASSED_ON[machine]
        return [
            [replace(known[one.kind], begin=one.begin, end=one.end) for one in journey.troubles if one.kind in known]
            for journey in self.journeys
        ]

    def faulty_groups(self) -> list[list[Fault]]:
        """Return the faults of the balise groups that each vehicle passes."""
        known, met = PASSED_ON["balise"], {group.identity for group in self.first.passed}
        return [
            [
                replace(known[one.kind], where=one.where)
                for one in journey.troubles
                if one.kind in known and one.where in met
            ]
            for journey in self.journeys
        ]

    def routes(self) -> list[dict[int, Sequence[Group]]]:
        """Return what linking announces to each vehicle, from a cycle on: behind a switch the other branch until the route is set, and
        the route from then on, unless linking is not replaced.
        """
        journey = self.first
        if journey.junction is None:
            return [{0: journey.passed}] * len(self.journeys)
        before, stale = journey.junction.branched(journey.groups), self.having("linking not replaced")
        set_ = self.motions.position_nm >= journey.junction.set_mm * NM_PER_MM
        found = list[dict[int, Sequence[Group]]]()
        for vehicle in range(len(self.journeys)):
            reached = np.flatnonzero(set_[:, vehicle]).tolist()[:1]
            found.append({0: before} if stale[vehicle] or not reached else {0: before, reached[0]: journey.groups})
        return found
