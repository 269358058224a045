"""Configuration and variables of satellite selection, with the ghosts of its world."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pydantic import Field, model_validator

from safeloc.config import Config, derived, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    BoolVar,
    NumVar,
    Optional,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.language.units import COUNT, MM, MM_S, PER_MILLE, S, Unit

STANDING = members("standing", "ABSENT", "UNLISTED", "EXPIRED", "SILENT", "WARMING", "EXCLUDED", "USABLE")
ABSENT, UNLISTED, EXPIRED, SILENT, WARMING, EXCLUDED, USABLE = STANDING
Compared = Literal["doppler", "pseudorange", "both"]
Removal = Literal["either", "both"]
AlmanacUse = Literal["while current", "required"]
_UPRIGHT_MRAD, OLDEST_S = 1_571, 10**9
"""The zenith, rounded outward; the greatest age of an almanac that is an input, some 30 years."""
SQUARE_MM, SQUARE_MM_S = MM.times(MM), MM_S.times(MM_S)


class SelectionConfig(Config):
    """The criterion, with its thresholds.

    compared  which quantities are compared; a satellite that violates one of them is removed ([0068])
    removal   either: unless difference AND covariance are below their thresholds, strictly ([0066], [0067]; default)
              both: only where difference AND covariance are above them ([0049], [0050])
    almanac   while current: only satellites that the almanac lists as possibly visible are usable; without a current almanac
              all that are received are ([0036]; default)
              required: without a current almanac none is usable
    """

    channels: int = quantity(8, "count", 1, 32, "[D] satellites in view at a time, several constellations up to 32")
    compared: Compared = Field(default="both", description="Doppler, pseudorange, or both")
    removal: Removal = Field(default="either", description="what removes a satellite")
    range_threshold_mm: int = quantity(9_500, "mm", 1, 10_000_000, "[D] above noise, prediction and clock error")
    speed_threshold_mm_s: int = quantity(1_150, "mm/s", 1, 1_000_000, "[D] above noise, prediction and clock error")
    range_covariance_mm2: int = quantity(16_000_000, "mm2", 1, 10**14, "[D] (4 m)2; recorded 1.6 m RMS")
    speed_covariance_mm2_s2: int = quantity(250_000, "mm2/s2", 1, 10**12, "[D] (0.5 m/s)2; line of sight 0.19 m/s")
    range_noise_mm: int = quantity(4_000, "mm", 0, 10_000_000, "[D] 2.5 x 1.6 m RMS, geodetic receiver, healthy signal")
    speed_noise_mm_s: int = quantity(
        300, "mm/s", 0, 1_000_000, "[D] geodetic receiver, healthy signal: 0.012 m/s RMS recorded at rest, more driving"
    )
    range_prediction_mm: int = quantity(3_100, "mm", 0, 10_000_000, "[D] A T^2 at 0.2 s, and the state's own error")
    speed_prediction_mm_s: int = quantity(700, "mm/s", 0, 1_000_000, "[D] 2 A T at 0.2 s, and the state's own error")
    range_clock_mm: int = quantity(2_100, "mm", 0, 10_000_000, "[D] 3 x 1.25 x 1.6 m / sqrt(8): a median's error")
    speed_clock_mm_s: int = quantity(
        100, "mm/s", 0, 1_000_000, "[D] a third of the noise: the error of a median of eight"
    )
    warm_up_cycles: int = quantity(2, "cycles", 1, 1_000, "[S] [0071]: variability needs two samples at least")
    last_identity: int = quantity(1_000, "count", 1, 1_000_000, "[D] satellites of all constellations")
    almanac: AlmanacUse = Field(default="while current", description="what follows from an almanac that is too old")
    almanac_limit_s: int = quantity(
        518_400,
        "s",
        1,
        15_552_000,
        "[S] six days, the fit interval of a broadcast almanac; its time of applicability counts",
    )
    almanac_mask_mrad: int = quantity(87, "mrad", 1, 1_500, "[D] 5 degrees, below the 10 of the mask by the ephemeris")
    almanac_accuracy_mrad: int = quantity(
        10, "mrad", 0, 1_000, "[D] a satellite 2 km off [S] is 0.1 mrad off; the rest is for a vehicle 60 km off"
    )

    @model_validator(mode="after")
    def _keeps_healthy_ones(self) -> SelectionConfig:
        """Refuse a threshold that does not exceed noise, prediction and clock error: it would exclude healthy satellites while the train brakes."""
        rows = (
            ("range_threshold_mm", self.range_threshold_mm, self.range_off_at_most_mm),
            ("speed_threshold_mm_s", self.speed_threshold_mm_s, self.speed_off_at_most_mm_s),
        )
        for name, value, least in rows:
            if value <= least:
                raise ValueError(
                    f"{name} {value} is not above noise, prediction and clock error together, {least}: healthy satellites "
                    "would be excluded while the train brakes; raise it."
                )
        return self

    @model_validator(mode="after")
    def _lists_what_is_above_the_horizon(self) -> SelectionConfig:
        """Refuse an almanac so coarse that a satellite below the horizon could be listed."""
        if self.almanac_mask_mrad <= self.almanac_accuracy_mrad:
            raise ValueError(
                f"almanac_mask_mrad {self.almanac_mask_mrad} is not above almanac_accuracy_mrad {self.almanac_accuracy_mrad}: "
                "a satellite below the horizon could be listed as possibly visible; raise the mask."
            )
        return self

    @derived("mm", "[D] threshold, prediction and clock error: what a usable pseudorange may be wrong by")
    def usable_range_error_mm(self) -> int:
        """Error bound of a usable satellite's pseudorange: the threshold, and the errors of prediction and clock.

        The criterion compares the signal's error with those of prediction and clock in it. Only the strict one
        (removal "either") bounds it.
        """
        return self.range_threshold_mm + self.range_prediction_mm + self.range_clock_mm

    @derived("mm/s", "[D] threshold, prediction and clock error: what a usable range rate may be wrong by")
    def usable_speed_error_mm_s(self) -> int:
        """Greatest error of a usable signal's range rate, mm/s."""
        return self.speed_threshold_mm_s + self.speed_prediction_mm_s + self.speed_clock_mm_s

    @property
    def range_off_at_most_mm(self) -> int:
        """The greatest difference of a healthy pseudorange."""
        return self.range_noise_mm + self.range_prediction_mm + self.range_clock_mm

    @property
    def speed_off_at_most_mm_s(self) -> int:
        """The greatest difference of a healthy range rate."""
        return self.speed_noise_mm_s + self.speed_prediction_mm_s + self.speed_clock_mm_s


