"""The world of satellite selection: what a difference between measured and predicted is made of.

Nothing is assumed of a signal's own error: the criterion is there because it may be anything.
"""

from __future__ import annotations

from safeloc.language.expr import Bool
from safeloc.language.world import Law, World
from safeloc.models.satellite_selection.variables import Channel, Parts


def world(own: Parts) -> World:
    """Return the world: errors of signals, prediction and clock are chosen anew in every cycle."""
    return World(
        choices=own.declared.choices,
        clauses={f"satellite {one.number} is compared as it is": _comparison_law(own, one) for one in own.channels},
    )


def _comparison_law(own: Parts, one: Channel) -> Law:
    return Law(
        _is_compared(own, one),
        "A difference is the signal's own error, plus what the prediction's error makes of it along the line of sight, less "
        "the error of the receiver's clock, which is the same for all satellites of a cycle.",
        source="[D] pseudorange and range rate are sums of these terms; prediction and measurement have the same ephemeris",
        owner="supplier",
        check="type test against a simulator of the constellation, in which each of the errors is set",
    )


def _is_compared(own: Parts, one: Channel) -> Bool:
    ranges = one.off.present.implies(one.off.value.eq(one.error + one.prediction - own.clock))
    speeds = one.speed_off.present.implies(
        one.speed_off.value.eq(one.speed_error + one.prediction_mm_s - own.clock_mm_s)
    )
    return ranges & speeds
