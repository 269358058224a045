"""Odometry with the delocalized machine behind it: the position that the host of a vehicle gets (MRK-D1, MRK-D2).

Both act in one step: the cycle in which odometry loses its last usable value is the cycle in which the vehicle is
delocalized and restrictive.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Expr, Var
from safeloc.language.machine import Machine
from safeloc.models import delocalized, odometry
from safeloc.models.odometry.variables import OdometryConfig, parts


@dataclass(frozen=True, eq=False)
class Supervised:
    """The composition and its machines."""

    composition: Composition
    source: odometry.Odometry
    guard: Machine


def compose_machines(config: OdometryConfig | None = None) -> Supervised:
    """Wire odometry to the delocalized machine; both share one truth. InputError for positions of satellites, which nothing here checks."""
    config = config or OdometryConfig()
    if config.satellite_markers:
        raise InputError(
            "satellite_markers must be false here: nothing checks such positions; marker_device has the guard that does."
        )
    source = odometry.build(parts(config))
    own = delocalized.parts(
        delocalized.DelocalizedConfig(tolerance_mm=config.tolerance_mm, position_limit_mm=config.position_limit_mm)
    )
    guard = delocalized.build(own)
    wires: dict[Var, Expr] = {**own.reads(source.machine), own.next_truth: source.own.ghosts.truth}
    composition = compose("supervised_odometry", [source.machine, guard], wires, discharge=[guard])
    return Supervised(composition, source, guard)
