"""A counting head through one cycle of the axle counter: its samples added up to what the counter hears (FVA-4, FVA-13).

    axle_head    one sample of both channels in a step: axles, direction, disturbance
    head_cycle   adds up the samples of a cycle of the counter: axles, their direction, and any fault in one of them

A step is a sample. The axle counter takes a step once a cycle (some two hundred samples), so the three are no composition. What
binds them is a contract of one cycle (models.vocabulary.head_contract): here it is proved of every row of samples that makes a cycle, and
the law that the counter's world assumes of each of its cycles follows from it, and allows besides that a channel stays damped. Cycles do
not overlap, and each sample is in one. A channel that stays damped and comes free by itself is told by how long a wheel damps each of the two;
one that is silent for another reason than that no wheel is there, by its current: the head is disturbed, and the cycle at fault.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Expr, Var
from safeloc.models import axle_head
from safeloc.models.axle_head import AxleHead
from safeloc.models.counting_head.configuration import CountingHeadConfig
from safeloc.models.counting_head.cycle import HeadCycle, head_cycle
from safeloc.models.counting_head.world import HEARD, PLACE

__all__ = ["TOLD_TO_THE_COUNTER", "CountingHead", "CountingHeadConfig", "compose_machines"]
NAME = "counting_head"
TOLD_TO_THE_COUNTER = {
    "cycle_axle": "axle",
    "cycle_axles": "axles_in_cycle",
    "cycle_fault": "head_fault",
    "cycle_damped": "head_damped",
}
"""Outputs of `head_cycle` at the end of a cycle -> inputs of the axle counter; without an axle `axles_in_cycle` is 1, its least."""


@dataclass(frozen=True, eq=False)
class CountingHead:
    """The composition and its machines."""

    config: CountingHeadConfig
    composition: Composition
    head: AxleHead
    cycle: HeadCycle


def compose_machines(config: CountingHeadConfig | None = None) -> CountingHead:
    """Compose the head and the adding up of its samples."""
    config = config or CountingHeadConfig()
    head = axle_head.build(axle_head.parts(config.head))
    cycle = head_cycle(config, head.machine.modes)
    wires: dict[Var, Expr] = {
        cycle.own.head_mode: head.machine.mode,
        cycle.own.counted: head.machine.output("counted"),
        cycle.own.may_miss: head.machine.flag("may_miss"),
        cycle.own.passes: head.own.passed,
        cycle.own.wheel_now: head.own.wheel,
        cycle.own.wheel_now_from_low: head.own.from_low,
    }
    whole = compose(
        NAME, [head.machine, cycle.machine], wires, discharge=[Clause(cycle.machine, one) for one in (HEARD, PLACE)]
    )
    return CountingHead(config, whole, head, cycle)
