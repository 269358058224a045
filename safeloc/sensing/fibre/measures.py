"""Computes ends, speed and length of a train from its fitted course, with bounds that include every source of error."""

from __future__ import annotations

from fractions import Fraction

from safeloc.language.units import MS_PER_S
from safeloc.sensing.fibre.features import Bounds, End
from safeloc.sensing.fibre.fibre_map import FibreMap
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.sensing.fibre.reflections import Reflections, coincident
from safeloc.sensing.fibre.time_of_flight import bounds_mm, time_ps
from safeloc.sensing.fibre.tracks import Fit
from safeloc.sensing.figures import MILLION
from safeloc.sensing.rounding import ExactBounds, exactly

_HALF = Fraction(1, 2)


def at_last_frame(fit: Fit, config: FibreConfig) -> Fit:
    """Return the course at the last frame: later by half of the averaged windows, as averages belong to their middle."""
    run = fit.speed_mm_s * config.window_ms * config.detection.average_windows / MS_PER_S / 2
    return Fit(
        fit.low_mm + run,
        fit.high_mm + run,
        fit.speed_mm_s,
        fit.off_low_mm,
        fit.off_high_mm,
        fit.usual_off_mm,
        fit.apart_mm_s,
    )


def end(
    place_mm: float, off_mm: float, outward: int, config: FibreConfig, where: FibreMap, light: Reflections | None
) -> End:
    """Return a train's end from the measured place of its outermost axle; `outward` (+1, -1) points away from the train."""
    measured = _measured(place_mm, off_mm, outward, config)
    index = config.interrogator.index_ppm
    flight = ExactBounds(time_ps(measured.low, index), time_ps(measured.high, index)).widened(
        config.interrogator.trigger_error_ps
    )
    fibre = bounds_mm(flight, index, config.interrogator.index_error_ppm)
    points = coincident(light, float(measured.low), float(measured.high)) if light is not None else ()
    return End(Bounds.outward(where.on_track(fibre)), Bounds.outward(fibre), Bounds.outward(flight), points)


def _measured(place_mm: float, off_mm: float, outward: int, config: FibreConfig) -> ExactBounds:
    """Return bounds of the end, never before the coupler: error, scatter beyond half of the error, overhang."""
    detection = config.detection
    scatter = max(Fraction(0), exactly(off_mm) - detection.end_error_mm * _HALF)
    axle = ExactBounds(exactly(place_mm), exactly(place_mm)).widened(detection.end_error_mm + scatter)
    low = axle.low - (detection.overhang_mm if outward < 0 else 0)
    high = axle.high + (detection.overhang_mm if outward > 0 else 0)
    return ExactBounds(max(low, 0), max(high, 0))


def speed(fit: Fit, config: FibreConfig) -> Bounds:
    """Return bounds of the speed along the fibre: errors of fit and index, difference of both ends, and change by traction
    and brake since the middle of the fit."""
    detection, found = config.detection, exactly(fit.speed_mm_s)
    changed = Fraction(detection.most_change_mm_s2 * detection.fit_ms, 2 * MS_PER_S)
    error = detection.speed_error_mm_s + changed + exactly(fit.apart_mm_s) / 2 + by_index(found, config)
    return Bounds.outward(ExactBounds(found, found).widened(error))


def length(fit: Fit, config: FibreConfig, where: FibreMap) -> Bounds:
    """Return bounds of the length on the track, over buffers. Errors of trigger and place cancel; scatter, map and index do not."""
    detection = config.detection
    low, high = where.path_mm(max(exactly(fit.low_mm), Fraction(0))), where.path_mm(exactly(fit.high_mm))
    scatter = max(Fraction(0), exactly(fit.off_low_mm) + exactly(fit.off_high_mm) - detection.length_error_mm)
    error = detection.length_error_mm + scatter + 2 * where.error_mm + by_index(high - low, config)
    between = ExactBounds(high - low, high - low).widened(error)
    return Bounds.outward(ExactBounds(max(between.low, 0), max(between.high, 0) + 2 * detection.overhang_mm))


def by_index(measured: Fraction, config: FibreConfig) -> Fraction:
    """Return the greatest error of a distance due to the index: real = stated (1 +- e), true = measured / (1 +- e)."""
    error = Fraction(config.interrogator.index_error_ppm, MILLION)
    return abs(measured) * error / (1 - error)
