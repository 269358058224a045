"""From a solution in exact figures to the position machine's inputs: whole mm and um/s, rounded outward.

The machine itself adds the error that the signals bring into the solution: its input for that is the dilution. The inputs `further`
are all other errors: of the map, the bend of the track, rounding, and the time between epoch and cycle.
"""

from __future__ import annotations

import math
from fractions import Fraction

from safeloc.language.units import NM_PER_MM, UM_PER_MM
from safeloc.models.satellite.ahead import Ahead
from safeloc.models.satellite.variables import MAX_DILUTION_PERMILLE, SatelliteConfig
from safeloc.sensing.rounding import ExactBounds, outward
from safeloc.sensing.satellite.solution import Solution

StepValues = dict[str, int | bool | str]


def no_fix(missing: str) -> StepValues:
    """Return the inputs of a cycle without a solution, with the reason."""
    return {
        "position.fix_dilution_permille": 0,
        "position.fix_further_mm": 0,
        "position.fix_speed_um_s": 0,
        "position.fix_speed_dilution_permille": 0,
        "position.fix_speed_further_um_s": 0,
        "position.fix_unknowns": 2,
        "position.fix_missing": missing,
    }


def fix_inputs(solution: Solution, ahead: Ahead, offset_s: float, config: SatelliteConfig) -> StepValues:
    """Return the solution as inputs. `offset_s`: time from the cycle to the measurement, s.

    A place that is not solved is anywhere within the predicted bounds, a speed that is not solved any that a vehicle has.
    OUT_OF_RANGE where the machine's inputs cannot hold one of the figures.
    """
    place_mm, further_mm = outward(_place_nm(solution, ahead, offset_s), NM_PER_MM)
    speed_um_s, speed_further_um_s = _speed_um_s(solution, ahead, offset_s, config)
    dilutions = _permille(solution.dilution()), _permille(solution.speed_dilution())
    held = (
        abs(place_mm) <= config.position_limit_mm
        and further_mm <= 10 * config.protection_limit_mm
        and speed_further_um_s <= 2 * config.max_speed_mm_s * UM_PER_MM
        and max(dilutions) <= MAX_DILUTION_PERMILLE
    )
    if not held:
        return no_fix("OUT_OF_RANGE")
    return {
        "position.fix_mm": place_mm,
        "position.fix_dilution_permille": dilutions[0],
        "position.fix_further_mm": further_mm,
        "position.fix_speed_um_s": speed_um_s,
        "position.fix_speed_dilution_permille": dilutions[1],
        "position.fix_speed_further_um_s": speed_further_um_s,
        "position.fix_unknowns": solution.unknowns,
        "position.fix_missing": "NOTHING",
    }


def _permille(dilution: Fraction) -> int:
    return math.ceil(dilution * 1_000)


def _place_nm(solution: Solution, ahead: Ahead, offset_s: float) -> ExactBounds:
    """Brought to the time of the cycle at the predicted speed, whose margin counts for the time between."""
    found = solution.off_mm()
    if found is None:
        return ExactBounds(ahead.low_nm, ahead.high_nm)
    late_s, gained = Fraction(abs(offset_s)), Fraction(ahead.max_acceleration_mm_s2) * NM_PER_MM / 2
    drift = math.ceil(ahead.speed_margin_um_s * UM_PER_MM * late_s + gained * late_s**2)
    return ExactBounds(found.low * NM_PER_MM, found.high * NM_PER_MM).widened(drift).moved(ahead.position_nm)


def _speed_um_s(solution: Solution, ahead: Ahead, offset_s: float, config: SatelliteConfig) -> tuple[int, int]:
    """Return the speed and its further error. A speed beyond every vehicle's becomes the nearest possible one, with that much more error."""
    fast, found = config.max_speed_mm_s * UM_PER_MM, solution.speed_off_mm_s()
    if found is None:
        return 0, fast
    gained = math.ceil(Fraction(abs(offset_s)) * ahead.max_acceleration_mm_s2 * UM_PER_MM)
    bounds = ExactBounds(found.low * UM_PER_MM, found.high * UM_PER_MM).widened(gained).moved(ahead.speed_um_s)
    speed, further = outward(bounds)
    nearest = max(-fast, min(speed, fast))
    return nearest, further + abs(speed - nearest)
