"""The catalogue entry of odometry with the restrictive state behind it."""

from __future__ import annotations

from safeloc.models import supervised_odometry
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.delocalized.reported import interval_of_the_host
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.properties import delocalized as delocalized_claims
from safeloc.properties import odometry as odometry_claims
from safeloc.properties import supervised_odometry as claims
from safeloc.target import Entry, Family, Target

DOC = "Odometry with the delocalized machine behind it, in one step: what the host of a vehicle sees."
REPORTED = interval_of_the_host(truth="odometry.truth_nm")


def target(config: OdometryConfig) -> Target:
    """Make the composition, with the properties of each of its two machines."""
    model = supervised_odometry.compose_machines(config)
    machines = (model.source.machine, model.guard)
    properties = tuple(claims.properties(model))
    guard = DelocalizedConfig(tolerance_mm=config.tolerance_mm, position_limit_mm=config.position_limit_mm)
    members = {
        model.source.machine.name: tuple(odometry_claims.properties(model.source)),
        model.guard.name: tuple(delocalized_claims.properties(model.guard, guard)),
    }
    system = model.composition.system
    return Target("supervised_odometry", machines, system, properties, config, DOC, reported=REPORTED, members=members)


ENTRIES = (
    Entry(
        "supervised_odometry",
        "odometry and delocalized in one step",
        OdometryConfig,
        target,
        Family.ODOMETRY,
        place=30,
        members=("odometry", "delocalized"),
        pairs_of=("odometry",),
    ),
)
