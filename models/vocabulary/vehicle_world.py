"""Laws of a vehicle that several worlds state alike: its highest speed, its line, and the meaning of an interval that is stated.

Only worlds and lemmas import this. Machines and properties have terms of their own, so that a wrong one here cannot excuse itself.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, NumVar, between, exact_to
from safeloc.language.units import NM
from safeloc.language.world import Law

SPEED = "the vehicle never exceeds its highest speed"
ON_THE_LINE = "the vehicle stays on the line"


def speed_law(ran: Num, farthest_nm: int) -> Law:
    """Return the law of the highest speed; `ran`: the true run of the cycle, nm; `farthest_nm`: that at the highest speed."""
    return Law(
        between(-farthest_nm, ran, farthest_nm),
        "The vehicle runs no faster than its highest speed, either way.",
        ("max_speed_mm_s", "period_ms"),
        "[D] 160 km/h",
        "operator",
        "speed supervision",
    )


def line_law(truth: NumVar, after: Num) -> Law:
    """Return the law of a vehicle that cannot leave its line; `after`: the true place at the end of the cycle, nm."""
    return Law(
        on_line(truth, after),
        "The vehicle does not leave the coordinates of the line.",
        ("position_limit_mm",),
        "[D] 1 000 km of line",
        "operator",
        "route setting",
    )


def on_line(truth: NumVar, after: Num) -> Bool:
    """Return whether the true place at the end of the cycle is one that `truth` can hold."""
    return between(truth.low, after, truth.high)


def stated_interval_holds(position: Num, below: Num, above: Num, truth: Num) -> Bool:
    """Return whether an interval that is stated in whole mm contains the true place, nm."""
    low, high = position - below, position + above
    return between(exact_to(low, NM), truth, exact_to(high, NM))
