"""Satellites chosen against a map-bound prediction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from pydantic import BaseModel

from safeloc.language.spec import Property
from safeloc.models import satellite, satellite_selection
from safeloc.models.satellite import configurations as satellite_configurations
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.satellite_selection import configurations as satellite_selection_configurations
from safeloc.properties import satellite as satellite_properties
from safeloc.properties import satellite_selection as selection_properties
from safeloc.railway.pictures import Deviation, Picture, Standing, Standings, Stanford
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.sensing.satellite.channels import satellite_name
from safeloc.shipped.making import recorded, single
from safeloc.target import Entry, Target

REPORTED = Reported(
    position="position.position_mm",
    below="position.margin_below_mm",
    above="position.margin_above_mm",
    valid="position.valid",
    truth="position.truth_nm",
)
BOUNDED = Reported(
    position="position.position_mm",
    below="position.drift_bound_mm",
    above="position.drift_bound_mm",
    valid="position.drift_checked",
    truth="position.truth_nm",
)


def _selection(config: BaseModel) -> Target:
    assert isinstance(config, satellite_selection.SelectionConfig)
    model = satellite_selection.build(satellite_selection.parts(config))
    made = single(model.machine, selection_properties.properties(model), config)
    return replace(made, simulate=lambda seed: _selection_simulated(config, seed))


def _selection_simulated(config: satellite_selection.SelectionConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.satellite.simulate import (
        simulate_selection,  # numpy is loaded only where something is simulated
    )

    return simulate_selection(config, seed=seed)


def _satellite(config: BaseModel) -> Target:
    assert isinstance(config, SatelliteConfig)
    whole = satellite.compose_machines(config)
    doc = "Selection of usable satellites, and position along the track from them alone, in one step."
    return _target(whole, satellite_properties.properties(whole), config, doc, REPORTED)


def _satellite_drift(config: BaseModel) -> Target:
    assert isinstance(config, SatelliteConfig)
    whole = satellite.compose_machines(config, trusted="odometry")
    doc = "The same machines, with nothing assumed of any signal: how far false signals can lead the position away."
    return _target(whole, satellite_properties.drift_properties(whole), config, doc, BOUNDED)


def _target(
    whole: satellite.Satellite, properties: Sequence[Property], config: SatelliteConfig, doc: str, reported: Reported
) -> Target:
    system, machines = whole.composition.system, (whole.selection.machine, whole.machine)
    streams, pictures = recorded(system.name), _pictures(reported, config)
    members = {whole.selection.machine.name: tuple(selection_properties.properties(whole.selection))}
    return Target(
        system.name, machines, system, tuple(properties), config, doc, streams, reported,
        lambda seed: _simulated(config, seed), pictures, members=members,
    )  # fmt: skip


def _pictures(reported: Reported, config: SatelliteConfig) -> tuple[Picture, ...]:
    """List the pictures of every recorded run."""
    channels = [f"selection.channel_{number}" for number in range(1, config.selection.channels + 1)]
    rows = tuple(Standing(f"{channel}_standing", f"{channel}_held") for channel in channels)
    return (
        Deviation("Deviation along the track", reported, config.tolerance_mm, mode="position.mode"),
        Standings("Satellites by channel", reported, rows, satellite_name),
        Stanford("Error against the margin stated for it", reported, config.tolerance_mm),
    )


def _simulated(config: SatelliteConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.satellite.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "selection",
        "usable satellites, by a map-bound prediction",
        satellite_selection.SelectionConfig,
        _selection,
        satellite_selection_configurations.CONFIGURATIONS,
    ),
    Entry(
        "satellite",
        "position along the track from usable satellites",
        SatelliteConfig,
        _satellite,
        satellite_configurations.CONFIGURATIONS,
    ),
    Entry(
        "satellite_drift",
        "how far false signals can lead that position away",
        SatelliteConfig,
        _satellite_drift,
        satellite_configurations.CONFIGURATIONS,
    ),
)
