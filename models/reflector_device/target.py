"""The catalogue entry of the reflector device."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.language.spec import Property
from safeloc.models import reflector_device
from safeloc.models.delocalized.reported import interval_of_the_host
from safeloc.models.reflector_device import NAME, ReflectorDevice
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.configurations import CONFIGURATIONS
from safeloc.properties import balise as balise_claims
from safeloc.properties import delocalized as delocalized_claims
from safeloc.properties import reflector as reflector_claims
from safeloc.properties import reflector_device as claims
from safeloc.properties import route as route_claims
from safeloc.properties import stop_point as stop_claims
from safeloc.properties import travel_direction as direction_claims
from safeloc.properties import turn_off as course_claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "Odometer, balise reader, direction of travel and radar, with the course at switches, the routes on which the vehicle may be, the restrictive state and the "
    "stop at a platform behind them, in one step: reflectors are measured from where the balise machine accepted a group, a direction that is not the permitted "
    "one ends the position, and one is passed on only while a route is carried."
)
REPORTED = interval_of_the_host(truth="truth_nm")


def target(config: ReflectorDeviceConfig) -> Target:
    """Make the composition, with the properties of each of its machines."""
    whole = reflector_device.compose_machines(config)
    properties = tuple(claims.properties(whole))
    system = whole.composition.system
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), REPORTED, partial(_simulated, config),
        members=_members(whole),
    )  # fmt: skip


def _members(whole: ReflectorDevice) -> dict[str, tuple[Property, ...]]:
    """The properties of each machine by itself; motion, the look-ups of the map and the radar's frame have none."""
    return {
        whole.groups.machine.name: tuple(balise_claims.properties(whole.groups)),
        whole.direction.machine.name: tuple(direction_claims.properties(whole.direction)),
        whole.source.machine.name: tuple(reflector_claims.properties(whole.source)),
        whole.course.machine.name: tuple(course_claims.properties(whole.course)),
        whole.route.machine.name: tuple(route_claims.properties(whole.route)),
        whole.restrictive.name: tuple(delocalized_claims.properties(whole.restrictive, whole.config.host)),
        whole.stop.machine.name: tuple(stop_claims.properties(whole.stop)),
    }


def _simulated(config: ReflectorDeviceConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.reflector_device.simulate import simulated  # numpy is loaded only where something is simulated

    return simulated(config, seed)


ENTRIES = (
    Entry(
        NAME,
        "balises and reflectors as one device: odometer, balise reader, direction of travel, radar, course and route through switches, restrictive "
        "state, stop at a platform",
        ReflectorDeviceConfig,
        target,
        Family.MARKERS,
        place=70,
        simulates=True,
        members=(
            "motion",
            "balise",
            "line",
            "met",
            "travel_direction",
            "reflector",
            "turn_off",
            "radar",
            "starts",
            "route",
            "delocalized",
            "stop_point",
        ),
        pairs_of=("balise", "reflector", "turn_off", "route", "stop_point"),
        configurations=CONFIGURATIONS,
        records_of={"front_wheel_mm": "motion.odometer_mm"},
        hazard=Hazard(
            "a false course or branch through a switch is reported, the train is not braked in time for its stop, or it keeps a position without a branch "
            "or while it runs against its permitted direction",
            (
                "turn_off: course is true",
                "brake order in time",
                "a contradicted direction withdraws the position",
                "travel_direction: direction is true",
                "a lost route withdraws the position",
                "route: the decided route is true",
            ),
        ),
    ),
)
