"""Configuration, variables and the kinematic state of the satellite position machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Num,
    NumVar,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.machine import ANY
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
    """Vehicle, receiver and limits of a position from satellites.

    redundancy       number of satellites that a solution needs: enough to solve, to detect a fault, to exclude one
    drift_check      where present: the position is compared with odometry while that is present; required: no position is
                     reported without odometry
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
        """Refuse limits by which no protection level is possible: it is never below the error of a usable signal."""
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
        """Refuse prediction bounds below the error that a cycle can make of the state's error (threshold rule, second half)."""
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
        """The greatest distance that an acceleration adds in a cycle, A T^2 / 2."""
        return self.max_acceleration_mm_s2 * self.period_ms * self.period_ms // 2

    @property
    def way_at_most_nm(self) -> int:
        """The farthest run of a vehicle in a cycle."""
        return self.max_speed_mm_s * 1_000 * self.period_ms + self.way_nm

    @property
    def stopping_ms(self) -> int:
        """A time in which a vehicle at its present speed, whatever that is, runs at least its stopping distance."""
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


class Parts:
    """The variables of the position machine and its world.

    usable, used  inputs per channel: the satellite is in the list of usable ones (wired from the selection); the solution
                  uses it
    fix           input: along-track place of the solution
    dilution      input: how far errors of one metre in each used signal can move it at most, the sum of |weight|
    further       input: what comes to its error beside the signals': map, bend of the track, time, rounding
    fix_speed, speed_dilution, speed_further   the same of its speed, from range rates
    unknowns      input: number of unknowns solved: 2 along the track, 4 free of it, one more for each further clock
    missing       input: the reason why there is no solution
    reference     input: a trusted place (a balise) with its accuracy; reference_speed: trusted too, where it is known
    odometry      input: run since the cycle before, by a source independent of satellites, with the error of this run
    position, low, high       state: the estimated place, and the bounds that hold the true one; speed, slowest, fastest alike
    change        state: change of the estimated speed in the last cycle
    coasted       state: cycles since a solution or a reference was used
    anchored      state: position and odometry since the last reference are comparable; anchor_offset: the position less that
                  place, anchor_margin: the error bound of odometry since then
    truth, true_speed  ghosts: nm and um/s
    bounded, compared  ghosts per channel: the signal's error keeps the bound of a usable signal; prediction and clock are as
                  good as configured
    """

    def __init__(self, config: SatelliteConfig, truth: NumVar | None, *, signals: bool) -> None:
        self.declared = declared = Declared()
        self.config, channels = config, range(1, config.selection.channels + 1)
        limit, fast = config.position_limit_mm, config.max_speed_mm_s * 1_000
        reach, widest, cycle = _reach_nm(config), 2 * fast, -(-config.way_at_most_nm // NM_PER_MM)
        self.usable = tuple(declared.sensor(boolean(f"usable_{n}")) for n in channels)
        self.used = tuple(declared.sensor(boolean(f"used_{n}")) for n in channels)
        self.fix = declared.sensor(optional("fix_mm", MM, -limit, limit))
        self.dilution = declared.sensor(number("fix_dilution_permille", PER_MILLE, 0, MAX_DILUTION_PERMILLE))
        self.further = declared.sensor(number("fix_further_mm", MM, 0, 10 * config.protection_limit_mm))
        self.fix_speed = declared.sensor(number("fix_speed_um_s", UM_S, -fast, fast))
        self.speed_dilution = declared.sensor(
            number("fix_speed_dilution_permille", PER_MILLE, 0, MAX_DILUTION_PERMILLE)
        )
        self.speed_further = declared.sensor(number("fix_speed_further_um_s", UM_S, 0, widest))
        self.unknowns = declared.sensor(number("fix_unknowns", COUNT, 2, MAX_UNKNOWNS))
        self.missing = declared.sensor(choice("fix_missing", enumeration(MISSING)))
        self.reference = declared.sensor(optional("reference_mm", MM, -limit, limit))
        self.accuracy = declared.sensor(number("reference_accuracy_mm", MM, 0, config.tolerance_mm))
        self.reference_speed = declared.sensor(optional("reference_speed_um_s", UM_S, -fast, fast))
        self.speed_accuracy = declared.sensor(number("reference_speed_accuracy_um_s", UM_S, 0, widest))
        self.odometry = declared.sensor(optional("odometry_mm", MM, -2 * cycle, 2 * cycle))
        self.odometry_error = declared.sensor(number("odometry_error_mm", MM, 0, 2 * cycle))
        self._keep(config)
        own_truth = number("truth_nm", NM, -reach, reach)
        self.truth = declared.ghost(own_truth if truth is None else truth, first=ANY)
        self.true_speed = declared.ghost(number("true_speed_um_s", UM_S, -fast, fast), first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -reach, reach))
        self.next_speed = declared.choice(number("next_speed_um_s", UM_S, -fast, fast))
        self.bounded: tuple[BoolVar, ...] = ()
        self.compared: tuple[BoolVar, ...] = ()
        if signals:
            self.bounded = tuple(declared.choice(boolean(f"signal_bounded_{n}")) for n in channels)
            self.compared = tuple(declared.choice(boolean(f"signal_compared_{n}")) for n in channels)

    def _keep(self, config: SatelliteConfig) -> None:
        """Declare the state: nothing is known."""
        declared, fast, change = self.declared, config.max_speed_mm_s * 1_000, config.speed_change_um_s
        limit, reach, farthest = config.position_limit_mm * NM_PER_MM, _reach_nm(config), config.anchor_limit_mm
        apart = (config.tolerance_mm + farthest) * NM_PER_MM
        self.position = declared.state(number("position_nm", NM, -limit, limit), first=0)
        self.low = declared.state(number("low_nm", NM, -reach, reach), first=0)
        self.high = declared.state(number("high_nm", NM, -reach, reach), first=0)
        self.speed = declared.state(number("speed_um_s", UM_S, -fast, fast), first=0)
        self.slowest = declared.state(number("slowest_um_s", UM_S, -fast, fast), first=0)
        self.fastest = declared.state(number("fastest_um_s", UM_S, -fast, fast), first=0)
        self.change = declared.state(number("change_um_s", UM_S, -change, change), first=0)
        self.coasted = declared.state(number("coasted_cycles", COUNT, 0, config.coast_limit_cycles), first=0)
        self.anchored = declared.state(boolean("anchored"), first=False)
        self.anchor_offset = declared.state(number("anchor_offset_nm", NM, -apart, apart), first=0)
        self.anchor_margin = declared.state(number("anchor_margin_nm", NM, 0, farthest * NM_PER_MM), first=0)
        self.last_verdict = declared.state(choice("fix_last_verdict", enumeration(FIX)), first=NO_FIX)
        self.why_missing = declared.state(choice("missing", enumeration(MISSING)), first=MISSING[0])
        self.reason = declared.state(choice("reason", enumeration(REASON)), first=NO_REFERENCE)


