"""The localizer and what it adds to its sources: arbitration between them, and positions on their way."""

from __future__ import annotations

from dataclasses import replace

from pydantic import BaseModel

from safeloc.models import arbitration, localizer, transmission
from safeloc.models.localizer import LocalizerConfig
from safeloc.properties import arbitration as arbitration_properties
from safeloc.properties import localizer as localizer_properties
from safeloc.properties import transmission as transmission_properties
from safeloc.reported import Reported
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
    whole = localizer.compose_machines(config)
    doc = (
        "All ways of locating of one vehicle in one step: what those that state a position have in common, led by the one with "
        "the smallest margin; nothing where they exclude each other; and what the trackside sees of it."
    )
    reported = Reported(
        position="delocalized.position_mm",
        under="delocalized.under_mm",
        over="delocalized.over_mm",
        valid="delocalized.restrictive",
        valid_is=False,
    )
    properties = tuple(localizer_properties.properties(whole))
    system, streams = whole.composition.system, recorded("localizer")
    return Target("localizer", whole.machines, system, properties, config, doc, streams, reported)


ENTRIES = (
    Entry("arbitration", "what several positions have in common", arbitration.ArbitrationConfig, _arbitration),
    Entry("transmission", "a position on its way; its age is charged", transmission.TransmissionConfig, _transmission),
    Entry("localizer", "all ways of locating together, and which of them counts", LocalizerConfig, _localizer),
)
