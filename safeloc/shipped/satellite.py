"""Satellites chosen against a map-bound prediction."""

from __future__ import annotations

from pydantic import BaseModel

from safeloc.models import (
    satellite,
    satellite_selection,
)
from safeloc.models.satellite_parts.variables import SatelliteConfig
from safeloc.properties import satellite as satellite_properties
from safeloc.properties import satellite_selection as selection_properties
from safeloc.reported import Reported
from safeloc.shipped.making import single
from safeloc.target import Entry, Target


def _selection(config: BaseModel) -> Target:
    assert isinstance(config, satellite_selection.SelectionConfig)
    model = satellite_selection.build(satellite_selection.parts(config))
    return single(model.machine, selection_properties.properties(model), config)


def _satellite(config: BaseModel) -> Target:
    assert isinstance(config, SatelliteConfig)
    whole = satellite.compose_machines(config)
    machines = (whole.selection.machine, whole.machine)
    properties = tuple(satellite_properties.properties(whole))
    doc = "Selection of usable satellites, and position along the track from them alone, in one step."
    reported = Reported(
        position="position.position_mm",
        under="position.under_mm",
        over="position.over_mm",
        valid="position.valid",
        truth="position.truth_nm",
    )
    return Target("satellite", machines, whole.composition.system, properties, config, doc, reported=reported)


ENTRIES = (
    Entry(
        "selection",
        "usable satellites, by a map-bound prediction",
        satellite_selection.SelectionConfig,
        _selection,
    ),
    Entry("satellite", "position along the track from usable satellites", SatelliteConfig, _satellite),
)
