"""What a section between axle counters hears and keeps, what is true of it, and its configuration."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    BoolVar,
    NumVar,
    boolean,
    choice,
    enumeration,
    members,
    number,
)
from safeloc.language.units import COUNT

RESET = members("reset_answer", "NOT_ASKED", "ACCEPTED", "HEAD_DAMPED", "HEAD_FAULT", "AXLES_COUNTED", "AXLE_PASSED")
NOT_ASKED, ACCEPTED, HEAD_DAMPED, HEAD_FAULT, AXLES_COUNTED, AXLE_PASSED = RESET
SIDES = ("low", "high")
SWEEP = members("sweep", "NOBODY", "FROM_LOW", "FROM_HIGH", "RAN_THROUGH", "TURNED_LOW", "TURNED_HIGH")
NOBODY, FROM_LOW, FROM_HIGH, RAN_THROUGH, TURNED_LOW, TURNED_HIGH = SWEEP
PASSES = members("sweep_passes", "NO_HEAD", "IN_LOW", "IN_HIGH", "OUT_LOW", "OUT_HIGH")
NO_HEAD, IN_LOW, IN_HIGH, OUT_LOW, OUT_HIGH = PASSES


class AxleSectionConfig(Config):
    """What the section machine depends on."""

    axle_limit: int = quantity(1_000, "axles", 2, 100_000, "[D] trains of 250 wagons")
    axles_a_cycle: int = quantity(40, "axles", 1, 400, "[D] in 500 ms, 1.8 m apart, 350 km/h: 27, with room")
    lead_cycles: int = quantity(10, "cycles", 1, 100_000, "[M] 5 s at 500 ms without an axle before a reset")


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine. Axles per cycle at the low and at the high end, into and out of the section.

    fault     a head is disturbed, knows no direction, or cannot be heard
    damped    a wheel stands on a head
    reported_clear  the driver of the sweep reports that he left the section and found nothing in it
    count     axles counted in less those counted out; quiet: cycles without an axle
    swept_from, swept_to  since the reset, axles came in, went out, at that end
    axles     ghost: axles really in the section; true_into, true_out: those that really pass the heads in this cycle
    sweep     ghost: how far the sweep has come since a reset was last asked for; stood: axles in its way when it came in
    sweep_passes  which head the sweep's first or last axle passes in this cycle
    """

    config: AxleSectionConfig
    into: tuple[NumVar, ...]
    out: tuple[NumVar, ...]
    fault: BoolVar
    damped: BoolVar
    reset: BoolVar
    reported_clear: BoolVar
    count: NumVar
    quiet: NumVar
    swept_from: tuple[BoolVar, ...]
    swept_to: tuple[BoolVar, ...]
    answer: NumVar
    axles: NumVar
    true_into: tuple[NumVar, ...]
    true_out: tuple[NumVar, ...]
    sweep: NumVar
    stood: NumVar
    sweep_passes: NumVar


def parts(config: AxleSectionConfig) -> Parts:
    """Fresh variables for one section."""
    most, limit = config.axles_a_cycle, config.axle_limit
    return Parts(
        config,
        tuple(number(f"axles_in_{side}", COUNT, 0, most) for side in SIDES),
        tuple(number(f"axles_out_{side}", COUNT, 0, most) for side in SIDES),
        boolean("head_fault"),
        boolean("head_damped"),
        boolean("reset_requested"),
        boolean("sweep_reported_clear"),
        number("counted_axles", COUNT, 0, limit),
        number("quiet_cycles", COUNT, 0, config.lead_cycles),
        tuple(boolean(f"sweep_in_{side}") for side in SIDES),
        tuple(boolean(f"sweep_out_{side}") for side in SIDES),
        choice("answer", enumeration(RESET)),
        number("true_axles", COUNT, 0, 2 * limit),
        tuple(number(f"true_axles_in_{side}", COUNT, 0, most) for side in SIDES),
        tuple(number(f"true_axles_out_{side}", COUNT, 0, most) for side in SIDES),
        choice("true_sweep", enumeration(SWEEP)),
        number("true_axles_before_sweep", COUNT, 0, 2 * limit),
        choice("true_sweep_passes", enumeration(PASSES)),
    )