@dataclass(frozen=True, eq=False)
class Channel:
    """One receiver channel. Differences are measured less predicted, mm and mm/s; covariances over the window.

    error, speed_error            ghosts: the signal's own error
    prediction, prediction_mm_s          ghosts: what the prediction's error makes of it along the line of sight
    almanac      elevation by the almanac, mrad; absent: the almanac does not have the satellite, or has it as unhealthy
    true_elevation ghost
    """

    number: int
    satellite: Optional
    ephemeris_valid: BoolVar
    off: Optional
    speed_off: Optional
    covariance: Optional
    speed_covariance: Optional
    standing: NumVar
    held: NumVar
    warm: NumVar
    error: NumVar
    speed_error: NumVar
    prediction: NumVar
    prediction_mm_s: NumVar
    almanac: Optional
    elevation: NumVar


class Parts:
    """The variables of the machine.

    current             state: in the last cycle there was an almanac that is not too old
    almanac_age         time between the cycle and the almanac's time of applicability; absent: there is no almanac
    clock, clock_mm_s  ghosts: what the receiver's clock was estimated wrong by
    """

    def __init__(self, config: SelectionConfig) -> None:
        self.declared = declared = Declared()
        self.config = config
        self.current = declared.state(boolean("almanac_was_current"), first=False)
        self.usable_satellites = declared.state(number("usable_satellites", COUNT, 0, config.channels), first=0)
        self.almanac_age = declared.sensor(optional("almanac_age_s", S, 0, OLDEST_S))
        self.channels = tuple(_channel(declared, n, config) for n in range(1, config.channels + 1))
        self.clock = declared.choice(number("clock_mm", MM, -(10**9), 10**9))
        self.clock_mm_s = declared.choice(number("clock_mm_s", MM_S, -(10**8), 10**8))


def parts(config: SelectionConfig) -> Parts:
    """Return fresh variables for one machine."""
    return Parts(config)


def _channel(declared: Declared, number_: int, config: SelectionConfig) -> Channel:
    name, far, fast = f"channel_{number_}", 10**9, 10**8

    def covariance(kind: str, unit: Unit) -> Optional:
        return declared.sensor(optional(f"{name}_{kind}", unit, 0, 10**15))

    return Channel(
        number_,
        declared.sensor(optional(f"{name}_satellite", COUNT, 1, config.last_identity)),
        declared.sensor(boolean(f"{name}_ephemeris_valid")),
        declared.sensor(optional(f"{name}_range_off_mm", MM, -far, far)),
        declared.sensor(optional(f"{name}_speed_off_mm_s", MM_S, -fast, fast)),
        covariance("range_covariance_mm2", SQUARE_MM),
        covariance("speed_covariance_mm2_s2", SQUARE_MM_S),
        declared.state(choice(f"{name}_standing", enumeration(STANDING)), first=ABSENT),
        declared.state(number(f"{name}_held", COUNT, 0, config.last_identity), first=0),
        declared.state(number(f"{name}_warm_cycles", COUNT, 0, config.warm_up_cycles), first=0),
        declared.choice(number(f"{name}_error_mm", MM, -3 * far, 3 * far)),
        declared.choice(number(f"{name}_speed_error_mm_s", MM_S, -3 * fast, 3 * fast)),
        declared.choice(number(f"{name}_prediction_mm", MM, -2 * far, 2 * far)),
        declared.choice(number(f"{name}_prediction_mm_s", MM_S, -2 * fast, 2 * fast)),
        declared.sensor(optional(f"{name}_almanac_mrad", PER_MILLE, -_UPRIGHT_MRAD, _UPRIGHT_MRAD)),
        declared.choice(number(f"{name}_elevation_mrad", PER_MILLE, -_UPRIGHT_MRAD, _UPRIGHT_MRAD)),
    )
