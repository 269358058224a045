"""The stop window and the measured interval in nanometres, as the claims speak of them."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, exact_to
from safeloc.language.spec import earlier_num
from safeloc.language.units import NM
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import Parts

LAW = (
    "a valid interval holds the true position; speed is measured within its error; an order to brake stops the vehicle "
    "within reaction and braking distance"
)
REQUIREMENTS = ("RFL-D7",)


def near_end(own: Parts) -> Num:
    """Where the window of the pending stop begins."""
    return exact_to(own.stop, NM) - exact_to(own.before, NM)


def far_end(own: Parts) -> Num:
    """Where the window of the pending stop ends, towards the platform's end."""
    return exact_to(own.stop, NM) + exact_to(own.after, NM)


def rearmost(own: Parts) -> Num:
    """The rearmost place of the front end by the reported interval."""
    return exact_to(own.position, NM) - exact_to(own.below, NM)


def foremost(own: Parts) -> Num:
    """The foremost place of the front end by the reported interval."""
    return exact_to(own.position, NM) + exact_to(own.above, NM)


def width(own: Parts) -> Num:
    """The reported interval's width."""
    return exact_to(own.above, NM) + exact_to(own.below, NM)


def fits(own: Parts) -> Bool:
    """The reported interval lies within the window."""
    return (rearmost(own) >= near_end(own)) & (foremost(own) <= far_end(own))


def stands(own: Parts) -> Bool:
    """The measured speed is that of a standing vehicle."""
    most = own.config.standstill_mm_s
    return (own.speed <= most) & (own.speed >= -most)


def ordered_before(model: StopPoint) -> Num:
    """The order of the cycle before."""
    return earlier_num(model.machine.output("order"))
