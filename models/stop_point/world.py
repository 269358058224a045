"""The world of the stop-point machine: the true place and speed of the front end, and its run-out.

The position comes from another machine of the vehicle, the reflector machine, which proves that its interval holds the truth.
Here that is a law about an input.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, between, exact_to, product, with_unit
from safeloc.language.units import NM, NM_PER_UM, UM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.stop_point.variables import Parts

REPORTED = "a valid interval holds the truth"
"""The clause that the machine before it can guarantee."""


def world(own: Parts) -> World:
    """Return the world: the front end, its speed, and its run-out after an order to brake."""
    return own.declared.world(
        moves={own.truth: own.next_truth, own.true_speed: own.next_true_speed, own.run_out: own.next_run_out},
        clauses={
            REPORTED: _reported(own),
            "speed is measured within its error": _measured(own),
            "the brakes reach their guaranteed rate": _braked(own),
            "a higher speed has a greater square": _squared(own),
        },
    )


def _reported(own: Parts) -> Law:
    ahead = exact_to(own.above, NM) + exact_to(own.position, NM)
    behind = exact_to(own.position, NM) - exact_to(own.below, NM)
    return Law(
        own.valid.implies(between(behind, own.next_truth, ahead)),
        "While the reported position is valid, the front end lies in the reported interval.",
        source="[D] containment of the reflector machine",
        owner="supplier",
        check="the reflector machine's self-test at every balise",
    )


def _measured(own: Parts) -> Law:
    error = own.config.speed_error_mm_s
    return Law(
        between(-error, own.next_true_speed - own.speed, error),
        "The measured speed differs from the true one by no more than its error.",
        figures=("speed_error_mm_s",),
        source="[M] 0.36 km/h at platform speeds",
        owner="supplier",
        check="comparison of the speeds of two axles",
    )


def _braked(own: Parts) -> Law:
    """Return the law: twice the deceleration x the run after the reaction is at most the speed squared; in nm, ms and mm/s."""
    config = own.config
    speed, runs = own.next_true_speed, own.next_run_out
    reaction = with_unit(speed * (config.reaction_ms * NM_PER_UM), NM)
    squared = with_unit(product(speed, speed) * (NM_PER_UM * UM_PER_MM), NM)
    braking: Bool = (runs - reaction) * (2 * config.brake_mm_s2) <= squared
    return Law(
        (speed > 0).implies(braking) & (speed <= 0).implies(runs.eq(Lit(0, NM))),
        "After an order to brake the vehicle keeps its speed for the reaction time, and then brakes at least at the guaranteed "
        "rate; a vehicle that stands or runs back does not run on.",
        figures=("reaction_ms", "brake_mm_s2"),
        source="[S] service brake 0.8 to 1.0 m/s2; reaction [M]",
        owner="operator",
        check="brake test before the run, and the stopping distance of every stop",
    )


def _squared(own: Parts) -> Law:
    """Return a fact of arithmetic that solvers find slowly by themselves; it excludes nothing."""
    speed, fastest = own.next_true_speed, own.speed + own.config.speed_error_mm_s
    rising = (speed >= 0) & (speed <= fastest)
    return Law(
        rising.implies(product(speed, speed) <= product(fastest, fastest)),
        "Of two speeds that are not negative, the higher one has the greater square.",
        source="[D] true of all whole numbers; no assumption",
        owner="nobody",
    )
