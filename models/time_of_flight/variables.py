"""Inputs, state, ghosts and configuration of the localization by time of flight."""

from __future__ import annotations

from fractions import Fraction

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import boolean, number, optional
from safeloc.language.machine import ANY
from safeloc.language.units import MM, NM, NM_PER_MM, PPM_PER_ONE, UM, UM_PER_MM, Unit

_PS = Unit("ps", time=1, scale=Fraction(1, 10**12))
LIGHT_M_S = 299_792_458
"""Speed of light in vacuum, m/s: exact by the definition of the metre."""
_PS_PER_S = 10**12
_PS_PER_S_TO_MM = _PS_PER_S // 1_000


class TimeOfFlightConfig(Config):
    """The fibre, the pulses, and the errors of time, index and cable map."""

    fibre_mm: int = quantity(40_000_000, "mm", 100_000, 200_000_000, "[S] Frauscher: 40 km a side; cable, not track")
    pulse_hz: int = quantity(1_000, "Hz", 100, 100_000, "[M] 1 kHz; [S] Frauscher 2500 Hz")
    index_ppm: int = quantity(1_468_000, "ppm", 1_000_001, 3_000_000, "[D] V = 204 218 296 m/s")
    index_error_ppm: int = quantity(100, "ppm of the index", 0, 10_000, "[M] calibrated, temperature: 4 m at 40 km")
    trigger_error_ps: int = quantity(20_000, "ps", 0, 10_000_000, "[M] pulse instants are known about: 2 m")
    resolution_ps: int = quantity(97_931, "ps", 1, 10_000_000, "[D] one channel of 10 m, there and back")
    pattern_error_mm: int = quantity(
        40_000, "mm", 0, 1_000_000, "[D] measured: the outermost axle's place, and overhang"
    )
    slack_ppm: int = quantity(30_000, "ppm", 0, 500_000, "[M] a cable is 1 to 3 % longer than its track")
    map_error_mm: int = quantity(5_000, "mm", 0, 1_000_000, "[M] survey, and loops of cable in shafts")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 1_000_000_000, "[D] 1 000 km of line")

    @model_validator(mode="after")
    def _one_pulse_at_a_time(self) -> TimeOfFlightConfig:
        way_ps = 2 * self.fibre_mm * _PS_PER_S_TO_MM // self.slowest_m_s + self.time_error_ps
        if way_ps > self.period_ps:
            raise ValueError(
                f"light needs up to {way_ps} ps through {self.fibre_mm} mm of fibre and back, but a pulse follows after "
                f"{self.period_ps} ps: a pattern could belong to either; send fewer (pulse_hz), or watch less fibre."
            )
        return self

    @property
    def period_ps(self) -> int:
        """The time from pulse to pulse, ps: no delay is longer."""
        return _PS_PER_S // self.pulse_hz

    @property
    def time_error_ps(self) -> int:
        """Greatest error of a measured delay, ps: of the instant of the pulse, and of the reading."""
        return self.trigger_error_ps + self.resolution_ps

    @property
    def least_index_ppm(self) -> int:
        """The least index of refraction, ppm, rounded down."""
        return self.index_ppm * (PPM_PER_ONE - self.index_error_ppm) // PPM_PER_ONE

    @property
    def greatest_index_ppm(self) -> int:
        """The greatest index of refraction, ppm, rounded up."""
        return -(-self.index_ppm * (PPM_PER_ONE + self.index_error_ppm) // PPM_PER_ONE)

    @property
    def slowest_m_s(self) -> int:
        """The least speed V = c0 / n of a pulse in the fibre, m/s, rounded down."""
        return LIGHT_M_S * PPM_PER_ONE // self.greatest_index_ppm

    @property
    def fastest_m_s(self) -> int:
        """The greatest speed V = c0 / n of a pulse in the fibre, m/s, rounded up."""
        return -(-LIGHT_M_S * PPM_PER_ONE // self.least_index_ppm)

    @property
    def farthest_mm(self) -> int:
        """Greatest distance that any delay can tell, mm."""
        delay_ps = self.period_ps + self.time_error_ps
        return delay_ps * self.fastest_m_s // (2 * _PS_PER_S_TO_MM) + 1 + self.pattern_error_mm


class Parts:
    """The variables of the machine.

    delay        time T between a pulse and the backscatter pattern of the vehicle's end, as measured in this cycle
    map_known, map_distance, map_position, map_upwards   the cable map's surveyed point near the end: its distance along the fibre, its
                 place along the track, and whether places along the track grow along the fibre there
    time_reported    the delay as reported: that of this cycle
    low, high    bounds of the distance Ls along the fibre from the sensing end to the vehicle's end
    track_low, track_high    bounds of the end's place along the track
    truth        ghost: true place of the end along the track, nm; next_truth: freely chosen, after the cycle
    true_distance, next_true_distance    ghost and choice: its true distance along the fibre, um
    origin       choice: distance along the fibre of the place from which the pattern came that was timed, um
    """

    def __init__(self, config: TimeOfFlightConfig) -> None:
        self.declared = declared = Declared()
        self.config = config
        limit, far = config.position_limit_mm, config.farthest_mm
        wide = limit + far + config.fibre_mm + config.map_error_mm
        self.delay = declared.sensor(optional("delay_ps", _PS, 0, config.period_ps))
        self.map_known = declared.sensor(boolean("map_known"))
        self.map_distance = declared.sensor(number("map_distance_mm", MM, 0, config.fibre_mm))
        self.map_position = declared.sensor(number("map_position_mm", MM, -limit, limit))
        self.map_upwards = declared.sensor(boolean("map_upwards"))
        self.time_reported = declared.state(number("time_reported_ps", _PS, 0, config.period_ps), first=0)
        self.low = declared.state(number("low_mm", MM, 0, far), first=0)
        self.high = declared.state(number("high_mm", MM, 0, far), first=0)
        self.track_low = declared.state(number("track_low_mm", MM, -wide, wide), first=0)
        self.track_high = declared.state(number("track_high_mm", MM, -wide, wide), first=0)
        line_nm, fibre_um = 2 * limit * NM_PER_MM, config.fibre_mm * UM_PER_MM
        self.truth = declared.ghost(number("truth_nm", NM, -line_nm, line_nm), first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -line_nm, line_nm))
        self.true_distance = declared.ghost(number("true_distance_um", UM, 0, fibre_um), first=ANY)
        self.next_true_distance = declared.choice(number("next_true_distance_um", UM, 0, fibre_um))
        self.origin = declared.choice(number("pattern_origin_um", UM, 0, 2 * far * UM_PER_MM))


def parts(config: TimeOfFlightConfig) -> Parts:
    """Return fresh variables for one end of a train."""
    return Parts(config)
