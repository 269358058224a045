"""Terms that the properties share: the stop window and the reported interval, nm."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, exact_to
from safeloc.language.spec import earlier_num
from safeloc.language.units import NM
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import Parts

LAW = (
    "a valid interval holds the true position; the speed is measured within its error; an order to brake stops the vehicle "
    "within reaction and braking distance"
)
REQUIREMENTS = ("RFL-D7",)


def near_end(own: Parts) -> Num:
    """Return the near end of the window of the pending stop, nm."""
    return exact_to(own.stop, NM) - exact_to(own.before, NM)


def far_end(own: Parts) -> Num:
    """Return the far end of the window of the pending stop, towards the platform's end, nm."""
    return exact_to(own.stop, NM) + exact_to(own.after, NM)


def rearmost(own: Parts) -> Num:
    """Return the rearmost possible place of the front end by the reported interval, nm."""
    return exact_to(own.position, NM) - exact_to(own.below, NM)


def foremost(own: Parts) -> Num:
    """Return the foremost possible place of the front end by the reported interval, nm."""
    return exact_to(own.position, NM) + exact_to(own.above, NM)


def width(own: Parts) -> Num:
    """Return the width of the reported interval, nm."""
    return exact_to(own.above, NM) + exact_to(own.below, NM)


def fits(own: Parts) -> Bool:
    """Return whether the reported interval lies within the window."""
    return (rearmost(own) >= near_end(own)) & (foremost(own) <= far_end(own))


def stands(own: Parts) -> Bool:
    """Return whether the measured speed is that of a standing vehicle."""
    most = own.config.standstill_mm_s
    return (own.speed <= most) & (own.speed >= -most)


def ordered_before(model: StopPoint) -> Num:
    """Return the order of the cycle before."""
    return earlier_num(model.machine.output("order"))
