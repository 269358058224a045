"""Odometry between markers, the restrictive state behind it, and both in one step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pydantic import BaseModel

from safeloc.language.nodes import Value
from safeloc.language.system import lower
from safeloc.models import delocalized, odometry, supervised_odometry
from safeloc.models.odometry import configurations as odometry_configurations
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.properties import delocalized as delocalized_properties
from safeloc.properties import odometry as odometry_properties
from safeloc.properties import supervised_odometry as supervised_properties
from safeloc.properties.odometry import faults as odometry_fault_properties
from safeloc.reported import Reported
from safeloc.shipped.making import recorded
from safeloc.target import Entry, Target


def _odometry(config: BaseModel) -> Target:
    assert isinstance(config, OdometryConfig)
    model = odometry.build(parts(config, with_fault=config.single_fault_safe))
    with_fault = odometry_fault_properties.properties(model) if config.single_fault_safe else []
    return Target(
        "odometry",
        (model.machine,),
        lower(model.machine),
        (*odometry_properties.properties(model), *with_fault),
        config,
        model.machine.doc,
        recorded("odometry"),
        Reported(),
        lambda seed: _simulated(config, seed),
    )


def _simulated(config: OdometryConfig, seed: int) -> Sequence[Mapping[str, Value]]:
    from safeloc.models.odometry.simulate import simulate  # numpy is loaded only where something is simulated

    return simulate(config, seed=seed)


def _delocalized(config: BaseModel) -> Target:
    assert isinstance(config, delocalized.DelocalizedConfig)
    machine = delocalized.machine(config)
    properties = tuple(delocalized_properties.properties(machine, config))
    reported = Reported(valid="restrictive", valid_is=False)
    return Target("delocalized", (machine,), lower(machine), properties, config, machine.doc, reported=reported)


def _supervised(config: BaseModel) -> Target:
    assert isinstance(config, OdometryConfig)
    whole = supervised_odometry.compose_machines(config)
    machines = (whole.source.machine, whole.guard)
    properties = tuple(supervised_properties.properties(whole))
    doc = "Odometry with the delocalized machine behind it, in one step: what the host of a vehicle sees."
    reported = Reported(
        position="delocalized.position_mm",
        below="delocalized.margin_below_mm",
        above="delocalized.margin_above_mm",
        valid="delocalized.restrictive",
        valid_is=False,
        truth="odometry.truth_nm",
    )
    system = whole.composition.system
    guard = delocalized.DelocalizedConfig(tolerance_mm=config.tolerance_mm, position_limit_mm=config.position_limit_mm)
    members = {
        whole.source.machine.name: tuple(odometry_properties.properties(whole.source)),
        whole.guard.name: tuple(delocalized_properties.properties(whole.guard, guard)),
    }
    return Target("supervised_odometry", machines, system, properties, config, doc, reported=reported, members=members)


ENTRIES = (
    Entry(
        "odometry",
        "odometry between markers read at the front and at the rear",
        OdometryConfig,
        _odometry,
        odometry_configurations.CONFIGURATIONS,
    ),
    Entry("delocalized", "the restrictive state behind any source", delocalized.DelocalizedConfig, _delocalized),
    Entry("supervised_odometry", "odometry and delocalized in one step", OdometryConfig, _supervised),
)
