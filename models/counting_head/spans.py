"""Wheels by the samples in which they damp the first channel alone: how slow they are at most, and how soon they are off the head."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from safeloc.language.units import UM_PER_MM, US_PER_S

if TYPE_CHECKING:
    from safeloc.models.counting_head.configuration import CountingHeadConfig


@dataclass(frozen=True)
class Span:
    """Wheels that damped the first channel alone for more than `above` samples, and for `most` at most.

    came_um_s  speed at the beginning of the slowest of them, um/s
    rest       samples after which each of them has left the head
    left_um_s  speed of the slowest of them until then, um/s, less what is unsure
    """

    above: int
    most: int
    came_um_s: int
    rest: int
    left_um_s: int


def _span(config: CountingHeadConfig, above: int, most: int) -> Span:
    came = (config.alone_um * US_PER_S - 1) // ((most + 1) * config.head.sample_us) - config.unsure_um_s
    rest = config.wheel.times_as_long * (above + 1) + config.wheel.more_samples
    return Span(above, most, came, rest, came - config.change_um_s * (most + rest) - config.unsure_um_s)


def _leaves(config: CountingHeadConfig, span: Span) -> bool:
    """Return whether each wheel of the span has left the head before the time that is allowed for it is over."""
    way = (config.end_um - config.alone_um) * US_PER_S
    return span.left_um_s > 0 and span.rest * span.left_um_s * config.head.sample_us > way


def spans(config: CountingHeadConfig) -> list[Span]:
    """Return spans up to the slowest wheel that is not refused, each as wide as it can be; only up to where a wheel may be refused."""
    above = least_samples(config) - 1
    found = list[Span]()
    while fits := _fitting(config, above):
        found.append(fits[-1])
        above = fits[-1].most
    return found


def _fitting(config: CountingHeadConfig, above: int) -> list[Span]:
    """Return the spans from there on of which each wheel leaves the head in time, the widest last; none where all are done."""
    some = (_span(config, above, most) for most in range(above + 1, config.wheel.slow_samples))
    return [one for one in some if _leaves(config, one)]


def least_samples(config: CountingHeadConfig) -> int:
    """Return the fewest samples in which a wheel damps the first channel alone: those at the highest speed."""
    return config.alone_um * US_PER_S // (config.head.max_speed_mm_s * UM_PER_MM * config.head.sample_us)


def slowest_um_s(config: CountingHeadConfig) -> int:
    """Return a speed, um/s, that no wheel that comes at the sure speed falls below while it damps the first channel alone."""
    wheel = config.wheel
    return wheel.sure_speed_mm_s * UM_PER_MM - config.change_um_s * wheel.slow_samples - config.unsure_um_s
