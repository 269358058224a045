"""The world of the satellite position machine: how the vehicle moves, and what references, signals and odometry keep.

What a signal is worth is no law: any of them may be false. The solver's law speaks of solutions from signals whose errors
keep a bound; that usable satellites keep it follows from the criterion of the selection, and is proved.
"""

from __future__ import annotations

from typing import Literal

from safeloc.language.expr import Bool, Lit, Num, all_of, as_num, between, exact_to, ite
from safeloc.language.units import COUNT, MM, MM_S, MS, NM, UM_S
from safeloc.language.world import Law, World
from safeloc.models.satellite.variables import Parts
from safeloc.models.satellite_selection import SelectionConfig

Trusted = Literal["satellites", "odometry"]
"""satellites: the solver and its inputs are trusted; odometry: any solution may be false, the run is true."""

REFERENCE = "a reference holds the true place"
"""The clause that an earlier machine can be made to keep, if the reference is its position."""

SELECTED = "a usable satellite's error is within its bound"
"""The clause that the selection is proved to guarantee in a composition."""


def world(own: Parts, trusted: Trusted) -> World:
    """Make the world: true place and speed of the vehicle, and laws of the signals or of odometry."""
    return own.declared.world(
        moves={own.truth: own.next_truth, own.true_speed: own.next_speed},
        clauses={**_movement(own), **_references(own), **(_signals(own) if trusted == "satellites" else _run(own))},
    )


# ------------------------------------------------------------------ the vehicle


def can_stop(own: Parts, place: Num, speed: Num) -> Bool:
    """Return whether the vehicle can stop before the coordinates end; otherwise the movement would have to end with them."""
    at_rest = place + exact_to(speed * Lit(own.config.stopping_ms, MS), NM)
    return between(own.truth.low, at_rest, own.truth.high)


