"""The margin by the rules of the line audit, with this vehicle's figures."""

from __future__ import annotations

from safeloc.language.expr import TRUE, Bool, Num
from safeloc.models.balise.variables import BaliseConfig, Parts
from safeloc.models.layout_rules import LayoutConfig, odometry_error_nm


def layout(config: BaliseConfig) -> LayoutConfig:
    """Return the audit's figures for this vehicle."""
    return LayoutConfig(
        tolerance_mm=config.tolerance_mm,
        odometry_constant_mm=config.odometer.constant_mm,
        odometry_rate_ppm=config.odometer.rate_ppm,
        balise_accuracy_mm=config.default_accuracy_mm,
        detection_accuracy_mm=config.detection_mm,
        antenna_offset_mm=config.antenna_mm,
    )


def reckoned_nm(config: BaliseConfig, run_mm: Num, accuracy_mm: Num) -> Num:
    """Return the audit's odometry error, nm, after a measured distance since a group of that location accuracy."""
    return odometry_error_nm(run_mm, accuracy_mm + config.detection_mm, layout(config))


def as_reckoned(own: Parts) -> Bool:
    """Return whether the margin is at most the audit's, if the whole run since the last group was measured.

    The audit has no error that grows with time, so nothing is claimed of an odometer with such an error, nor of one that
    reports an error beyond its law.
    """
    if own.config.odometer.floor_mm_s or own.config.checked_distance:
        return TRUE
    memory = own.memory
    reckoned = reckoned_nm(own.config, memory.run, memory.accuracy)
    return memory.measured.implies(own.held.interval.margin <= reckoned)
