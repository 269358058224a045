"""The catalogue entry of the localizer: all ways of locating of one vehicle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.models import (
    arbitration,
    balise,
    localizer,
    odometry,
    reflector,
    satellite_selection,
    transmission,
    verification,
)
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.localizer import LocalizerConfig, OwnSource
from safeloc.models.localizer.configurations import CONFIGURATIONS
from safeloc.models.localizer.picture import PASSED_ON, picture
from safeloc.models.reflector_anchor.line import Line
from safeloc.properties import arbitration as arbitration_claims
from safeloc.properties import balise as balise_claims
from safeloc.properties import delocalized as delocalized_claims
from safeloc.properties import localizer as claims
from safeloc.properties import odometry as odometry_claims
from safeloc.properties import own_source as own_source_claims
from safeloc.properties import reflector as reflector_claims
from safeloc.properties import satellite_selection as selection_claims
from safeloc.properties import transmission as transmission_claims
from safeloc.properties import verification as verification_claims
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Target, recorded

DOC = (
    "All ways of locating of one vehicle in one step: what those that state a position have in common, led by the one with "
    "the smallest margin; nothing where they exclude each other; and what the trackside sees of it."
)
SECTIONS = {"line": "reflector", "selection": "satellite", "position": "satellite", "verification": "fibre"}
"""Machines whose figures stand in the configuration of the source that they belong to."""


def target(config: LocalizerConfig) -> Target:
    """Make the localizer with the sources that its configuration names."""
    return localized(localizer.compose_machines(config), config)


def localized(model: localizer.Localizer, config: LocalizerConfig) -> Target:
    """Return the target of a localizer that is composed already."""
    properties, system = tuple(claims.properties(model)), model.composition.system
    return Target(
        "localizer", model.machines, system, properties, config, DOC, recorded("localizer"), PASSED_ON,
        partial(_simulated, config), (picture(config, _says),), members=properties_of_machines(model), sections=SECTIONS,
    )  # fmt: skip


def properties_of_machines(composed: localizer.Localizer) -> dict[str, tuple[Property, ...]]:
    """Return the properties of each machine by itself; `motion`, the map's line and the satellites' position have none."""
    config = composed.config
    guard = DelocalizedConfig(tolerance_mm=config.tolerance_mm, position_limit_mm=config.motion.position_limit_mm)
    links = [link for link in (composed.downlink, composed.uplink) if link is not None]
    found = {composed.guard.name: tuple(delocalized_claims.properties(composed.guard, guard))}
    for model in [one for piece in composed.pieces.values() for one in piece.models] + [*links, composed.arbitration]:
        machine, properties = _claimed(model)
        found[machine.name] = tuple(properties)
    return found


def _claimed(model: object) -> tuple[Machine, Sequence[Property]]:
    match model:
        case odometry.Odometry():
            return model.machine, odometry_claims.properties(model)
        case Line():
            return model.machine, ()
        case balise.Balise():
            return model.machine, balise_claims.properties(model)
        case reflector.ReflectorMachine():
            return model.machine, reflector_claims.properties(model)
        case satellite_selection.Selection():
            return model.machine, selection_claims.properties(model)
        case verification.Verification():
            return model.machine, verification_claims.properties(model)
        case transmission.Transmission():
            return model.machine, transmission_claims.properties(model)
        case OwnSource():
            return model.machine, own_source_claims.properties(model)
        case arbitration.Arbitration():
            return model.machine, arbitration_claims.properties(model)
        case _:
            raise TypeError(f"no properties are known for {model!r}")


def _says(recording: str) -> str:
    """Return the expected outcome of a shipped recording; empty for any other."""
    from safeloc.models.localizer.simulation.recorded_runs import RUNS  # numpy is loaded only where a picture is drawn

    run = RUNS.get(recording.removeprefix("localizer-"))
    return run.says if run else ""


def _simulated(config: LocalizerConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    """Return a nominal journey; the seed gives the sensors' errors."""
    from safeloc.models.localizer.simulation.recorded_runs import (
        simulated,  # numpy is loaded only where something is simulated
    )

    return simulated(config, seed)


LOCALIZER = Entry(
    "localizer",
    "all ways of locating together, and which of them counts",
    LocalizerConfig,
    target,
    Family.LOCALIZER,
    place=30,
    simulates=True,
    members=(
        "motion",
        "odometry",
        "balise",
        "line",
        "reflector",
        "selection",
        "position",
        "verification",
        "downlink",
        "arbitration",
        "delocalized",
        "uplink",
    ),
    pairs_of=("odometry", "balise", "reflector", "selection", "verification"),
    configurations=CONFIGURATIONS,
    silent=("reflector", "selection", "position", "verification", "downlink", "uplink"),
    records_of={"front_wheel_mm": "motion.odometer_mm", "front_radar_mm": "motion.check_mm"},
)
ENTRIES = (LOCALIZER,)
