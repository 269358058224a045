"""The marker device as one: readers, odometers, a receiver behind its guard, and the restrictive state (MRK-1, MRK-5, MRK-D6).

    vehicle      no machine on board: the true movement of end A, and of the antenna behind it
    guard        passes on those positions of the receiver that map and motion allow
    odometry     both readers, the distance devices at both ends and the direction of travel; positions that the guard passes on
                 set the device at end A in place of markers
    delocalized  passes the position on, or makes the vehicle restrictive

All act in one step. That a position of satellites holds end A is not assumed: the guard's containment and the antenna's place
prove it. What is assumed of the receiver is the guard's law alone.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import TRUE, Expr, Var, ite
from safeloc.language.machine import Machine
from safeloc.models import delocalized, guard, odometry
from safeloc.models.guard.variables import parts as guard_parts
from safeloc.models.marker_device.antenna import Antenna, antenna
from safeloc.models.marker_device.configuration import MarkerDeviceConfig
from safeloc.models.odometry.satellite_reading import SatelliteReader
from safeloc.models.odometry.variables import parts as odometry_parts
from safeloc.models.odometry.world import SATELLITES
from safeloc.models.vocabulary.absent import wired_interval

NAME = "marker_device"


@dataclass(frozen=True, eq=False)
class MarkerDevice:
    """The composition and its machines."""

    config: MarkerDeviceConfig
    composition: Composition
    antenna: Antenna
    receiver: guard.Guard
    source: odometry.Odometry
    restrictive: Machine


def compose_machines(config: MarkerDeviceConfig | None = None) -> MarkerDevice:
    """Compose the device of a vehicle; all machines share one truth."""
    config = config or MarkerDeviceConfig()
    vehicle = antenna(config)
    own = odometry_parts(config.odometry, with_fault=config.odometry.single_fault_safe, moved=vehicle.moved)
    receiver = guard.build(guard_parts(config.guard, truth=vehicle.place))
    source = odometry.build(own)
    behind = delocalized.parts(restrictive_config(config))
    restrictive = delocalized.build(behind)
    wires: dict[Var, Expr] = {
        receiver.own.advance: TRUE,
        receiver.own.next_truth: vehicle.place,
        **_into_odometry(config, receiver, own.satellites),
        **behind.reads(source.machine),
        behind.next_truth: own.ghosts.truth,
    }
    whole = compose(
        NAME,
        [vehicle.machine, receiver.machine, source.machine, restrictive],
        wires,
        shared=[own.ghosts.truth, own.ghosts.true_cycle_distance, vehicle.place],
        discharge=[Clause(source.machine, SATELLITES), restrictive],
    )
    return MarkerDevice(config, whole, vehicle, receiver, source, restrictive)


def restrictive_config(config: MarkerDeviceConfig) -> delocalized.DelocalizedConfig:
    """Return the limits of the restrictive state."""
    own = config.odometry
    return delocalized.DelocalizedConfig(tolerance_mm=own.tolerance_mm, position_limit_mm=own.position_limit_mm)


def _into_odometry(
    config: MarkerDeviceConfig, receiver: guard.Guard, reader: SatelliteReader | None
) -> dict[Var, Expr]:
    """The guard's interval, moved from the antenna to end A, in each cycle in which it passes a fix on."""
    assert reader is not None  # the configuration asks for it
    position, below, above = wired_interval(receiver.machine)
    passed, slack = receiver.machine.flag("passed") & receiver.machine.flag("valid"), config.antenna_tolerance_mm
    return {
        reader.place.present: passed,
        reader.place.value: ite(passed, position + config.antenna_mm, 0),
        reader.below: below + slack,
        reader.above: above + slack,
    }
