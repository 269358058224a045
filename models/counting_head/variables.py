"""Inputs, state and ghosts of the adding up of a head's samples."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.language.declared import Declared
from safeloc.language.expr import Lit, boolean, choice, enumeration, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, UM, UM_PER_MM, UM_S
from safeloc.models.axle_head import AXLE
from safeloc.models.axle_head.variables import BESIDE_UM
from safeloc.models.counting_head.configuration import CountingHeadConfig


class Parts:
    """The variables of the machine.

    head_mode, counted        inputs: the head's mode and the axle that it counts in this sample, wired
    may_miss             input: a wheel may have passed in this sample that is not counted, wired
    samples              state: samples of this cycle so far
    axles_upwards, axles_downwards           state: axles of this cycle so far; one more than the counter takes stands for any more
    flawed               state: this cycle is at fault
    mode_before                  state: the head's mode in the sample before
    first_alone          state: samples in which the wheel on the head has damped the channel that it came to first alone; its greatest
                         value stands for a wheel that is slow, or went back, and for a head that is disturbed
    since_both           state: samples since the second channel was damped as well
    passes               choice: the wheel that truly passed in this sample, wired
    wheel_now, wheel_now_from_low   choices: the place of the wheel nearest to the head, and the side it came from, wired
    true_samples, true_axles_upwards, true_axles_downwards   ghosts: samples of this cycle, and wheels that passed in them
    wheel, from_low      ghosts: those of the wheel
    was_disturbed        ghost: the head was disturbed in the sample before
    speed, speed_came    ghosts: the wheel's speed, upwards along the line; and its magnitude when the wheel came on the head, 0 where
                         the head was disturbed since
    """

    def __init__(self, config: CountingHeadConfig, head_modes: Sequence[Lit]) -> None:
        self.declared = declared = Declared()
        self.config, self.head_modes = config, tuple(head_modes)
        self.cycle_samples, self.most = samples, most = config.samples, config.counter.axles_a_cycle
        slow, fastest = config.wheel.slow_samples, config.head.max_speed_mm_s * UM_PER_MM
        self.head_mode = declared.sensor(choice("head_mode", enumeration(self.head_modes)))
        self.counted = declared.sensor(choice("counted", enumeration(AXLE)))
        self.may_miss = declared.sensor(boolean("may_miss"))
        self.samples = declared.state(number("samples", COUNT, 0, samples), first=0)
        self.axles_upwards = declared.state(number("axles_upwards", COUNT, 0, most + 1), first=0)
        self.axles_downwards = declared.state(number("axles_downwards", COUNT, 0, most + 1), first=0)
        self.flawed = declared.state(boolean("cycle_flawed"), first=False)
        self.mode_before = declared.state(
            choice("head_mode_before", enumeration(self.head_modes)), first=self.head_modes[0]
        )
        self.first_alone = declared.state(number("first_alone", COUNT, 0, slow), first=0)
        self.since_both = declared.state(number("since_both", COUNT, 0, self.longest + 1), first=0)
        self.true_samples = declared.ghost(number("true_samples", COUNT, 0, samples), first=0)
        self.true_axles_upwards = declared.ghost(number("true_axles_upwards", COUNT, 0, samples), first=0)
        self.true_axles_downwards = declared.ghost(number("true_axles_downwards", COUNT, 0, samples), first=0)
        self.wheel = declared.ghost(number("wheel_um", UM, -BESIDE_UM, BESIDE_UM), first=-BESIDE_UM)
        self.from_low = declared.ghost(boolean("wheel_from_low"), first=False)
        self.was_disturbed = declared.ghost(boolean("head_was_disturbed"), first=False)
        self.speed = declared.ghost(number("speed_um_s", UM_S, -fastest, fastest), first=ANY)
        self.speed_came = declared.ghost(number("speed_came_um_s", UM_S, 0, fastest), first=0)
        self.passes = declared.choice(choice("wheel_passes", enumeration(AXLE)))
        self.wheel_now = declared.choice(number("wheel_now_um", UM, -BESIDE_UM, BESIDE_UM))
        self.wheel_now_from_low = declared.choice(boolean("wheel_now_from_low"))
        self.next_speed = declared.choice(number("next_speed_um_s", UM_S, -fastest, fastest))

    @property
    def longest(self) -> int:
        """The most samples since both channels were damped after which a wheel is counted without a fault."""
        wheel = self.config.wheel
        return wheel.times_as_long * wheel.slow_samples + wheel.more_samples
