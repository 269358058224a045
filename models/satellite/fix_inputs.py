"""From a solution in exact figures to the position machine's inputs: whole mm and um/s, rounded outward."""

from __future__ import annotations

import math
from fractions import Fraction

from safeloc.language.units import NM_PER_MM, UM_PER_MM
from safeloc.models.satellite.ahead import Ahead
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.sensing.rounding import Interval, outward
from safeloc.sensing.satellite.solution import Solution

StepValues = dict[str, int | bool | str]


def no_fix(missing: str) -> StepValues:
    """A cycle without a solution, and why."""
    return {
        "position.fix_protection_mm": 0,
        "position.fix_speed_um_s": 0,
        "position.fix_speed_protection_um_s": 0,
        "position.fix_unknowns": 2,
        "position.fix_missing": missing,
    }


def fix_inputs(solution: Solution, ahead: Ahead, offset_s: float, config: SatelliteConfig) -> StepValues:
    """The solution as inputs. `offset_s`: how long after the cycle's time it was measured.

    A place that is not solved is anywhere within the predicted bounds, a speed that is not solved any that a vehicle has.
    OUT_OF_RANGE where the machine's inputs cannot hold the place, or no vehicle has the speed.
    """
    place_mm, error_mm = outward(_place_nm(solution, ahead, offset_s), NM_PER_MM)
    speed = _speed_um_s(solution, ahead, offset_s, config)
    if abs(place_mm) > config.position_limit_mm or error_mm > 10 * config.protection_limit_mm or speed is None:
        return no_fix("OUT_OF_RANGE")
    speed_um_s, speed_error_um_s = outward(speed)
    return {
        "position.fix_mm": place_mm,
        "position.fix_protection_mm": error_mm,
        "position.fix_speed_um_s": speed_um_s,
        "position.fix_speed_protection_um_s": speed_error_um_s,
        "position.fix_unknowns": solution.unknowns,
        "position.fix_missing": "NOTHING",
    }


def _place_nm(solution: Solution, ahead: Ahead, offset_s: float) -> Interval:
    """Brought to the time of the cycle at the predicted speed, whose margin counts for the time between."""
    found = solution.off_mm()
    if found is None:
        return Interval(ahead.low_nm, ahead.high_nm)
    late_s, gained = Fraction(abs(offset_s)), Fraction(ahead.max_acceleration_mm_s2) * NM_PER_MM / 2
    drift = math.ceil(ahead.speed_margin_um_s * UM_PER_MM * late_s + gained * late_s**2)
    return Interval(found.low * NM_PER_MM, found.high * NM_PER_MM).widened(drift).moved(ahead.position_nm)


def _speed_um_s(solution: Solution, ahead: Ahead, offset_s: float, config: SatelliteConfig) -> Interval | None:
    """Within what a vehicle has; None where it has none of these speeds."""
    fast, found = config.max_speed_mm_s * UM_PER_MM, solution.speed_off_mm_s()
    if found is None:
        return Interval(-fast, fast)
    gained = math.ceil(Fraction(abs(offset_s)) * ahead.max_acceleration_mm_s2 * UM_PER_MM)
    whole = Interval(found.low * UM_PER_MM, found.high * UM_PER_MM).widened(gained).moved(ahead.speed_um_s)
    low, high = max(whole.low, -fast), min(whole.high, fast)
    return Interval(low, high) if low <= high else None
