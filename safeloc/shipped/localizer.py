"""The localizer and what it adds to its sources: arbitration between them, and positions on their way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from pydantic import BaseModel

from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.models import (
    arbitration,
    balise,
    delocalized,
    localizer,
    localizer_sections,
    odometry,
    reflector,
    satellite_selection,
    transmission,
    verification,
)
from safeloc.models.arbitration import configurations as arbitration_configurations
from safeloc.models.localizer import LocalizerConfig, OwnSource
from safeloc.models.localizer import configurations as localizer_configurations
from safeloc.models.localizer import picture as localizer_picture
from safeloc.models.localizer_sections import LocalizerSectionsConfig
from safeloc.models.transmission import configurations as transmission_configurations
from safeloc.properties import arbitration as arbitration_properties
from safeloc.properties import balise as balise_properties
from safeloc.properties import delocalized as delocalized_properties
from safeloc.properties import localizer as localizer_properties
from safeloc.properties import localizer_sections as localizer_sections_properties
from safeloc.properties import odometry as odometry_properties
from safeloc.properties import own_source as own_source_properties
from safeloc.properties import reflector as reflector_properties
from safeloc.properties import satellite_selection as selection_properties
from safeloc.properties import transmission as transmission_properties
from safeloc.properties import verification as verification_properties
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.shipped.making import recorded, single
from safeloc.target import Entry, Target


def _arbitration(config: BaseModel) -> Target:
    assert isinstance(config, arbitration.ArbitrationConfig)
    model = arbitration.build(arbitration.parts(config))
    made = single(model.machine, arbitration_properties.properties(model), config)
    return replace(made, reported=Reported())


def _transmission(config: BaseModel) -> Target:
    assert isinstance(config, transmission.TransmissionConfig)
    model = transmission.build(transmission.parts(config))
    made = single(model.machine, transmission_properties.properties(model), config)
    return replace(made, reported=Reported())


def _localizer(config: BaseModel) -> Target:
    assert isinstance(config, LocalizerConfig)
    return localized(localizer.compose_machines(config), config)


def localized(whole: localizer.Localizer, config: LocalizerConfig) -> Target:
    """Return a localizer with its claims, recordings and picture."""
    doc = (
        "All ways of locating of one vehicle in one step: what those that state a position have in common, led by the one with "
        "the smallest margin; nothing where they exclude each other; and what the trackside sees of it."
    )
    properties = tuple(localizer_properties.properties(whole))
    system, streams = whole.composition.system, recorded("localizer")
    return Target(
        "localizer", whole.machines, system, properties, config, doc, streams, localizer_picture.PASSED_ON,
        partial(_simulated, config), (localizer_picture.picture(config, _says),), members=_members(whole),
    )  # fmt: skip


def _members(whole: localizer.Localizer) -> dict[str, tuple[Property, ...]]:
    """What is claimed of each machine by itself; of `motion` and of the satellites' position nothing is."""
    config = whole.config
    guard = delocalized.DelocalizedConfig(
        tolerance_mm=config.tolerance_mm, position_limit_mm=config.motion.position_limit_mm
    )
    links = [link for link in (whole.downlink, whole.uplink) if link is not None]
    own = {whole.guard.name: tuple(delocalized_properties.properties(whole.guard, guard))}
    for model in [one for piece in whole.pieces.values() for one in piece.models] + [*links, whole.arbitration]:
        machine, claims = _claimed(model)
        own[machine.name] = tuple(claims)
    return own


def _claimed(model: object) -> tuple[Machine, Sequence[Property]]:
    match model:
        case odometry.Odometry():
            return model.machine, odometry_properties.properties(model)
        case balise.Balise():
            return model.machine, balise_properties.properties(model)
        case reflector.ReflectorMachine():
            return model.machine, reflector_properties.properties(model)
        case satellite_selection.Selection():
            return model.machine, selection_properties.properties(model)
        case verification.Verification():
            return model.machine, verification_properties.properties(model)
        case transmission.Transmission():
            return model.machine, transmission_properties.properties(model)
        case OwnSource():
            return model.machine, own_source_properties.properties(model)
        case arbitration.Arbitration():
            return model.machine, arbitration_properties.properties(model)
        case _:
            raise TypeError(f"nothing is known of what is claimed of {model!r}")


def _says(recording: str) -> str:
    """Return the expected outcome of a shipped recording; empty for any other."""
    from safeloc.models.localizer.simulation.recordings import RUNS  # numpy is loaded only where a picture is drawn

    run = RUNS.get(recording.removeprefix("localizer-"))
    return run.says if run else ""


def _simulated(config: LocalizerConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    """A nominal journey, the sensors' errors by the seed."""
    from safeloc.models.localizer.simulation.recordings import (
        simulated,  # numpy is loaded only where something is simulated
    )

    return simulated(config, seed)


def _localizer_sections(config: BaseModel) -> Target:
    assert isinstance(config, LocalizerSectionsConfig)
    whole = localizer_sections.compose_machines(config)
    doc = (
        "A vehicle that locates itself, and the virtual sections that it runs through, in one step: the position that is "
        "passed on on board goes by radio, its age charged, to the line area that follows the train."
    )
    properties = tuple(localizer_sections_properties.properties(whole))
    system, streams = whole.composition.system, recorded(localizer_sections.NAME)
    return Target(
        localizer_sections.NAME, system.machines, system, properties, config, doc, streams, localizer_picture.PASSED_ON,
        pictures=(localizer_picture.picture(config.localizer, _says_of_sections),), members=_members(whole.localizer),
    )  # fmt: skip


def _says_of_sections(recording: str) -> str:
    """Return the expected outcome of a shipped recording; empty for any other."""
    from safeloc.models.localizer_sections.simulate import SCENES  # numpy is loaded only where a picture is drawn

    scene = SCENES.get(recording.removeprefix(f"{localizer_sections.NAME}-"))
    return scene.says if scene else ""


ENTRIES = (
    Entry(
        "arbitration",
        "what several positions have in common",
        arbitration.ArbitrationConfig,
        _arbitration,
        arbitration_configurations.CONFIGURATIONS,
    ),
    Entry(
        "transmission",
        "a position on its way; its age is charged",
        transmission.TransmissionConfig,
        _transmission,
        transmission_configurations.CONFIGURATIONS,
    ),
    Entry(
        "localizer",
        "all ways of locating together, and which of them counts",
        LocalizerConfig,
        _localizer,
        localizer_configurations.CONFIGURATIONS,
    ),
    Entry(
        "localizer_sections",
        "the located train in virtual sections: one truth on board and trackside",
        LocalizerSectionsConfig,
        _localizer_sections,
    ),
)
