"""The catalogue entry of reflectors with the route."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.language.spec import Property
from safeloc.models import reflector_route
from safeloc.models.delocalized.reported import interval_of_the_host
from safeloc.models.reflector_route import NAME, ReflectorRoute
from safeloc.models.reflector_route.configuration import ReflectorRouteConfig
from safeloc.models.reflector_route.configurations import CONFIGURATIONS
from safeloc.properties import balise as balise_claims
from safeloc.properties import delocalized as delocalized_claims
from safeloc.properties import reflector as reflector_claims
from safeloc.properties import reflector_route as claims
from safeloc.properties import route as route_claims
from safeloc.properties import turn_off as course_claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "Odometer, balise reader and radar, with the routes through switches on which the vehicle may be, and the restrictive state behind them, in one step: "
    "a position is passed on only while a route is carried."
)
REPORTED = interval_of_the_host(truth="truth_nm")


def target(config: ReflectorRouteConfig) -> Target:
    """Make the composition, with the properties of each of its machines."""
    whole = reflector_route.compose_machines(config)
    properties, system = tuple(claims.properties(whole)), whole.composition.system
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), REPORTED, partial(_simulated, config),
        members=_members(whole),
    )  # fmt: skip


def _members(whole: ReflectorRoute) -> dict[str, tuple[Property, ...]]:
    """The properties of each machine by itself; motion, the look-ups of the map and the radar's frame have none."""
    return {
        whole.groups.machine.name: tuple(balise_claims.properties(whole.groups)),
        whole.course.machine.name: tuple(course_claims.properties(whole.course)),
        whole.route.machine.name: tuple(route_claims.properties(whole.route)),
        whole.source.machine.name: tuple(reflector_claims.properties(whole.source)),
        whole.restrictive.name: tuple(delocalized_claims.properties(whole.restrictive, whole.config.host)),
    }


def _simulated(config: ReflectorRouteConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.reflector_route.simulate import simulated  # numpy is loaded only where something is simulated

    return simulated(config, seed)


ENTRIES = (
    Entry(
        NAME,
        "reflectors and route as one device: odometer, balise reader, course at switches, route through switches, radar, restrictive state",
        ReflectorRouteConfig,
        target,
        Family.MARKERS,
        place=76,
        simulates=True,
        members=("motion", "balise", "starts", "radar", "turn_off", "route", "line", "reflector", "delocalized"),
        pairs_of=("balise", "reflector", "route", "turn_off"),
        configurations=CONFIGURATIONS,
        records_of={"front_wheel_mm": "motion.odometer_mm"},
        hazard=Hazard(
            "a train keeps a position, or is told a branch, that is not its own",
            ("a lost route withdraws the position", "route: the decided route is true"),
        ),
    ),
)
