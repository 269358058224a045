"""Counts the samples for which the wheel on the head damps its channels: first one alone, then the rest until both are free.

A wheel that damped the first channel alone for less than `slow_samples` cannot stop on the head. A rest of more than a few times as long is
no wheel: a channel has stayed damped, and come free by itself. A wheel that is slower may stand on the head as long as it likes. Then the
times tell nothing, and its cycle is at fault too.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, any_of, as_num, ite, minimum
from safeloc.language.units import COUNT
from safeloc.models.axle_head import NO_AXLE
from safeloc.models.counting_head.variables import Parts


def went_back(own: Parts) -> Bool:
    """Return whether a wheel has gone back on the head in this sample."""
    _, a_first, both_up, b_last, b_first, both_down, a_last, _ = own.head_modes
    back = ((both_up, a_first), (b_last, both_up), (both_down, b_first), (a_last, both_down))
    return any_of(own.mode_before.eq(far) & own.head_mode.eq(near) for far, near in back)


def counted_late(own: Parts) -> Bool:
    """Return whether the wheel that is counted took too long, or may have stopped."""
    wheel = own.config.wheel
    slow = own.first_alone >= wheel.slow_samples
    late = own.since_both > own.first_alone * wheel.times_as_long + wheel.more_samples
    return own.counted.ne(NO_AXLE) & (slow | late)


def first_alone(own: Parts) -> Num:
    """Return for how many samples, with this one, the first channel was damped alone."""
    return ite(_free(own), as_num(0, COUNT), _alone_after(own, _is_first(own)))


def since_both(own: Parts) -> Num:
    """Return how many samples there were, with this one, since both channels were damped first."""
    return ite(_is_first(own) | _free(own), as_num(0, COUNT), _since_after(own))


def _free(own: Parts) -> Bool:
    return own.head_mode.eq(own.head_modes[0])


def _is_first(own: Parts) -> Bool:
    _, a_first, _, _, b_first, *_ = own.head_modes
    return own.head_mode.one_of(a_first, b_first)


def _alone_after(own: Parts, first: Bool) -> Num:
    more = ite(first, as_num(1, COUNT), 0)
    return ite(_untimed(own), own.first_alone.high, minimum(own.first_alone + more, own.first_alone.high))


def _untimed(own: Parts) -> Bool:
    """Return whether the times tell nothing: a wheel has gone back, or one may have come while the head is disturbed."""
    return went_back(own) | own.head_mode.eq(own.head_modes[-1])


def _since_after(own: Parts) -> Num:
    return minimum(own.since_both + 1, own.since_both.high)
