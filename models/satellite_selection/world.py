"""The world of satellite selection: what a difference between measured and predicted is made of, and what an almanac is worth.

Nothing is assumed of a signal's own error: the criterion is there because it may be anything.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, between
from safeloc.language.world import Law, World
from safeloc.models.satellite_selection.variables import Channel, Parts


def world(own: Parts) -> World:
    """Return the world: errors of signals, prediction and clock are chosen anew in every cycle."""
    return World(
        choices=own.declared.choices,
        clauses={
            **{f"satellite {one.number} is compared as it is": _comparison_law(own, one) for one in own.channels},
            **{
                f"the almanac has satellite {one.number} about where it is": _almanac_law(own, one)
                for one in own.channels
            },
        },
    )


def is_current(own: Parts) -> Bool:
    """Return whether there is an almanac, and it is not too old."""
    return own.almanac_age.present & (own.almanac_age.value <= own.config.almanac_limit_s)


def _comparison_law(own: Parts, one: Channel) -> Law:
    return Law(
        _is_compared(own, one),
        "A difference is the signal's own error, plus what the prediction's error makes of it along the line of sight, less "
        "the error of the receiver's clock, which is the same for all satellites of a cycle.",
        source="[D] pseudorange and range rate are sums of these terms; prediction and measurement have the same ephemeris",
        owner="supplier",
        check="type test against a simulator of the constellation, in which each of the errors is set",
    )


def _almanac_law(own: Parts, one: Channel) -> Law:
    off, most = one.almanac.value - one.elevation, own.config.almanac_accuracy_mrad
    return Law(
        (is_current(own) & one.almanac.present).implies(between(-most, off, most)),
        "The elevation that follows from a current almanac is off by no more than its accuracy: an almanac is coarse.",
        figures=("almanac_accuracy_mrad", "almanac_limit_s"),
        source="[S] 2 km within the six days of its fit; [D] the vehicle is within 60 km of where it is predicted",
        owner="supplier",
        check="elevations by the almanac compared with those by the ephemerides, throughout the almanac's validity",
    )


def _is_compared(own: Parts, one: Channel) -> Bool:
    ranges = one.off.present.implies(one.off.value.eq(one.error + one.prediction - own.clock))
    speeds = one.speed_off.present.implies(
        one.speed_off.value.eq(one.speed_error + one.prediction_mm_s - own.clock_mm_s)
    )
    return ranges & speeds
