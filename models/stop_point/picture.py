"""The picture of a run of the stop-point machine, as in source 001, fig. 2."""

from __future__ import annotations

from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.railway.pictures import Approach, StopSignals

PERIOD_MS = 100
"""[S] SUBSET-041: application cycle up to 100 ms; the machine itself does not depend on it."""
FIGURE_2, CALLED = ("stop_point-figure-2", "stop_point-overrun"), {1: "207", 2: "210"}
"""The shipped recordings of that station, and the numbers that the source gives its stop points."""


def picture(config: StopPointConfig) -> Approach:
    """Return the speed over the distance to the stop point, with orders, stop window, overrun and repositioning."""
    return Approach(
        title="Speed over distance to the stop point",
        speed="speed_mm_s",
        position="position_mm",
        above="margin_above_mm",
        below="margin_below_mm",
        valid="position_valid",
        order="order",
        braking="BRAKE",
        idle="NONE",
        selected="selected_stop",
        stops=tuple(_stop(number) for number in range(1, config.stop_points + 1)),
        brake_mm_s2=config.brake_mm_s2,
        reaction_ms=config.reaction_ms,
        speed_error_mm_s=config.speed_error_mm_s,
        reduced_speed_mm_s=config.reduced_speed_mm_s,
        period_ms=PERIOD_MS,
    )


def _stop(number: int) -> StopSignals:
    name = f"stop_{number}"
    called = dict.fromkeys(FIGURE_2, CALLED[number]) if number in CALLED else {}
    return StopSignals(number, f"{name}_position_mm", f"{name}_before_mm", f"{name}_after_mm", called)
