"""Computes the place of a reflector's nearest corner from another one; all stand on a line parallel to the antenna's axis.

With R the range of a corner that stands L farther along, and c the cosine of its angle from the axis, the nearest one's
range r and sine are

    r^2 = R^2 + L^2 - 2 R L c        sine of the nearest = (sine of the corner) R / r

r grows with R and falls with c while the nearest corner is ahead of the antenna, so the bounds of both give those of r. The
computation uses the echo of this one corner only, so its bounds hold whatever is wrong with the others.
"""

from __future__ import annotations

import math
from fractions import Fraction

from safeloc.sensing.rounding import ExactBounds

_BILLION = 1_000_000_000


def nearest(range_nm: ExactBounds, sine_ppb: ExactBounds, farther_nm: int) -> tuple[ExactBounds, ExactBounds]:
    """Return bounds of range (nm) and sine (1e-9) of the nearest corner, from those of the corner `farther_nm` beyond it."""
    if farther_nm == 0:
        return range_nm, sine_ppb
    cosine = _cosine_ppb(sine_ppb)
    low = max(math.floor(range_nm.low), _ceil_share(farther_nm, int(cosine.high)))
    high = max(math.ceil(range_nm.high), low)
    near = ExactBounds(
        math.isqrt(_square(low, farther_nm, int(cosine.high))),
        math.isqrt(_square(high, farther_nm, int(cosine.low)) + 1) + 1,
    )
    ratio = ExactBounds(Fraction(low, int(near.high)), Fraction(high, max(1, int(near.low))))
    return near, sine_ppb * ratio


def _cosine_ppb(sine_ppb: ExactBounds) -> ExactBounds:
    """Return bounds of the cosine in 1e-9, whole numbers rounded outward."""
    ends = [abs(Fraction(one)) for one in (sine_ppb.low, sine_ppb.high)]
    least = 0 if sine_ppb.low <= 0 <= sine_ppb.high else math.floor(min(ends))
    most = min(_BILLION, math.ceil(max(ends)))
    return ExactBounds(
        math.isqrt(_BILLION**2 - most**2), min(_BILLION, math.isqrt(_BILLION**2 - min(least, most) ** 2) + 1)
    )


def _square(range_nm: int, farther_nm: int, cosine_ppb: int) -> int:
    """Return r^2, rounded down by less than one."""
    return max(0, range_nm**2 + farther_nm**2 - _ceil_share(2 * range_nm * farther_nm, cosine_ppb))


def _ceil_share(amount: int, ppb: int) -> int:
    return -(-amount * ppb // _BILLION)
