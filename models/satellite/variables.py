"""Configuration, variables and the kinematic state of the satellite position machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pydantic import Field, model_validator

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
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, PER_MILLE, UM_S
from safeloc.models.satellite_selection import SelectionConfig

REASON = members("reason", "LOCATED", "NO_REFERENCE", "TOLERANCE", "COASTED_OUT", "CONTRADICTION", "DRIFT")
LOCATED, NO_REFERENCE, TOLERANCE, COASTED_OUT, CONTRADICTION, DRIFT = REASON
FIX = members(
    "fix", "NONE", "ACCEPTED", "NOT_USABLE", "TOO_FEW", "DISJOINT", "TOO_COARSE", "UNLOCATED", "DRIFTED"
)  # fmt: skip
NO_FIX, ACCEPTED, NOT_USABLE, TOO_FEW, DISJOINT, TOO_COARSE, NOT_LOCATED, DRIFTED = FIX
MISSING = members(
    "missing", "NOTHING", "NO_EPOCH", "NO_PREDICTION", "TWO_PORTIONS", "NONE_LEFT", "FEW_LEFT", "ALIKE", "OUT_OF_RANGE"
)  # fmt: skip
MAX_UNKNOWNS, MAX_DILUTION_PERMILLE = 8, 20_000
Redundancy = Literal["solve", "detect", "exclude"]
SPARE: dict[Redundancy, int] = {"solve": 0, "detect": 1, "exclude": 2}
"""Satellites beyond the unknowns: along the track 2, 3 and 4 of them, free of it 4, 5 and 6 (figures, section 6)."""


class SatelliteConfig(Config):
    """What position from satellites depends on.

    redundancy       how many satellites a solution needs: enough to solve, to detect a fault, to exclude one
    drift_check      where present: solutions are held against odometry while it is at hand; required: nothing is
                     reported without it
    state_error_mm, state_speed_error_mm_s   errors of the state up to which no healthy satellite is excluded
    """

    selection: SelectionConfig = SelectionConfig()
    period_ms: int = quantity(200, "ms", 2, 2_000, "[D] 5 Hz; a multiple of 2")
    tolerance_mm: int = quantity(30_000, "mm", 2, 500_000, "[S] OCORA 7239: 30 m on main line")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(1_500, "mm/s2", 1, 10_000, "[D] 1.5 m/s2, passenger")
    redundancy: Redundancy = Field(default="detect", description="satellites that a solution needs")
    coast_limit_cycles: int = quantity(10, "cycles", 0, 10_000, "[D] 2 s at 5 Hz")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    protection_limit_mm: int = quantity(30_000, "mm", 1, 1_000_000, "[S] RHINOS: 12 m along track; 30 m tolerable")
    drift_check: Literal["where present", "required"] = Field(
        default="where present", description="solutions held against odometry"
    )
    anchor_limit_mm: int = quantity(1_000_000, "mm", 1, 100_000_000, "[D] beyond 1 km odometry bounds nothing of use")
    place_gain_percent: int = quantity(25, "%", 1, 100, "[D] place estimate moves a quarter of the way to a solution")
    state_error_mm: int = quantity(3_000, "mm", 0, 1_000_000, "[D] what good geometry leaves of 2.56 m")
    state_speed_error_mm_s: int = quantity(100, "mm/s", 0, 1_000_000, "[D] what good geometry leaves of 0.19 m/s")

    @model_validator(mode="after")
    def _can_locate(self) -> SatelliteConfig:
        if self.period_ms % 2:
            raise ValueError("period_ms must be even, so that half of an acceleration's way is whole nanometres.")
        least = 2 + SPARE[self.redundancy]
        if least > self.selection.channels:
            raise ValueError(f"{least} satellites are needed, and the receiver has {self.selection.channels} channels.")
        return self

    @model_validator(mode="after")
    def _bounds_signals(self) -> SatelliteConfig:
        """A protection level follows from what a usable signal may be wrong by, and is never below it."""
        chosen = self.selection
        if chosen.removal == "both":
            raise ValueError(
                "removal 'both' keeps signals of any error, so that no protection level follows for a position; take 'either'."
            )
        if chosen.compared != "doppler" and chosen.usable_range_error_mm > self.protection_limit_mm:
            raise ValueError(
                f"a usable signal may be {chosen.usable_range_error_mm} mm wrong (threshold, prediction and clock together), "
                f"and no solution is better: none would be within protection_limit_mm {self.protection_limit_mm}; lower "
                "the thresholds or raise the limit."
            )
        return self

    @model_validator(mode="after")
    def _keeps_healthy_ones(self) -> SatelliteConfig:
        """The threshold rule, second half: the prediction's bound holds what one cycle can make of the state's error."""
        rows = (
            ("range_prediction_mm", self.selection.range_prediction_mm, self.least_range_prediction_mm),
            ("speed_prediction_mm_s", self.selection.speed_prediction_mm_s, self.least_speed_prediction_mm_s),
        )
        for name, value, least in rows:
            if value < least:
                raise ValueError(
                    f"{name} {value} is below the predictor's error {least} (state error, and acceleration over "
                    f"{self.period_ms} ms): healthy satellites would be excluded; raise it and the threshold."
                )
        return self

    @property
    def speed_change_um_s(self) -> int:
        """The greatest change of speed in a cycle."""
        return self.max_acceleration_mm_s2 * self.period_ms

    @property
    def way_nm(self) -> int:
        """The greatest way that an acceleration adds in a cycle, A T^2 / 2."""
        return self.max_acceleration_mm_s2 * self.period_ms * self.period_ms // 2

    @property
    def way_at_most_nm(self) -> int:
        """The farthest that a vehicle comes in a cycle."""
        return self.max_speed_mm_s * 1_000 * self.period_ms + self.way_nm

    @property
    def stopping_ms(self) -> int:
        """So long at the present speed is no shorter a way than the one to a stop, from any speed."""
        return -(-self.way_at_most_nm // self.speed_change_um_s)

    @property
    def least_range_prediction_mm(self) -> int:
        """State error + its speed error over T + A T^2: predictor and truth may differ by 2 A ([D] figures, section 6)."""
        nm = self.state_error_mm * NM_PER_MM + self.state_speed_error_mm_s * self.period_ms * 1_000 + 2 * self.way_nm
        return -(-nm // NM_PER_MM)

    @property
    def least_speed_prediction_mm_s(self) -> int:
        """State speed error + 2 A T."""
        return self.state_speed_error_mm_s + -(-2 * self.speed_change_um_s // 1_000)


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the position machine.

    usable, used  inputs per channel: it is in the list (wired from the selection); the solution uses it
    fix           input: along-track place of the solution
    dilution      input: how far errors of one metre in each used signal can move it at most, the sum of |weight|
    further       input: what comes to its error beside the signals': map, bend of the track, time, rounding
    fix_speed, speed_dilution, speed_further   the same of its speed, from range rates
    unknowns      input: what the solution solved for: 2 along the track, 4 free of it, one more for each further clock
    missing       input: why there is no solution
    reference     input: a trusted place (a balise) with its accuracy; reference_speed: trusted too, where it is known
    odometry      input: run since the cycle before, by what knows nothing of satellites, with the error of this run
    position, low, high       the estimated place, and the bounds that hold the true one; speed, slowest, fastest alike
    change        of the estimated speed in the last cycle
    anchored      position and odometry since the last reference are comparable; anchor_offset: the position less that
                  place, anchor_margin: what odometry may be wrong by
    truth, true_speed  ghosts: nm and um/s
    bounded, compared  ghosts per channel: the signal's error keeps the bound that a usable one is to keep; prediction
                  and clock are as good as configured
    """

    config: SatelliteConfig
    usable: tuple[BoolVar, ...]
    used: tuple[BoolVar, ...]
    fix: Optional
    dilution: NumVar
    further: NumVar
    fix_speed: NumVar
    speed_dilution: NumVar
    speed_further: NumVar
    unknowns: NumVar
    missing: NumVar
    reference: Optional
    accuracy: NumVar
    reference_speed: Optional
    speed_accuracy: NumVar
    odometry: Optional
    odometry_error: NumVar
    position: NumVar
    low: NumVar
    high: NumVar
    speed: NumVar
    slowest: NumVar
    fastest: NumVar
    change: NumVar
    coasted: NumVar
    anchored: BoolVar
    anchor_offset: NumVar
    anchor_margin: NumVar
    judged: NumVar
    why_missing: NumVar
    reason: NumVar
    truth: NumVar
    true_speed: NumVar
    next_truth: NumVar
    next_speed: NumVar
    bounded: tuple[BoolVar, ...]
    compared: tuple[BoolVar, ...]


