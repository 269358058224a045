"""A vehicle along a route of a line, as step streams of the machines that locate on it.

Only named faults occur: without them every sensor keeps its law, the vehicle reads every group and sees every reflector.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.models.balise import simulate as balise_streams
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.line_runs.configs import SPEED_SHARE, LineVehicle, fitting
from safeloc.models.line_runs.faults import MACHINES, Asked
from safeloc.models.line_runs.placing import Struck, placed
from safeloc.models.line_runs.ways import (
    accuracies,
    groups,
    limits,
    markers,
    platforms,
    reflector_route,
    stop_places,
    switches_ahead,
    without,
)
from safeloc.models.odometry import simulate as odometry_streams
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.reflector import simulate as reflector_streams
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.route import simulate as route_streams
from safeloc.models.route.variables import RouteConfig
from safeloc.models.stop_point.simulate import Platform, simulate_platform
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.turn_off import TurnOffConfig
from safeloc.models.turn_off import simulate as turn_off_streams
from safeloc.railway.map.routes import Route
from safeloc.railway.map.walk import Walk
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Motion
from safeloc.simulation.speed_profile import Halt, drive

STAND_S, REDUCED_MM_S = 4.0, 600
OVERRUN_MM, SHORT_MM = 3_000, 2_000
MOST_ROUTES = 16


@dataclass(frozen=True)
class Journey:
    """One vehicle on one route.

    rivals   the routes among which the route machine has to find this one; they include this one
    """

    route: Route
    walk: Walk
    vehicle: LineVehicle
    seed: int
    rivals: Sequence[Route] = ()
    faults: Sequence[Asked] = ()


@dataclass(frozen=True)
class Stream:
    """The steps of one machine on one journey, and the machine's configuration.

    stop     the stop point to which the steps lead; empty for all machines except `stop_point`
    struck   the injected faults, with their places
    """

    machine: str
    config: Config
    steps: Sequence[Mapping[str, Cell]]
    stop: str = ""
    struck: Sequence[Struck] = field(default=())


def streams(journey: Journey, machine: str) -> Iterator[Stream]:
    """Return the streams of a machine: one, or one for each stop point, or none if the route has nothing for it.

    InputError for a machine that drives on no line, a vehicle that does not suit it, or a fault off the route.
    """
    if machine not in MAKERS:
        raise InputError(f"no machine {machine!r} to drive on a line; there are {', '.join(MACHINES)}.")
    yield from MAKERS[machine](journey)


def motion_of(journey: Journey, gate_mm_s: int, period_ms: int, halts: Sequence[Halt] = ()) -> Motion:
    """Return the motion from standstill at the route's start to its end, or over the halts; at 80 to 100 % of the permitted speed."""
    top = min(journey.vehicle.motion.max_speed_mm_s, int(gate_mm_s * SPEED_SHARE))
    share = random.Random(journey.seed).uniform(0.8, 1.0)
    ways = halts or [Halt(journey.route.length_mm, STAND_S, top)]
    moves = [Halt(one.at_mm, one.stand_s, min(one.top_mm_s, max(1, int(top * share)))) for one in ways]
    return drive(journey.vehicle.motion, moves, limits(journey.route), period_ms)


def _struck(journey: Journey, machine: str, motion: Motion, reflector: str = "") -> list[Struck]:
    """Return the machine's faults on this route; a fault that names no reflector strikes `reflector`."""
    asked = [one for one in journey.faults if machine in one.fault.outcomes]
    asked = [replace(one, at=reflector) if one.fault.where == "reflector" and not one.at else one for one in asked]
    return [found for one in asked if (found := placed(one, journey.route, motion)) is not None]


# ------------------------------------------------------------------ one function for each machine


def _odometry(journey: Journey) -> Iterator[Stream]:
    config = fitting(journey.vehicle, "odometry")
    assert isinstance(config, OdometryConfig)
    motion = motion_of(journey, config.max_speed_mm_s, config.period_ms)
    struck, readers = _struck(journey, "odometry", motion), journey.vehicle.readers
    steps = odometry_streams.simulate(
        config,
        seed=journey.seed,
        motion=motion,
        markers=markers(journey.route, readers),
        marker_accuracy_mm=accuracies(
            journey.route, journey.vehicle.national_mm, journey.vehicle.detection_mm, readers
        ),
        dropout=0,
        missed=0,
        foreign=0,
        faults=_of_odometry(struck, config.limits.max_cycle_distance_mm),
    )
    yield Stream("odometry", config, steps, struck=struck)


def _of_odometry(struck: Sequence[Struck], max_cycle_distance_mm: int) -> list[Fault]:
    """Return the faults of the front reader, and of the front end's first unit."""
    found: list[Fault] = []
    for one in struck:
        found += [*one.of_reader(), *one.of_distance("front_wheel", max_cycle_distance_mm)]
    return found


def _balise(journey: Journey) -> Iterator[Stream]:
    config = fitting(journey.vehicle, "balise")
    assert isinstance(config, BaliseConfig)
    motion = motion_of(journey, config.max_speed_mm_s, config.period_ms)
    struck = _struck(journey, "balise", motion)
    steps = balise_streams.simulate(
        config,
        seed=journey.seed,
        motion=motion,
        groups=groups(journey.route),
        national_accuracy_mm=journey.vehicle.national_mm,
        dropout=0,
        missed=0,
        foreign=0,
        faults=[fault for one in struck for fault in one.of_group()],
        sensor_faults=[
            fault for one in struck for fault in one.of_distance("odometer", config.limits.max_cycle_distance_mm)
        ],
    )
    yield Stream("balise", config, steps, struck=struck)


