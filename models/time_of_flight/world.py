"""The world of the time of flight: the vehicle's end on the fibre and on the track, and the way of the light.

the vehicle  is somewhere on the fibre, in each cycle anew: no motion is assumed
the pattern  comes from the vehicle's end, within an error
the light    runs there and back at c0 / n; delay and index are known within their errors
the cable    is no shorter than its track between surveyed points, and longer by no more than its slack
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from safeloc.language.expr import Bool, Num, all_of, between, exact_to, ite, with_unit
from safeloc.language.units import NM, ONE, PPM_PER_ONE, UM, UM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.time_of_flight.variables import LIGHT_M_S, Parts

_PM_PER_NM, _PM_PER_UM = 1_000, 1_000_000


def world(own: Parts) -> World:
    """Return the world: the true place of the end, and the laws of pattern, light and cable."""
    return own.declared.world(
        moves={own.truth: own.next_truth, own.true_distance: own.next_true_distance},
        clauses={
            "the pattern comes from the vehicle's end": _origin_law(own),
            "light runs there and back through the fibre": _light_law(own),
            "the cable follows the track within its slack": _cable_law(own),
        },
    )


def _origin_law(own: Parts) -> Law:
    off, error = own.origin - own.next_true_distance, own.config.pattern_error_mm * UM_PER_MM
    return Law(
        own.delay.present.implies(between(-error, off, error)),
        "The backscatter that is timed comes from no farther along the fibre from the vehicle's end than the pattern's error: "
        "outermost axle, overhang, gauge and pulse; light reflected at the fibre's end is absorbed.",
        ("pattern_error_mm", "fibre_mm"),
        "[D] measured over simulation (docs/fibre.md); [S] 002 l. 149: absorber at the end",
        "supplier",
        "type test over sections surveyed; the place by the sections passed next",
    )


def _light_law(own: Parts) -> Law:
    config, half = own.config, LIGHT_M_S // 2
    wrong = config.trigger_error_ps + config.resolution_ps
    longest, shortest = (with_unit((own.delay.value + error) * half, ONE) for error in (wrong, -wrong))
    off = Fraction(config.index_ppm * config.index_error_ppm, PPM_PER_ONE)
    least, most = (
        with_unit(own.origin * index, ONE) for index in (floor(config.index_ppm - off), ceil(config.index_ppm + off))
    )
    return Law(
        own.delay.present.implies((longest >= least) & (shortest <= most)),
        "The time between pulse and pattern is that in which light runs to the pattern's origin and back at c0 / n, with an "
        "index n within its error, measured within the errors of the trigger and of the reading.",
        ("index_ppm", "index_error_ppm", "trigger_error_ps", "resolution_ps", "pulse_hz"),
        "[S] 002 l. 181 to 187; [M] index calibrated, temperature",
        "supplier",
        "reflecting points of known distance; an index calibrated with the fibre's length",
    )


def _cable_law(own: Parts) -> Law:
    fibre = own.next_true_distance - exact_to(own.map_distance, UM)
    ahead = own.next_truth - exact_to(own.map_position, NM)
    ran = ite(own.map_upwards, ahead, -ahead)
    return Law(
        own.map_known.implies(_follows(own, fibre, ran)),
        "From the surveyed point on, the track advances along the fibre by no more than the cable's length, and by no less than "
        "that without its greatest slack, each within the error of the survey.",
        ("slack_ppm", "map_error_mm", "position_limit_mm"),
        "[M] slack 1 to 3 %; loops in shafts are surveyed",
        "infrastructure",
        "survey of the cable: knocks at known places; reflecting points",
    )


def _follows(own: Parts, fibre_um: Num, ran_nm: Num) -> Bool:
    """Return the condition that a run along the track fits a length of cable; both negative before the surveyed point."""
    config = own.config
    whole = with_unit(fibre_um * _PM_PER_UM, ONE)
    less = with_unit(fibre_um * (PPM_PER_ONE - config.slack_ppm), ONE)
    ran, error = with_unit(ran_nm * _PM_PER_NM, ONE), config.map_error_mm * UM_PER_MM * _PM_PER_UM
    beyond = fibre_um >= 0
    return all_of([ran >= ite(beyond, less, whole) - error, ran <= ite(beyond, whole, less) + error])