def _movement(own: Parts) -> dict[str, Law]:
    """Speed changes within the greatest acceleration A: in a cycle T by A T, and the way by A T2 / 2."""
    period, most = own.config.period_ms, own.config.max_acceleration_mm_s2
    sped, ran = own.next_speed - own.true_speed, own.next_truth - own.truth
    gained, way = as_num(most * period, UM_S), as_num(most * period**2 // 2, NM)
    at_speed = exact_to(own.true_speed * Lit(period, MS), NM)
    stated = ("max_acceleration_mm_s2", "period_ms")
    return {
        "the way follows from the speed": Law(
            (ran <= at_speed + way) & (ran >= at_speed - way),
            "In a cycle the vehicle runs its speed times the cycle, more or less by what the greatest acceleration adds.",
            stated,
            "[D] kinematics",
            "operator",
            "braking and traction of the vehicle's type are below the greatest acceleration",
        ),
        "speed changes within the greatest acceleration": Law(
            (sped <= gained) & (sped >= -gained),
            "In a cycle the vehicle's speed changes by no more than the greatest acceleration makes of it.",
            stated,
            "[D] 1.5 m/s2, passenger; emergency brakes of other vehicles may exceed it",
            "operator",
            "braking and traction of the vehicle's type are below the greatest acceleration",
        ),
        "the vehicle can stop before the coordinates end": Law(
            can_stop(own, own.next_truth, own.next_speed),
            "The vehicle is on the line, and stays there.",
            ("position_limit_mm", "max_speed_mm_s"),
            "[D] the line is shorter than the coordinates",
            "infrastructure",
            "audit of the map",
        ),
    }


# ------------------------------------------------------------------ what is told


def _references(own: Parts) -> dict[str, Law]:
    beside, accuracy = own.next_truth - exact_to(own.reference.value, NM), exact_to(own.accuracy, NM)
    faster = own.next_speed - own.reference_speed.value
    return {
        REFERENCE: Law(
            own.reference.present.implies(between(-accuracy, beside, accuracy)),
            "A reference gives the vehicle's place at the time of the cycle, within the accuracy given with it.",
            ("tolerance_mm",),
            "[D] balise, or the position of another machine",
            "infrastructure",
            "places of balises are surveyed; in a composition the earlier machine is proved to keep it",
        ),
        "a reference's speed holds the true one": Law(
            own.reference_speed.present.implies(between(-own.speed_accuracy, faster, own.speed_accuracy)),
            "If a reference gives a speed, the vehicle has this speed within the accuracy given with it.",
            ("max_speed_mm_s",),
            "[D]",
            "supplier",
            "type test of the odometer that tells it",
        ),
    }


def _signals(own: Parts) -> dict[str, Law]:
    stated = tuple(f"selection.{kind}_{what}" for kind in ("range", "speed") for what in FIGURES[kind])
    return {
        "a solution is off by no more than its signals make of it": Law(
            _solution_holds(own),
            "A solution from at least as many satellites as it has unknowns is off by no more than the dilution given with "
            "it times the bound of its signals, and what is given beside, if the error of each of them keeps the bound: "
            "threshold, prediction and clock together.",
            stated,
            "[D] linear in the errors: dilution is the sum of |weight|",
            "supplier",
            "type test against a simulator of the constellation, with errors at the bound",
            "dilution times bound is what a least-squares solution is worth, and both say so; the law's bound is its own figure",
        ),
        SELECTED: Law(
            all_of(
                (usable & good).implies(bounded)
                for usable, good, bounded in zip(own.usable, own.compared, own.bounded, strict=True)
            ),
            "The error of a usable satellite, compared with a prediction and a clock as good as configured, is no more than "
            "threshold, prediction and clock together.",
            stated,
            "[D] the criterion of the selection",
            "supplier",
            "in a composition the selection is proved to guarantee it",
        ),
        "signals are compared with a prediction and a clock as good as configured": Law(
            all_of(good | ~used for used, good in zip(own.used, own.compared, strict=True)),
            "The errors of prediction and clock change a used satellite's difference by no more than the sum of both figures.",
            stated,
            "[D] A T2, the state's own error, and that of a median of the clock",
            "supplier",
            "the machine reports the state's margin, which can be compared with the figure in every cycle",
        ),
    }


FIGURES = {
    "range": ("threshold_mm", "prediction_mm", "clock_mm"),
    "speed": ("threshold_mm_s", "prediction_mm_s", "clock_mm_s"),
}


def hidden_errors(config: SelectionConfig) -> tuple[int, int]:
    """Return the error that remains in the differences if prediction and clock are as configured: mm of range, mm/s of range rate."""
    return config.range_prediction_mm + config.range_clock_mm, config.speed_prediction_mm_s + config.speed_clock_mm_s


def signal_errors(config: SelectionConfig) -> tuple[int, int]:
    """Return the proved bounds of a usable satellite's range and speed errors: the threshold, and the error that may be hidden."""
    hidden, hidden_speed = hidden_errors(config)
    return config.range_threshold_mm + hidden, config.speed_threshold_mm_s + hidden_speed


def _solution_holds(own: Parts) -> Bool:
    """Return whether a solution from enough bounded signals is wrong by no more than their bounds and its dilution imply."""
    satellites, solvable = as_num(0, COUNT), own.unknowns
    for used in own.used:
        satellites = satellites + ite(~used, as_num(0, COUNT), 1)
    good = all_of(bounded | ~used for used, bounded in zip(own.used, own.bounded, strict=True))
    off, off_speed = own.next_truth - exact_to(own.fix.value, NM), own.next_speed - own.fix_speed
    most, most_speed = signal_errors(own.config.selection)
    level = exact_to(own.dilution * Lit(most, MM), NM) + exact_to(own.further, NM)
    speed_level = exact_to(own.speed_dilution * Lit(most_speed, MM_S), UM_S) + own.speed_further
    holds = (off <= level) & (off >= -level) & (off_speed <= speed_level) & (off_speed >= -speed_level)
    return (own.fix.present & good & (satellites >= solvable)).implies(holds)


def _run(own: Parts) -> dict[str, Law]:
    off, error = own.next_truth - own.truth - exact_to(own.odometry.value, NM), exact_to(own.odometry_error, NM)
    return {
        "reported odometry is true": Law(
            own.odometry.present.implies(between(-error, off, error)),
            "The vehicle ran in the cycle what odometry reports, within the error reported with it.",
            ("max_speed_mm_s", "period_ms"),
            "[D] the odometer's own error law",
            "supplier",
            "the odometry machine is proved to keep it",
        )
    }
