"""Properties of odometry: the reason that is given when a position is withdrawn (MRK-D1)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, abs_, all_of, any_of
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.models.odometry import Odometry
from safeloc.models.odometry.distance_device import Device
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reasons import CONTRADICTION, SENSOR_FAILURE, TOLERANCE


def properties(model: Odometry, law: str) -> Iterator[Property]:
    """Yield what is claimed of the reason, in both directions."""
    own, valid = model.own, model.machine.flag("valid")
    withdrawn = earlier_bool(valid) & ~valid
    ended = any_of(_had_a_position(device) & _sensors_end_it(own.config, device) for device in own.devices)
    yield always(
        "a failure of sensors is stated only of a device in use",
        (withdrawn & own.reason.eq(SENSOR_FAILURE)).implies(ended),
        statement="when a position is withdrawn for a failure of sensors, a device that had a position was without distances "
        "for too long, or has run too far or too long since its reading; a device at an end that had none does not count",
        requirements=("MRK-D1",),
        assumption=law,
    )
    yield always(
        "tolerance is not stated where sensors failed",
        (withdrawn & own.reason.eq(TOLERANCE)).implies(~ended),
        statement="when a position is withdrawn for tolerance, no device that had a position was without distances for too long, "
        "nor has it run too far or too long since its reading",
        requirements=("MRK-D1",),
        unconditional=True,
    )
    yield always(
        "a withdrawal has its reason",
        withdrawn.implies(own.reason.one_of(SENSOR_FAILURE, TOLERANCE, CONTRADICTION)),
        statement="the reason of the cycle in which a position is withdrawn is a failure of sensors, the tolerance or a contradiction",
        requirements=("MRK-D1",),
        unconditional=True,
    )


def _had_a_position(device: Device) -> Bool:
    return any_of(earlier_bool(unit.alive) for unit in device.units)


def _sensors_end_it(config: OdometryConfig, device: Device) -> Bool:
    """The device is silent, or checked by nothing, for too long; or its reading lies too far or too long ago."""
    silent = all_of(unit.gap > config.gap_limit_cycles for unit in device.units)
    unchecked = any_of(unit.gap > config.lone_limit_cycles for unit in device.units)
    too_old = earlier_num(device.age) + config.period_ms > config.age_limit_ms
    return silent | unchecked | too_old | _too_far(config, device)


def _too_far(config: OdometryConfig, device: Device) -> Bool:
    run = earlier_num(device.run)
    return any_of(
        unit.last_verdict.eq(ADMITTED) & (run + abs_(unit.measured.value) > config.position_limit_mm)
        for unit in device.units
    )
