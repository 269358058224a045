"""The localizer and what it adds to its sources: arbitration between them, and positions on their way."""

from __future__ import annotations

from dataclasses import replace

from pydantic import BaseModel

from safeloc.models import arbitration, transmission
from safeloc.properties import arbitration as arbitration_properties
from safeloc.properties import transmission as transmission_properties
from safeloc.reported import Reported
from safeloc.shipped.making import single
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


ENTRIES = (
    Entry("arbitration", "what several positions have in common", arbitration.ArbitrationConfig, _arbitration),
    Entry("transmission", "a position on its way; its age is charged", transmission.TransmissionConfig, _transmission),
)
