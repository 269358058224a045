"""Configuration and variables of the turn-off machine."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Num,
    NumVar,
    Optional,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.units import COUNT, MM
from safeloc.models.vocabulary.reflectors import LATERAL_LIMIT_MM

COURSE = members("course", "UNDECIDED", "STRAIGHT", "LEFT", "RIGHT")
UNDECIDED, STRAIGHT, LEFT, RIGHT = COURSE


class TurnOffConfig(Config):
    """How far a reflector's image moves, and how exactly that is measured."""

    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    lateral_error_mm: int = quantity(400, "mm", 0, 10_000, "[D] 3 mrad at 100 m, and 0.1 m of sway and survey")
    sway_mm: int = quantity(200, "mm", 0, 10_000, "[M] of the vehicle on straight track")
    straight_mm: int = quantity(1_000, "mm", 0, 50_000, "[D] sway and twice the lateral error")
    turn_mm: int = quantity(1_500, "mm", 1, 50_000, "[D] above what running straight on can show")
    least_shift_mm: int = quantity(2_500, "mm", 1, 50_000, "[D] turnout 1:9: 6.3 degrees, 2.5 m at 23 m of range")
    decide_mm: int = quantity(30_000, "mm beyond the switch", 0, 200_000, "[M] length of a turnout 1:9")
    give_up_mm: int = quantity(60_000, "mm beyond the switch", 0, 500_000, "[D] twice the turnout")
    miss_limit_cycles: int = quantity(20, "cycles", 1, 10_000, "[D] 2 s over the switch without a measurement")

    @model_validator(mode="after")
    def _can_decide(self) -> TurnOffConfig:
        noise = self.sway_mm + 2 * self.lateral_error_mm
        if self.turn_mm <= noise:
            raise ValueError(f"turn_mm {self.turn_mm} must exceed sway and twice the lateral error, {noise} mm.")
        if self.straight_mm >= self.least_shift_mm - 2 * self.lateral_error_mm:
            raise ValueError(
                "straight_mm must be below least_shift_mm less twice the lateral error, or turns are missed."
            )
        if self.give_up_mm < self.decide_mm:
            raise ValueError("give_up_mm must not be below decide_mm.")
        return self


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine. Lengths in mm.

    measured     the reflector behind the switch was measured in this cycle, at `lateral` (positive to the left)
    low, high    the reported interval of end A
    switch       the map's next facing switch, within the view zone of that reflector
    authorised   the course by map and movement authority
    true_switch  ghost: the switch whose reflector is measured
    true         ghost: the course the vehicle takes at that switch
    place, shift ghosts: where the reflector lies beside the axis before the switch, and how far its image has moved
    """

    config: TurnOffConfig
    measured: BoolVar
    lateral: NumVar
    low: NumVar
    high: NumVar
    switch: Optional
    authorised: NumVar
    here: NumVar
    noted: NumVar
    course: NumVar
    asked: NumVar
    misses: NumVar
    true_switch: NumVar
    true: NumVar
    next_true: NumVar
    place: NumVar
    next_place: NumVar
    shift: NumVar

    @property
    def motion(self) -> Num:
        """How far the image has moved since it was noted."""
        return self.lateral - self.noted

    @property
    def announced(self) -> Bool:
        """The map announces another switch; the vehicle is surely before it, and the reflector is measured."""
        return self.switch.present & self.switch.value.ne(self.here) & (self.high < self.switch.value) & self.measured

    @property
    def before(self) -> Bool:
        """The whole interval lies before the switch."""
        return self.high < self.here

    @property
    def through(self) -> Bool:
        """The whole interval lies beyond the turnout: a turn would show."""
        return self.low >= self.here + self.config.decide_mm

    @property
    def given_up(self) -> Bool:
        """The vehicle is far beyond the switch, or the reflector was not measured for too long."""
        far = self.low > self.here + self.config.give_up_mm
        return far | (~self.measured & (self.misses >= self.config.miss_limit_cycles))


def parts(config: TurnOffConfig) -> Parts:
    """Fresh variables for one machine."""
    limit, most, course = config.position_limit_mm, LATERAL_LIMIT_MM, enumeration(COURSE)
    return Parts(
        config=config,
        measured=boolean("reflector_measured"),
        lateral=number("lateral_mm", MM, -most, most),
        low=number("position_low_mm", MM, -limit, limit),
        high=number("position_high_mm", MM, -limit, limit),
        switch=optional("switch_position_mm", MM, -limit, limit),
        authorised=choice("authorised_course", course),
        here=number("switch_here_mm", MM, -limit - 1, limit),
        noted=number("noted_lateral_mm", MM, -most, most),
        course=choice("seen_course", course),
        asked=choice("asked_course", course),
        misses=number("unmeasured_cycles", COUNT, 0, config.miss_limit_cycles),
        true_switch=number("true_switch_mm", MM, -limit, limit),
        true=choice("true_course", course),
        next_true=choice("next_true_course", course),
        place=number("true_lateral_mm", MM, -2 * most, 2 * most),
        next_place=number("next_true_lateral_mm", MM, -2 * most, 2 * most),
        shift=number("true_shift_mm", MM, -4 * most, 4 * most),
    )