def parts(config: SatelliteConfig, *, truth: NumVar | None = None, signals: bool = True) -> Parts:
    """Declare the variables of one machine.

    truth    the true place, where another machine's world moves the vehicle
    signals  the world has ghosts of every channel's signal; without them nothing is assumed of a solution
    """
    return Parts(config, truth, signals=signals)


def _reach_nm(config: SatelliteConfig) -> int:
    return (config.position_limit_mm + 2 * config.tolerance_mm) * NM_PER_MM


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
        """Greatest distance of the true place behind the estimate."""
        return self.position - self.low

    @property
    def above(self) -> Num:
        """Greatest distance of the true place ahead of the estimate."""
        return self.high - self.position

    def meets(self, other: State) -> Bool:
        """Return whether both have a place and a speed in common."""
        place = (self.low <= other.high) & (other.low <= self.high)
        return place & (self.slowest <= other.fastest) & (other.slowest <= self.fastest)


def around(position: Num, margin: Num, speed: Num, speed_margin: Num) -> State:
    """Return a state with the same margin on either side."""
    return State(position, position - margin, position + margin, speed, speed - speed_margin, speed + speed_margin)


def held(own: Parts) -> State:
    """Return the state before the step."""
    return State(own.position, own.low, own.high, own.speed, own.slowest, own.fastest)
