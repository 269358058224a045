"""Inputs, state, ghosts and configuration of a section between axle counters."""

from __future__ import annotations

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    boolean,
    choice,
    enumeration,
    members,
    number,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT

RESET = members("reset_answer", "NOT_ASKED", "ACCEPTED", "HEAD_DAMPED", "HEAD_FAULT", "AXLES_COUNTED", "AXLE_PASSED")
NOT_ASKED, ACCEPTED, HEAD_DAMPED, HEAD_FAULT, AXLES_COUNTED, AXLE_PASSED = RESET
SIDES = ("low", "high")
_SWEEP = members("sweep", "NOBODY", "FROM_LOW", "FROM_HIGH", "RAN_THROUGH", "TURNED_LOW", "TURNED_HIGH")
NOBODY, FROM_LOW, FROM_HIGH, RAN_THROUGH, TURNED_LOW, TURNED_HIGH = _SWEEP
_PASSES = members("sweep_passes", "NO_HEAD", "IN_LOW", "IN_HIGH", "OUT_LOW", "OUT_HIGH")
NO_HEAD, IN_LOW, IN_HIGH, OUT_LOW, OUT_HIGH = _PASSES


class AxleSectionConfig(Config):
    """Figures of the section machine."""

    axle_limit: int = quantity(1_000, "axles", 2, 100_000, "[D] trains of 250 wagons")
    axles_a_cycle: int = quantity(40, "axles", 1, 400, "[D] in 500 ms, 1.8 m apart, 350 km/h: 27, with room")
    lead_cycles: int = quantity(10, "cycles", 1, 100_000, "[M] 5 s at 500 ms without an axle before a reset")


class Parts:
    """The variables of the machine. Axles per cycle at the low and at the high end, into and out of the section.

    fault     a head is disturbed, knows no direction, or does not report
    damped    a wheel stands on a head
    reported_clear  the driver of the sweep reports that he left the section and found nothing in it
    counted_axles     axles counted in less those counted out; quiet: cycles without an axle
    swept_from, swept_to  since the reset, axles came in, went out, at that end
    axles     ghost: axles really in the section; true_into, true_out: those that really pass the heads in this cycle
    sweep     ghost: progress of the sweep since the last request for reset; true_axles_before_sweep: axles in its way when it came in
    sweep_passes  head that the sweep's first or last axle passes in this cycle
    """

    def __init__(self, config: AxleSectionConfig) -> None:
        self.declared = declared = Declared()
        most, limit = config.axles_a_cycle, config.axle_limit
        self.config = config
        self.into = tuple(declared.sensor(number(f"axles_in_{side}", COUNT, 0, most)) for side in SIDES)
        self.out = tuple(declared.sensor(number(f"axles_out_{side}", COUNT, 0, most)) for side in SIDES)
        self.fault = declared.sensor(boolean("head_fault"))
        self.damped = declared.sensor(boolean("head_damped"))
        self.reset_requested = declared.sensor(boolean("reset_requested"))
        self.reported_clear = declared.sensor(boolean("sweep_reported_clear"))
        self.counted_axles = declared.state(number("counted_axles", COUNT, 0, limit), first=0)
        self.quiet = declared.state(number("quiet_cycles", COUNT, 0, config.lead_cycles), first=0)
        self.answer = declared.state(choice("answer", enumeration(RESET)), first=NOT_ASKED)
        self.swept_from = tuple(declared.state(boolean(f"sweep_in_{side}"), first=False) for side in SIDES)
        self.swept_to = tuple(declared.state(boolean(f"sweep_out_{side}"), first=False) for side in SIDES)
        self.axles = declared.ghost(number("true_axles", COUNT, 0, 2 * limit), first=ANY)
        self.sweep = declared.ghost(choice("true_sweep", enumeration(_SWEEP)), first=NOBODY)
        self.true_axles_before_sweep = declared.ghost(number("true_axles_before_sweep", COUNT, 0, 2 * limit), first=0)
        self.true_into = tuple(declared.choice(number(f"true_axles_in_{side}", COUNT, 0, most)) for side in SIDES)
        self.true_out = tuple(declared.choice(number(f"true_axles_out_{side}", COUNT, 0, most)) for side in SIDES)
        self.sweep_passes = declared.choice(choice("true_sweep_passes", enumeration(_PASSES)))


def parts(config: AxleSectionConfig) -> Parts:
    """Return fresh variables for one section."""
    return Parts(config)
