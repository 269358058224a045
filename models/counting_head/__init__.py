"""A counting head through one cycle of the axle counter: its samples added up to what the counter hears (FVA-4, FVA-13).

    axle_head    one sample of both channels in a step: axles, direction, disturbance
    head_cycle   adds up the samples of a cycle of the counter: axles, their direction, and any fault in one of them

A step is a sample. The axle counter takes a step once a cycle (some two hundred samples), so the three are no composition. What
binds them is a contract of one cycle (models.vocabulary.head_contract): here it is proved of every row of samples that makes a cycle, and
the law that the counter's world assumes of each of its cycles follows from it, and allows besides that a channel stays damped. Cycles do
not overlap, and each sample is in one.
"""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Expr, Var
from safeloc.language.units import US_PER_MS
from safeloc.models import axle_head
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.axle_head import AxleHead, AxleHeadConfig
from safeloc.models.counting_head.cycle import HEARD, HeadCycle, head_cycle

__all__ = ["CountingHead", "CountingHeadConfig", "compose_machines"]
NAME = "counting_head"


class CountingHeadConfig(Config):
    """The head, and the counter whose cycle its samples make."""

    head: AxleHeadConfig = AxleHeadConfig()
    counter: AxleCounterConfig = AxleCounterConfig()

    @model_validator(mode="after")
    def _samples_make_a_cycle(self) -> CountingHeadConfig:
        cycle_us = self.counter.period_ms * US_PER_MS
        if cycle_us % self.head.sample_us or cycle_us == self.head.sample_us:
            raise InputError(
                f"a cycle of {cycle_us} us is no whole number of samples of {self.head.sample_us} us, or only one: a sample would "
                "belong to two cycles; change head.sample_us."
            )
        if self.head.max_speed_mm_s != self.counter.max_speed_mm_s:
            raise InputError(
                f"head.max_speed_mm_s is {self.head.max_speed_mm_s}, but the counter's is {self.counter.max_speed_mm_s}; make them the same."
            )
        return self

    @property
    def samples(self) -> int:
        """The number of samples in a cycle of the counter."""
        return self.counter.period_ms * US_PER_MS // self.head.sample_us


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
    cycle = head_cycle(config.samples, config.counter.axles_a_cycle, head.machine.modes)
    wires: dict[Var, Expr] = {
        cycle.own.head_mode: head.machine.mode,
        cycle.own.counted: head.machine.output("counted"),
        cycle.own.passes: head.own.passed,
    }
    whole = compose(NAME, [head.machine, cycle.machine], wires, discharge=[Clause(cycle.machine, HEARD)])
    return CountingHead(config, whole, head, cycle)
