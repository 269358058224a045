"""The world of a counting head: a wheel that rolls over two channels whose stretches overlap.

    A alone         A and B        B alone
|--------------|==============|--------------|
0           spacing   spacing + overlap    2 spacing + overlap
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, NumVar, between, ite
from safeloc.language.units import UM, UM_PER_MM, US_PER_S
from safeloc.language.world import Law, World
from safeloc.models.axle_head.variables import DOWN, NO_AXLE, UP, AxleHeadConfig, Parts

SAMPLED = ("max_speed_mm_s", "sample_us")


def world(own: Parts) -> World:
    """Return the world: the wheel nearest to the head, and the side from which it came."""
    return own.declared.world(
        moves={own.wheel: own.next_wheel, own.from_low: _from_low(own), own.passed: _passed(own)},
        clauses=_clauses(own),
    )


def _length_um(config: AxleHeadConfig) -> int:
    """Return the distance from the place where a wheel begins to damp A to the one where it no longer damps B, um."""
    return (2 * config.spacing_mm + config.overlap_mm) * UM_PER_MM


def _over_head(wheel: NumVar, config: AxleHeadConfig) -> Bool:
    """Return the condition that the wheel damps some channel."""
    return between(0, wheel, _length_um(config) - 1)


def _clauses(own: Parts) -> dict[str, Bool | Law]:
    config, then = own.config, own.next_wheel
    reaches = (config.spacing_mm + config.overlap_mm) * UM_PER_MM
    over_a, over_b = between(0, then, reaches - 1), between(_length_um(config) - reaches, then, _length_um(config) - 1)
    run = Lit(-(-config.max_speed_mm_s * config.sample_us * UM_PER_MM // US_PER_S), UM)
    off = ~_over_head(own.wheel, config) & ~_over_head(then, config)
    return {
        "a channel that is alive is damped where the wheel is": Law(
            own.channel_a_alive.implies(own.channel_a_damped.iff(over_a))
            & own.channel_b_alive.implies(own.channel_b_damped.iff(over_b)),
            "A channel whose current lies in the range of a sound one is damped as long as a wheel is on its stretch, and by nothing else; the "
            "stretches overlap. Any other channel may tell anything.",
            figures=("spacing_mm", "overlap_mm"),
            source="[S] DP 1 728 700: overlapping pulses; [M, fairly sure] the quiescent current of a wheel sensor is watched",
            owner="supplier",
            check="type test with the smallest wheel, a cut and a shorted cable, and a sensor off the rail, each told before a sample is wrong; brakes "
            "and other metal disturb the head and are reported by it",
        ),
        "wheels do not jump": Law(
            between(-run, then - own.wheel, run) | off,
            "Between two samples a wheel that is on the head, before or after, runs no farther than at the highest speed. Of two wheels that "
            "follow each other, the first has left the head before the second comes; off the head the nearest one may be another than before.",
            figures=SAMPLED,
            source="[M] the smallest distance of two axles, about a metre, is longer than the head",
            owner="operator",
            check="vehicle approval; top speed of the line",
        ),
    }


def _from_low(own: Parts) -> Bool:
    comes = ~_over_head(own.wheel, own.config) & _over_head(own.next_wheel, own.config)
    zero: Num = Lit(0, UM)
    return ite(comes, own.wheel < zero, own.from_low)


def _passed(own: Parts) -> Num:
    """Return the direction of a wheel that leaves the head in this sample, on the other side than that from which it came."""
    leaves = _over_head(own.wheel, own.config) & ~_over_head(own.next_wheel, own.config)
    above, zero = Lit(_length_um(own.config), UM), Lit(0, UM)
    through_up = leaves & own.from_low & (own.next_wheel >= above)
    through_down = leaves & ~own.from_low & (own.next_wheel < zero)
    return ite(through_up, UP, ite(through_down, DOWN, NO_AXLE))