def parts(config: SatelliteConfig) -> Parts:
    """Fresh variables for one machine."""
    limit, fast = config.position_limit_mm, config.max_speed_mm_s * 1_000
    reach, channels = (limit + 2 * config.tolerance_mm) * NM_PER_MM, range(1, config.selection.channels + 1)
    widest, cycle = 2 * fast, -(-config.way_at_most_nm // NM_PER_MM)
    apart = (config.tolerance_mm + config.anchor_limit_mm) * NM_PER_MM
    return Parts(
        config,
        tuple(boolean(f"usable_{n}") for n in channels),
        tuple(boolean(f"used_{n}") for n in channels),
        optional("fix_mm", MM, -limit, limit),
        number("fix_dilution_permille", PER_MILLE, 0, MAX_DILUTION_PERMILLE),
        number("fix_further_mm", MM, 0, 10 * config.protection_limit_mm),
        number("fix_speed_um_s", UM_S, -fast, fast),
        number("fix_speed_dilution_permille", PER_MILLE, 0, MAX_DILUTION_PERMILLE),
        number("fix_speed_further_um_s", UM_S, 0, widest),
        number("fix_unknowns", COUNT, 2, MAX_UNKNOWNS),
        choice("fix_missing", enumeration(MISSING)),
        optional("reference_mm", MM, -limit, limit),
        number("reference_accuracy_mm", MM, 0, config.tolerance_mm),
        optional("reference_speed_um_s", UM_S, -fast, fast),
        number("reference_speed_accuracy_um_s", UM_S, 0, widest),
        optional("odometry_mm", MM, -2 * cycle, 2 * cycle),
        number("odometry_error_mm", MM, 0, 2 * cycle),
        number("position_nm", NM, -limit * NM_PER_MM, limit * NM_PER_MM),
        number("low_nm", NM, -reach, reach),
        number("high_nm", NM, -reach, reach),
        number("speed_um_s", UM_S, -fast, fast),
        number("slowest_um_s", UM_S, -fast, fast),
        number("fastest_um_s", UM_S, -fast, fast),
        number("change_um_s", UM_S, -config.speed_change_um_s, config.speed_change_um_s),
        number("coasted_cycles", COUNT, 0, config.coast_limit_cycles),
        boolean("anchored"),
        number("anchor_offset_nm", NM, -apart, apart),
        number("anchor_margin_nm", NM, 0, config.anchor_limit_mm * NM_PER_MM),
        choice("fix_judged", enumeration(FIX)),
        choice("missing", enumeration(MISSING)),
        choice("reason", enumeration(REASON)),
        number("truth_nm", NM, -reach, reach),
        number("true_speed_um_s", UM_S, -fast, fast),
        number("next_truth_nm", NM, -reach, reach),
        number("next_speed_um_s", UM_S, -fast, fast),
        tuple(boolean(f"signal_bounded_{n}") for n in channels),
        tuple(boolean(f"signal_compared_{n}") for n in channels),
    )


@dataclass(frozen=True, eq=False)
class State:
    """Place and speed: estimates, and the bounds that hold the true ones: nm, um/s."""

    position: Num
    low: Num
    high: Num
    speed: Num
    slowest: Num
    fastest: Num

    @property
    def below(self) -> Num:
        """How far the true place may lie behind the estimate."""
        return self.position - self.low

    @property
    def above(self) -> Num:
        """How far it may lie ahead of it."""
        return self.high - self.position

    def meets(self, other: State) -> Bool:
        """Whether both have a place and a speed in common."""
        place = (self.low <= other.high) & (other.low <= self.high)
        return place & (self.slowest <= other.fastest) & (other.slowest <= self.fastest)


def around(position: Num, margin: Num, speed: Num, speed_margin: Num) -> State:
    """Estimates with the same margin on either side."""
    return State(position, position - margin, position + margin, speed, speed - speed_margin, speed + speed_margin)


def held(own: Parts) -> State:
    """The machine's state."""
    return State(own.position, own.low, own.high, own.speed, own.slowest, own.fastest)
