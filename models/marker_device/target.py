"""The catalogue entry of the marker device."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from safeloc.language.spec import Property
from safeloc.models import marker_device
from safeloc.models.delocalized.reported import interval_of_the_host
from safeloc.models.marker_device import NAME, MarkerDevice, restrictive_config
from safeloc.models.marker_device.configuration import MarkerDeviceConfig
from safeloc.models.marker_device.configurations import CONFIGURATIONS
from safeloc.properties import delocalized as delocalized_claims
from safeloc.properties import guard as guard_claims
from safeloc.properties import marker_device as claims
from safeloc.properties import odometry as odometry_claims
from safeloc.properties.odometry import faults
from safeloc.runtime.streams.steps import Cell
from safeloc.target import Entry, Family, Target, recorded

DOC = (
    "Readers at both ends, odometers, and a receiver whose guard's positions stand in for markers, with the restrictive state "
    "behind them, in one step: what the host of a vehicle sees."
)
REPORTED = interval_of_the_host(truth="truth_nm")


def target(config: MarkerDeviceConfig) -> Target:
    """Make the composition, with the properties of each of its machines."""
    whole = marker_device.compose_machines(config)
    properties, system = tuple(claims.properties(whole)), whole.composition.system
    return Target(
        NAME, system.machines, system, properties, config, DOC, recorded(NAME), REPORTED, partial(_simulated, config),
        members=_members(whole),
    )  # fmt: skip


def _members(whole: MarkerDevice) -> dict[str, tuple[Property, ...]]:
    """The properties of each machine by itself; the vehicle computes nothing and has none."""
    source, config = whole.source, whole.config
    with_fault = faults.properties(source) if config.odometry.single_fault_safe else []
    return {
        whole.receiver.machine.name: tuple(guard_claims.properties(whole.receiver)),
        source.machine.name: (*odometry_claims.properties(source), *with_fault),
        whole.restrictive.name: tuple(delocalized_claims.properties(whole.restrictive, restrictive_config(config))),
    }


def _simulated(config: MarkerDeviceConfig, seed: int) -> Sequence[Mapping[str, Cell]]:
    from safeloc.models.marker_device.simulate import simulated  # numpy is loaded only where something is simulated

    return simulated(config, seed)


ENTRIES = (
    Entry(
        NAME,
        "markers and satellites as one device: readers, odometers, guarded receiver, restrictive state",
        MarkerDeviceConfig,
        target,
        Family.ODOMETRY,
        place=40,
        simulates=True,
        members=("vehicle", "guard", "odometry", "delocalized"),
        pairs_of=("odometry", "guard"),
        configurations=CONFIGURATIONS,
    ),
)