def _reflector(journey: Journey) -> Iterator[Stream]:
    config = _source(journey)
    motion = motion_of(journey, config.max_speed_mm_s, config.period_ms)
    struck = _struck(journey, "reflector", motion)
    steps = reflector_streams.simulate(
        config, seed=journey.seed, scene=_scene(journey, struck, config.max_cycle_distance_mm), motion=motion
    )
    yield Stream("reflector", config, steps, struck=struck)


def _source(journey: Journey) -> ReflectorConfig:
    config = fitting(journey.vehicle, "reflector")
    assert isinstance(config, ReflectorConfig)
    return config


def _scene(journey: Journey, struck: Sequence[Struck], max_cycle_distance_mm: int) -> reflector_streams.Scene:
    vehicle = journey.vehicle
    seen = reflector_route(
        journey.route,
        journey.walk,
        antenna_mm=vehicle.antenna_mm,
        national_mm=vehicle.national_mm,
        detection_mm=vehicle.detection_mm,
    )
    unread = [one.identity for one in struck if one.name == "group-missed"]
    gone = [one.place_mm for one in struck if one.name == "reflector-gone"]
    return reflector_streams.Scene(
        without(seen, balises=unread, missing=gone),
        error_mm=vehicle.radar_error_mm,
        pauses=0,
        dropout=0,
        disturbances=tuple(one for fault in struck for one in fault.of_radar()),
        sensor_faults=tuple(one for fault in struck for one in fault.of_distance("wheel", max_cycle_distance_mm)),
    )


def _stop_point(journey: Journey) -> Iterator[Stream]:
    for platform in platforms(journey.route):
        config = fitting(journey.vehicle, "stop_point", len(platform))
        assert isinstance(config, StopPointConfig)
        source = _source(journey)
        for number, (place, stop) in enumerate(platform, 1):
            off = sum(_off_mm(one.fault.name) for one in journey.faults)
            motion = motion_of(journey, config.max_speed_mm_s, source.period_ms, _halts(place, off, config))
            struck = _struck(journey, "stop_point", motion, stop.reflector)
            steps = simulate_platform(
                config,
                Platform(stop_places(platform), number, permitted=off != 0),
                motion,
                source=source,
                scene=_scene(journey, struck, source.max_cycle_distance_mm),
                seed=journey.seed,
            )
            yield Stream("stop_point", config, steps, stop.id, struck)


def _off_mm(name: str) -> int:
    """Return the place at which the vehicle first comes to stand, relative to the stop point, mm."""
    return {"stop-overrun": OVERRUN_MM, "stop-short": -SHORT_MM}.get(name, 0)


def _halts(place_mm: int, off_mm: int, config: StopPointConfig) -> list[Halt]:
    first = Halt(place_mm + off_mm, STAND_S, config.max_speed_mm_s)
    slow = min(REDUCED_MM_S, config.reduced_speed_mm_s - config.speed_error_mm_s)
    return [first] if off_mm == 0 else [first, Halt(place_mm, STAND_S, slow)]


def _route(journey: Journey) -> Iterator[Stream]:
    rivals = journey.rivals or [journey.route]
    if len(rivals) > MOST_ROUTES:
        raise InputError(
            f"{len(rivals)} routes begin like {journey.route.name}, but the route machine distinguishes {MOST_ROUTES} at most; give "
            "a way from one place to another with fewer routes between them."
        )
    longest = max(one.length_mm for one in rivals)
    config = fitting(journey.vehicle, "route", len(rivals), longest)
    assert isinstance(config, RouteConfig)
    motion = motion_of(journey, config.max_speed_mm_s, config.period_ms)
    struck = _struck(journey, "route", motion)
    taken = [one.runs for one in rivals].index(journey.route.runs) + 1
    wrong = any(one.name == "authority-wrong" for one in struck)
    steps = route_streams.simulate(
        config,
        [route_streams.way(number, one) for number, one in enumerate(rivals, 1)],
        taken,
        seed=journey.seed,
        motion=motion,
        dropout=0,
        start_error_mm=min(4_000, config.start_error_mm),
        radar_error_mm=journey.vehicle.radar_error_mm,
        missed=[one.at for one in struck if one.name == "reflector-gone"],
        misread={one.at: one.model for one in struck if one.name == "model-misread"},
        sensor_faults=[
            fault for one in struck for fault in one.of_distance("odometer", config.limits.max_cycle_distance_mm)
        ],
        authorised=(taken % len(rivals) + 1) if wrong else taken,
    )
    yield Stream("route", config, steps, struck=struck)


def _turn_off(journey: Journey) -> Iterator[Stream]:
    config, source = fitting(journey.vehicle, "turn_off"), _source(journey)
    assert isinstance(config, TurnOffConfig)
    switches = switches_ahead(journey.route)
    if not switches:
        return
    motion = motion_of(journey, source.max_speed_mm_s, source.period_ms)
    struck = _struck(journey, "turn_off", motion)
    steps = turn_off_streams.simulate(
        config,
        source,
        _scene(journey, struck, source.max_cycle_distance_mm),
        switches,
        motion,
        seed=journey.seed,
        wrong_authority=any(one.name == "authority-wrong" for one in struck),
    )
    yield Stream("turn_off", config, steps, struck=struck)


MAKERS: Mapping[str, Callable[[Journey], Iterator[Stream]]] = {
    "odometry": _odometry,
    "balise": _balise,
    "reflector": _reflector,
    "stop_point": _stop_point,
    "route": _route,
    "turn_off": _turn_off,
}
