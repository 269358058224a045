"""Bounds how far beyond the head a wheel has run on that a channel counts late and that is no fault (FVA-4).

The bound is proved by tests/theorems/fibre/late_channel.py, over spans of wheels: those that damped the first channel alone for more than
`above` samples, and for `most` at most.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from safeloc.language.units import UM_PER_MM, US_PER_S
from safeloc.models.counting_head.spans import least_samples

if TYPE_CHECKING:
    from safeloc.models.counting_head.configuration import CountingHeadConfig


def late_spans(config: CountingHeadConfig) -> list[tuple[int, int]]:
    """Return spans, each half as large again as the one before, up to the slowest wheel that is not refused."""
    ends = [least_samples(config) - 1]
    while ends[-1] < config.wheel.slow_samples - 1:
        ends.append(min(max(ends[-1] + 1, ends[-1] * 3 // 2), config.wheel.slow_samples - 1))
    return list(pairwise(ends))


def came_um_s(config: CountingHeadConfig, above: int) -> int:
    """Return the highest speed, um/s, at which a wheel of a span came."""
    fastest = config.head.max_speed_mm_s * UM_PER_MM
    if above < 1:
        return fastest + config.unsure_um_s
    return -(-config.alone_um * US_PER_S // (above * config.head.sample_us)) + config.unsure_um_s


def pace_um_s(config: CountingHeadConfig, above: int, most: int) -> int:
    """Return the highest speed, um/s, of a wheel until it is counted without a fault, with what is unsure."""
    rest = config.wheel.times_as_long * most + config.wheel.more_samples
    accelerated = came_um_s(config, above) + config.change_um_s * (most + rest + 1) + config.unsure_um_s
    return min(accelerated, config.head.max_speed_mm_s * UM_PER_MM)


def late_um(config: CountingHeadConfig) -> int:
    """Return how far beyond the head a wheel is at most that is counted without a fault, um."""
    wheel = config.wheel
    farthest = [
        (wheel.times_as_long * most + wheel.more_samples + 1)
        * pace_um_s(config, above, most)
        * config.head.sample_us
        // US_PER_S
        for above, most in late_spans(config)
    ]
    return max(farthest, default=0) + config.alone_um - config.end_um
