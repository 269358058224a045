"""The catalogue entry of reflectors with the direction of travel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.language.spec import Property
from safeloc.models import reflector_direction
from safeloc.models.delocalized.reported import interval_of_the_host
from safeloc.models.reflector_direction import NAME, ReflectorDirection
from safeloc.models.reflector_direction.configuration import ReflectorDirectionConfig
from safeloc.models.reflector_direction.configurations import CONFIGURATIONS
from safeloc.properties import balise as balise_claims
from safeloc.properties import delocalized as delocalized_claims
from safeloc.properties import reflector as reflector_claims
from safeloc.properties import reflector_direction as claims
from safeloc.properties import travel_direction as direction_claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Hazard, Target, recorded

DOC = (
    "Odometer, balise reader and radar, with the direction of travel by the reflectors around a group, and the restrictive state behind "
    "them, in one step: a direction that is not the permitted one ends the position."
)
REPORTED = interval_of_the_host(truth="truth_nm")


def target(config: ReflectorDirectionConfig) -> Target:
    """Make the composition, with the properties of each of its machines."""
    whole = reflector_direction.compose_machines(config)
    properties, system = tuple(claims.properties(whole)), whole.composition.system
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), REPORTED, partial(_simulated, config),
        members=_members(whole),
    )  # fmt: skip


def _members(whole: ReflectorDirection) -> dict[str, tuple[Property, ...]]:
    """The properties of each machine by itself; motion and the line have none."""
    return {
        whole.groups.machine.name: tuple(balise_claims.properties(whole.groups)),
        whole.direction.machine.name: tuple(direction_claims.properties(whole.direction)),
        whole.source.machine.name: tuple(reflector_claims.properties(whole.source)),
        whole.restrictive.name: tuple(delocalized_claims.properties(whole.restrictive, whole.config.host)),
    }


def _simulated(config: ReflectorDirectionConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.reflector_direction.simulate import (
        simulated,
    )  # numpy is loaded only where something is simulated

    return simulated(config, seed)


ENTRIES = (
    Entry(
        NAME,
        "reflectors and direction of travel as one device: odometer, balise reader, direction by reflector models, radar, restrictive state",
        ReflectorDirectionConfig,
        target,
        Family.MARKERS,
        place=75,
        simulates=True,
        members=("motion", "balise", "line", "travel_direction", "reflector", "delocalized"),
        pairs_of=("balise", "reflector"),
        configurations=CONFIGURATIONS,
        records_of={"front_wheel_mm": "motion.odometer_mm"},
        hazard=Hazard(
            "a train that runs against its permitted direction keeps a position",
            ("a contradicted direction withdraws the position", "travel_direction: direction is true"),
        ),
    ),
)
