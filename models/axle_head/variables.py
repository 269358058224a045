"""Inputs, state, ghosts and configuration of a counting head."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import boolean, choice, enumeration, members, number
from safeloc.language.units import UM, US_PER_S

AXLE = members("axle", "NONE", "UP", "DOWN")
NO_AXLE, UP, DOWN = AXLE
BESIDE_UM = 100_000_000
"Greatest distance of a wheel from the head in the world, um: 100 m."


class AxleHeadConfig(Config):
    """Sampling and dimensions of a head. ValueError if a wheel could pass between two samples."""

    sample_us: int = quantity(500, "us", 1, 100_000, "[M] 2 kHz")
    overlap_mm: int = quantity(60, "mm", 1, 1_000, "[M, unsure] shortest stretch in which a wheel damps both channels")
    spacing_mm: int = quantity(150, "mm", 1, 1_000, "[M, unsure] between the two channels")
    spacing_error_mm: int = quantity(2, "mm", 0, 100, "[M, unsure]")
    max_speed_mm_s: int = quantity(100_000, "mm/s", 1, 138_889, "[M, sure] 350 km/h, rounded up")

    @model_validator(mode="after")
    def _sampled_often_enough(self) -> AxleHeadConfig:
        run = self.max_speed_mm_s * self.sample_us
        if run >= self.overlap_mm * US_PER_S:
            raise ValueError(
                f"in {self.sample_us} us a wheel runs {run / US_PER_S:.1f} mm, and damps both channels for only "
                f"{self.overlap_mm} mm; sample more often."
            )
        if self.spacing_error_mm >= self.spacing_mm:
            raise ValueError("spacing_error_mm has to lie below spacing_mm.")
        alone = self.spacing_mm - self.spacing_error_mm
        if run >= alone * US_PER_S:
            raise ValueError(
                f"in {self.sample_us} us a wheel runs {run / US_PER_S:.1f} mm, and damps one channel alone for only "
                f"{alone} mm; sample more often."
            )
        return self


class Parts:
    """The variables: channels damped, the axle counted in this sample.

    channel_a_damped, channel_b_damped   inputs: the channel's current is that of a damped one
    channel_a_alive, channel_b_alive     inputs: the channel's current lies in the range of a sound channel, damped or free
    ended     state: a disturbance has ended in this sample
    wheel     ghost: where the wheel nearest to the head is, upwards from where it begins to damp channel A
    from_low  ghost: the wheel over the head came from below
    passed    ghost: the wheel that left the head in this sample on the side that it did not come from, by its direction
    """

    def __init__(self, config: AxleHeadConfig) -> None:
        self.declared = declared = Declared()
        self.config = config
        self.channel_a_damped = declared.sensor(boolean("channel_a_damped"))
        self.channel_b_damped = declared.sensor(boolean("channel_b_damped"))
        self.channel_a_alive = declared.sensor(boolean("channel_a_alive"))
        self.channel_b_alive = declared.sensor(boolean("channel_b_alive"))
        self.axle = declared.state(choice("axle", enumeration(AXLE)), first=NO_AXLE)
        self.ended = declared.state(boolean("disturbance_ended"), first=False)
        self.wheel = declared.ghost(number("wheel_um", UM, -BESIDE_UM, BESIDE_UM), first=-BESIDE_UM)
        self.from_low = declared.ghost(boolean("wheel_from_low"), first=False)
        self.passed = declared.ghost(choice("wheel_passed", enumeration(AXLE)), first=NO_AXLE)
        self.next_wheel = declared.choice(number("next_wheel_um", UM, -BESIDE_UM, BESIDE_UM))


def parts(config: AxleHeadConfig) -> Parts:
    """Return fresh variables for one head."""
    return Parts(config)
