"""Configuration and variables of the turn-off machine."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    Num,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM
from safeloc.models.vocabulary.reflectors import LATERAL_LIMIT_MM

COURSE = members("course", "UNDECIDED", "STRAIGHT", "LEFT", "RIGHT")
UNDECIDED, STRAIGHT, LEFT, RIGHT = COURSE


class TurnOffConfig(Config):
    """Figures of the image's lateral motion and of its measurement."""

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


class Parts:
    """The variables of the machine. Lengths in mm.

    measured     the reflector behind the switch was measured in this cycle, at `lateral` (positive to the left)
    low, high    the reported interval of end A
    switch_position       the map's next facing switch, within the view zone of that reflector
    authorised_course   the course by map and movement authority
    true_switch  ghost: the switch whose reflector is measured
    true_course         ghost: the course the vehicle takes at that switch
    place, shift ghosts: lateral place of the reflector before the switch, and the lateral motion of its image since then
    here         the switch that is watched; its lowest value: none
    noted_lateral        lateral place of the image before the switch
    course       the course seen; UNDECIDED: none yet
    asked_course        the course by map and movement authority, as received last
    unmeasured       cycles in a row without a measurement, over the switch
    """

    def __init__(self, config: TurnOffConfig) -> None:
        self.declared = declared = Declared()
        limit, most, course = config.position_limit_mm, LATERAL_LIMIT_MM, enumeration(COURSE)
        self.config = config
        self.measured = declared.sensor(boolean("reflector_measured"))
        self.lateral = declared.sensor(number("lateral_mm", MM, -most, most))
        self.low = declared.sensor(number("position_low_mm", MM, -limit, limit))
        self.high = declared.sensor(number("position_high_mm", MM, -limit, limit))
        self.switch_position = declared.sensor(optional("switch_position_mm", MM, -limit, limit))
        self.authorised_course = declared.sensor(choice("authorised_course", course))
        self.here = declared.state(number("switch_here_mm", MM, -limit - 1, limit), first=-limit - 1)
        self.noted_lateral = declared.state(number("noted_lateral_mm", MM, -most, most), first=0)
        self.course = declared.state(choice("seen_course", course), first=UNDECIDED)
        self.asked_course = declared.state(choice("asked_course", course), first=UNDECIDED)
        self.unmeasured = declared.state(number("unmeasured_cycles", COUNT, 0, config.miss_limit_cycles), first=0)
        self.true_switch = declared.ghost(number("true_switch_mm", MM, -limit, limit), first=ANY)
        self.true_course = declared.ghost(choice("true_course", course), first=ANY)
        self.true_lateral = declared.ghost(number("true_lateral_mm", MM, -2 * most, 2 * most), first=ANY)
        self.next_true_course = declared.choice(choice("next_true_course", course))
        self.next_true_lateral = declared.choice(number("next_true_lateral_mm", MM, -2 * most, 2 * most))
        self.shift = declared.choice(number("true_shift_mm", MM, -4 * most, 4 * most))

    @property
    def motion(self) -> Num:
        """Lateral motion of the image since its place was noted, mm."""
        return self.lateral - self.noted_lateral

    @property
    def announced(self) -> Bool:
        """The map announces another switch; the vehicle is surely before it, and the reflector is measured."""
        return (
            self.switch_position.present
            & self.switch_position.value.ne(self.here)
            & (self.high < self.switch_position.value)
            & self.measured
        )

    @property
    def before(self) -> Bool:
        """The whole interval lies before the switch."""
        return self.high < self.here

    @property
    def through(self) -> Bool:
        """The whole interval lies beyond the turnout: a turn would show by now."""
        return self.low >= self.here + self.config.decide_mm

    @property
    def given_up(self) -> Bool:
        """The vehicle is far beyond the switch, or the radar has not measured the reflector for too long."""
        far = self.low > self.here + self.config.give_up_mm
        return far | (~self.measured & (self.unmeasured >= self.config.miss_limit_cycles))


def parts(config: TurnOffConfig) -> Parts:
    """Return fresh variables for one machine."""
    return Parts(config)
