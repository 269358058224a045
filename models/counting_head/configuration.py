"""Configuration of a counting head through a cycle: the head, the counter whose cycle its samples make, and how long a wheel takes."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.errors import InputError
from safeloc.language.units import MS_PER_S, UM_PER_MM, US_PER_MS, US_PER_S
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.axle_head import AxleHeadConfig
from safeloc.models.counting_head.late_wheels import late_um
from safeloc.models.counting_head.spans import least_samples, slowest_um_s, spans


class WheelTimes(Config):
    """Samples for which a wheel that is counted may damp the head."""

    slow_samples: int = quantity(
        200,
        "samples",
        4,
        10_000,
        "[D] the first channel alone for 100 ms: 1.5 m/s, a slower wheel may stop on the head",
    )
    times_as_long: int = quantity(
        3, "", 2, 100, "[D] the rest of a steady wheel takes 1.4 times as long, half as long again when braking"
    )
    more_samples: int = quantity(2, "samples", 0, 1_000, "[D] each of the two times is known to one sample")
    sure_speed_mm_s: int = quantity(1_700, "mm/s", 1, 138_889, "[D] 6 km/h: no wheel that comes faster is refused")


class CountingHeadConfig(Config):
    """The head, and the counter whose cycle its samples make."""

    head: AxleHeadConfig = AxleHeadConfig()
    counter: AxleCounterConfig = AxleCounterConfig()
    wheel: WheelTimes = WheelTimes()

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

    @model_validator(mode="after")
    def _wheels_are_told_from_channels_that_stay_damped(self) -> CountingHeadConfig:
        found = spans(self)
        told = found[-1].most + 1 if found else least_samples(self)
        if told < self.wheel.slow_samples:
            raise InputError(
                f"a wheel that damps the first channel alone for {told} samples may brake, and be refused: the rest may take more than "
                f"{self.wheel.times_as_long} times as long; raise wheel.times_as_long, or lower wheel.slow_samples."
            )
        if (self.wheel.slow_samples - 1) * slowest_um_s(self) * self.head.sample_us <= self.alone_um * US_PER_S:
            raise InputError(
                f"a wheel that comes at {self.wheel.sure_speed_mm_s} mm/s may damp the first channel alone for wheel.slow_samples "
                f"({self.wheel.slow_samples}), and be refused; raise wheel.sure_speed_mm_s, or wheel.slow_samples."
            )
        if late_um(self) > self.counter.late_mm * UM_PER_MM:
            raise InputError(
                f"a wheel may be counted {late_um(self)} um beyond the head without a fault, but the counter leaves room for counter.late_mm "
                f"({self.counter.late_mm}) only; raise it, or lower wheel.times_as_long or wheel.more_samples."
            )
        return self

    @property
    def samples(self) -> int:
        """The number of samples in a cycle of the counter."""
        return self.counter.period_ms * US_PER_MS // self.head.sample_us

    @property
    def change_um_s(self) -> int:
        """Greatest change of a wheel's speed from one sample to the next, um/s rounded up."""
        return -(-self.counter.change_mm_s2 * self.head.sample_us // MS_PER_S)

    @property
    def alone_um(self) -> int:
        """Stretch of a channel that a wheel damps alone, um."""
        return self.head.spacing_mm * UM_PER_MM

    @property
    def end_um(self) -> int:
        """Stretch of the whole head, um."""
        return (2 * self.head.spacing_mm + self.head.overlap_mm) * UM_PER_MM

    @property
    def unsure_um_s(self) -> int:
        """Speed that a run of one sample leaves unsure, um/s: places are whole um, and the speed changes within the sample."""
        return -(-US_PER_S // self.head.sample_us) + self.change_um_s
