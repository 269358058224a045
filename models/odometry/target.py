"""The catalogue entry of the odometry machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.language.nodes import Value
from safeloc.models import odometry
from safeloc.models.odometry.configurations import CONFIGURATIONS
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.properties import odometry as claims
from safeloc.properties.odometry import faults
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Pair, Target, single


def target(config: OdometryConfig) -> Target:
    """Make the machine, of a vehicle whose devices may have a hidden fault if the configuration says so."""
    model = odometry.build(parts(config, with_fault=config.single_fault_safe))
    with_fault = faults.properties(model) if config.single_fault_safe else []
    properties = (*claims.properties(model), *with_fault)
    return single(
        model.machine, properties, config, reported=Reported(), simulate=lambda seed: _simulated(config, seed)
    )


def _simulated(config: OdometryConfig, seed: int) -> Sequence[Mapping[str, Value]]:
    from safeloc.models.odometry.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


ENTRIES = (
    Entry(
        "odometry",
        "odometry between markers read at the front and at the rear",
        OdometryConfig,
        target,
        Family.ODOMETRY,
        place=10,
        simulates=True,
        configurations=CONFIGURATIONS,
        pairs=(
            Pair("rate beside constant", "first_unit.constant_mm:down", "first_unit.rate_ppm:up"),
            Pair("constant beside rate", "first_unit.rate_ppm:down", "first_unit.constant_mm:up"),
            Pair("creep beside rate", "first_unit.rate_ppm:down", "first_unit.floor_mm_s:up"),
            Pair("drift beside constant", "first_unit.constant_mm:down", "first_unit.drift_mm_s2:up"),
            Pair("constant beside accuracy of markers", "marker_accuracy_mm:down", "first_unit.constant_mm:up"),
        ),
    ),
)
