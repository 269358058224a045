"""Odometry with the delocalized machine behind it: what the host of a vehicle sees (MRK-D1, MRK-D2).

Both act in one step: the cycle in which odometry loses its last usable value is the cycle in which the vehicle is
delocalized and restrictive.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import BoolVar, Expr, NumVar, Var
from safeloc.language.machine import Machine
from safeloc.models import delocalized, odometry
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.models.vocabulary.absent import heard_interval


@dataclass(frozen=True, eq=False)
class Supervised:
    """The composition and its machines."""

    composition: Composition
    source: odometry.Odometry
    guard: Machine


def compose_machines(config: OdometryConfig | None = None) -> Supervised:
    """Odometry wired to the delocalized machine; both share one truth."""
    config = config or OdometryConfig()
    source = odometry.build(parts(config))
    guard = delocalized.machine(
        delocalized.DelocalizedConfig(tolerance_mm=config.tolerance_mm, position_limit_mm=config.position_limit_mm)
    )
    sees, says = {var.name: var for var in guard.inputs if isinstance(var, (NumVar, BoolVar))}, source.machine
    position, below, above = heard_interval(says)
    wires: dict[Var, Expr] = {
        sees["source_valid"]: says.flag("valid"),
        sees["reference_accepted"]: says.flag("reference_accepted"),
        sees["source_reason"]: says.output("reason"),
        sees["source_position_mm"]: position,
        sees["source_margin_above_mm"]: above,
        sees["source_margin_below_mm"]: below,
        next(iter(guard.world.choices)): source.own.ghosts.truth,
    }
    return Supervised(compose("supervised_odometry", [says, guard], wires, discharge=[guard]), source, guard)
