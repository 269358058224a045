"""Lemmas for the proofs of a head through a cycle: a cycle is counted, and how fast a wheel is, from the samples in which it was on a channel.

A wheel that took few samples over the first channel alone is fast, and so leaves the head soon. The fewer samples, the sooner; so the
lemmas go by spans of that number, each with its slowest wheel.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Lit, Num, all_of, exact_to, ite, with_unit
from safeloc.language.units import UM, UM_PER_MM, UM_S, US
from safeloc.models.counting_head.spans import least_samples, slowest_um_s, spans
from safeloc.models.counting_head.variables import Parts

_PM = UM_S.times(US)


def lemmas(own: Parts) -> dict[str, Bool]:
    """Return the lemmas."""
    return {
        "a cycle without a fault is counted": _counted(own),
        "the wheel is where the head's mode says": _placed(own),
        "a wheel that is soon on both channels is fast": all_of(_fast(own)),
        "a fast wheel is soon off the head": all_of(_soon(own)),
        "a wheel that comes fast enough stays fast": _sure(own),
    }


def _counted(own: Parts) -> Bool:
    """Return the lemma: samples and axles are those of the true cycle, and the axles of one direction."""
    same = (
        own.axles_upwards.eq(own.true_axles_upwards)
        & own.axles_downwards.eq(own.true_axles_downwards)
        & (own.axles_upwards.eq(0) | own.axles_downwards.eq(0))
    )
    seen = (own.true_axles_upwards <= own.true_samples) & (own.true_axles_downwards <= own.true_samples)
    return own.samples.eq(own.true_samples) & seen & (~own.flawed).implies(same)


def on_first(own: Parts) -> Bool:
    """Return whether a wheel damps the channel that it came to first alone, and has not gone back."""
    _, a_first, _, _, b_first, *_ = own.head_modes
    return own.mode_before.one_of(a_first, b_first) & (own.first_alone < own.config.wheel.slow_samples)


def _on_rest(own: Parts) -> Bool:
    """Return whether a wheel damps both channels or the second one alone, and has not gone back."""
    _, _, both_up, b_last, _, both_down, a_last, _ = own.head_modes
    timed = own.first_alone < own.config.wheel.slow_samples
    return own.mode_before.one_of(both_up, b_last, both_down, a_last) & timed


def ahead(own: Parts) -> tuple[Num, Num]:
    """Return how far the wheel is on the head, and its speed, both in the direction in which it came."""
    return ite(own.from_low, own.wheel, -own.wheel + (own.config.end_um - 1)), ite(own.from_low, own.speed, -own.speed)


def _samples_at(own: Parts, samples: Num, speed_um_s: int) -> Num:
    """Return the run of so many samples at a speed, pm."""
    return with_unit(samples * (speed_um_s * own.config.head.sample_us), _PM)


def _fast(own: Parts) -> Iterator[Bool]:
    place, speed = ahead(own)
    way, change = exact_to(place, _PM), own.config.change_um_s
    for span in spans(own.config):
        near = way <= _samples_at(own, own.first_alone, span.came_um_s + own.config.unsure_um_s)
        still = speed >= Lit(span.came_um_s, UM_S) - with_unit(own.first_alone * change, UM_S)
        yield on_first(own).implies(near | still)


def _soon(own: Parts) -> Iterator[Bool]:
    place, speed = ahead(own)
    way, change = exact_to(place - Lit(own.config.alone_um, UM), _PM), own.config.change_um_s
    for span in spans(own.config):
        timed = _on_rest(own) & (own.first_alone > span.above) & (own.first_alone <= span.most)
        far = way >= _samples_at(own, own.since_both - 1, span.left_um_s)
        changed = with_unit((own.since_both + span.most) * change, UM_S)
        still = speed >= Lit(span.came_um_s, UM_S) - changed
        yield timed.implies(far & still & (own.since_both <= span.rest))


def _placed(own: Parts) -> Bool:
    """Return the lemma: the stretch on which the wheel is, and that no wheel is on both channels sooner than at the highest speed."""
    place, _ = ahead(own)
    free, a_first, both_up, b_last, b_first, both_down, a_last, disturbed = own.head_modes
    alone, end, mode = own.config.alone_um, own.config.end_um, own.mode_before
    first, both, last = mode.one_of(a_first, b_first), mode.one_of(both_up, both_down), mode.one_of(b_last, a_last)
    step = own.config.head.max_speed_mm_s * UM_PER_MM * own.config.head.sample_us
    return all_of(
        [
            mode.eq(free).implies((place < 0) | (place >= end)),
            mode.eq(free).implies(own.first_alone.eq(0) & own.since_both.eq(0)),
            mode.eq(disturbed).iff(own.was_disturbed),
            mode.eq(disturbed).implies(own.first_alone.eq(own.first_alone.high) & own.speed_came.eq(0)),
            first.implies((place >= 0) & (place < alone) & (own.first_alone > 0) & own.since_both.eq(0)),
            first.implies(exact_to(place, _PM) < with_unit(own.first_alone * step, _PM)),
            both.implies((place >= alone) & (place < end - alone)),
            last.implies((place >= end - alone) & (place < end)),
            mode.one_of(a_first, both_up, b_last).implies(own.from_low),
            mode.one_of(b_first, both_down, a_last).implies(~own.from_low),
            (both | last).implies((own.since_both > 0) & (own.first_alone >= least_samples(own.config))),
        ]
    )


def _sure(own: Parts) -> Bool:
    """Return the lemma: a wheel that came at the speed from which none is refused was on both channels in time."""
    place, speed = ahead(own)
    config = own.config
    sure, change = config.wheel.sure_speed_mm_s * UM_PER_MM, config.change_um_s
    came = own.speed_came >= Lit(sure, UM_S)
    far = exact_to(place, _PM) >= _samples_at(own, own.first_alone - 1, slowest_um_s(config))
    still = speed >= Lit(sure, UM_S) - with_unit(own.first_alone * change, UM_S)
    moving = on_first(own).implies(far & still)
    free, *_, disturbed = own.head_modes
    fast = own.first_alone < config.wheel.slow_samples
    return (came & ~own.mode_before.one_of(free, disturbed)).implies(fast & moving)
