"""The catalogue entries of a position from satellites: with trusted signals, and with nothing assumed of any signal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.language.spec import Property
from safeloc.models import satellite
from safeloc.models.satellite.configurations import CONFIGURATIONS
from safeloc.models.satellite.picture import BOUNDED, REPORTED, pictures
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.properties import satellite as claims
from safeloc.properties import satellite_selection as selection_claims
from safeloc.reported import Reported
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Target, recorded

DOC = "Selection of usable satellites, and position along the track from them alone, in one step."
_DRIFT_DOC = "The same machines, with nothing assumed of any signal: how far false signals can lead the position away."


def target(config: SatelliteConfig) -> Target:
    """Make the composition in a world whose signals obey their laws."""
    model = satellite.compose_machines(config)
    return _target(model, claims.properties(model), config, DOC, REPORTED)


def drifting(config: SatelliteConfig) -> Target:
    """Make the composition in a world in which only the odometry is trusted."""
    model = satellite.compose_machines(config, trusted="odometry")
    return _target(model, claims.drift_properties(model), config, _DRIFT_DOC, BOUNDED)


def _target(
    model: satellite.Satellite, properties: Sequence[Property], config: SatelliteConfig, doc: str, reported: Reported
) -> Target:
    system, machines = model.composition.system, (model.selection.machine, model.machine)
    members = {model.selection.machine.name: tuple(selection_claims.properties(model.selection))}
    return Target(
        system.name, machines, system, tuple(properties), config, doc, recorded(system.name), reported,
        lambda seed: _simulated(config, seed), pictures(reported, config), members=members,
    )  # fmt: skip


def _simulated(config: SatelliteConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.satellite.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "satellite",
        "position along the track from usable satellites",
        SatelliteConfig,
        target,
        Family.SATELLITES,
        place=20,
        simulates=True,
        members=("selection", "position"),
        pairs_of=("selection",),
        configurations=CONFIGURATIONS,
        silent=("selection", "position"),
    ),
    Entry(
        "satellite_drift",
        "how far false signals can lead that position away",
        SatelliteConfig,
        drifting,
        Family.SATELLITES,
        place=30,
        simulates=True,
        members=("selection", "position"),
        pairs_of=("selection",),
        configurations=CONFIGURATIONS,
        silent=("selection", "position"),
    ),
)
