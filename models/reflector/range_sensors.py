"""Sensors that stand in for the radar: ultrasound, light and laser, each with figures and sources of its own (RFL-2).

All measure a range by time of flight to a reflector, so the machine is the same, and so are its laws: a systematic error that
drifts, one in proportion to the range, an error of each echo, a frame that is no older than its latency. What differs is
how large they are and why. The names of figures keep the word radar, which stands for the sensor.

The vehicle runs on while a signal is on its way. The time of flight to a reflector and back gives the range at a moment
between sending and receiving, so the latency of a frame has to include the whole time of flight. With light this is no
matter; with sound it decides how far the sensor may look within a cycle.
"""

from __future__ import annotations

from math import isqrt
from typing import ClassVar

from pydantic import model_validator

from safeloc.config import derived, quantity
from safeloc.language.units import PPM_PER_ONE
from safeloc.models.reflector.ranging import LASER, LIGHT, ULTRASOUND, Ranging
from safeloc.models.reflector.variables import ReflectorConfig

_SOUND_AT_0_C_MM_S = 331_300
"""[M, sure] speed of sound in dry air at 0 degrees C; it grows with the root of the absolute temperature."""
_ZERO_C_CK = 27_315
"""0 degrees C in hundredths of a kelvin."""
LIGHT_MM_S = 299_792_458_000
"""[S] the metre's definition."""


class UltrasoundConfig(ReflectorConfig):
    """Ultrasound: its range is in proportion to the speed of sound, which air temperature and wind change."""

    ranging: ClassVar[Ranging] = ULTRASOUND
    range_limit_mm: int = quantity(12_000, "mm", 1_000, 30_000, "[D] the sound is back within a cycle")
    near_range_mm: int = quantity(500, "mm", 1, 100_000, "[M] nearer, the transducer still rings")
    strong_range_mm: int = quantity(12_000, "mm", 1_000, 30_000, "[M] 40 kHz: minimum intensity up to 10 to 15 m")
    minimum_intensity_cdb: int = quantity(-6_000, "0.01 dB", -20_000, 5_000, "[D] 20 dB over noise, full scale 80")
    frame_latency_ms: int = quantity(97, "ms", 0, 1_000, "[D] time of flight to 12 m and back, and processing")
    radar_drift_mm_s: int = quantity(1, "mm/s", 0, 100_000, "[M] threshold and ring-down: 10 mm in minutes")
    radar_scale_ppm: int = quantity(22_000, "ppm of range", 0, 500_000, "[D] air temperature, wind, humidity, clock")
    reference_tolerance_mm: int = quantity(
        6_000,
        "mm",
        0,
        100_000,
        "[D] both ways: balise 1.3 m, latency 1 m at 10 m/s, scale 0.3 m, survey and echo 0.2 m",
    )
    coldest_air_c: int = quantity(-25, "degrees C", -50, 40, "[M] EN 50125-1, class T1: -25 to 40 degrees C")
    thermometer_error_k: int = quantity(
        3, "K", 0, 40, "[M] thermometer in the sun or behind a tunnel's mouth, mean of path"
    )
    wind_mm_s: int = quantity(30_000, "mm/s", 0, 100_000, "[M] wind and the vehicle's own air stream along the path")
    humidity_ppm: int = quantity(6_000, "ppm of speed", 0, 100_000, "[M] dry to saturated air at 40 degrees C")
    clock_ppm: int = quantity(100, "ppm of time", 0, 10_000, "[M] quartz, and ageing")
    processing_ms: int = quantity(20, "ms", 0, 1_000, "[M] filter and detection")

    @derived("mm/s", "speed of sound at 0 degrees C, with the root of the absolute temperature; rounded down")
    def slowest_sound_mm_s(self) -> int:
        """Speed of sound in the coldest air."""
        return self._sound_mm_s

    @derived("ms", "way to the range limit and back at the slowest speed of sound; rounded up")
    def time_of_flight_ms(self) -> int:
        """Longest time of flight."""
        return -(-2 * self.range_limit_mm * 1_000 // self._sound_mm_s)

    @derived(
        "ppm of range",
        "temperature error over twice the absolute temperature, square of wind over sound, humidity, clock",
    )
    def air_ppm(self) -> int:
        """Greatest error of a range that air and clock make, of the measured range.

        There and back, wind lengthens the time by the square of its speed over that of sound. Errors multiply.
        """
        kelvin = -(
            -self.thermometer_error_k * 100 * PPM_PER_ONE // (2 * (self._coldest_ck - 100 * self.thermometer_error_k))
        )
        wind = -(-(self.wind_mm_s**2) * PPM_PER_ONE // self._sound_mm_s**2)
        whole, unit = 1, 1
        for part in (kelvin, wind, self.humidity_ppm, self.clock_ppm):
            whole, unit = whole * (PPM_PER_ONE + part), unit * PPM_PER_ONE
        return -(-(whole - unit) * PPM_PER_ONE // unit)

    @property
    def _sound_mm_s(self) -> int:
        return isqrt(_SOUND_AT_0_C_MM_S**2 * self._coldest_ck // _ZERO_C_CK)

    @property
    def _coldest_ck(self) -> int:
        """The coldest air, hundredths of a kelvin above absolute zero."""
        return _ZERO_C_CK + 100 * self.coldest_air_c

    @model_validator(mode="after")
    def _has_the_errors_of_sound(self) -> UltrasoundConfig:
        if self.radar_scale_ppm < self.air_ppm:
            raise ValueError(
                f"radar_scale_ppm {self.radar_scale_ppm} is below the {self.air_ppm} ppm that air and clock make of a range; "
                "raise it, or measure the air better."
            )
        least = self.time_of_flight_ms + self.processing_ms
        if self.frame_latency_ms < least:
            raise ValueError(
                f"frame_latency_ms {self.frame_latency_ms} is below {least}: so long does sound take to range_limit_mm "
                f"{self.range_limit_mm} and back, with processing; raise it, or lower range_limit_mm."
            )
        return self


class LightConfig(ReflectorConfig):
    """Light that is modulated: the phase gives the range, as long as it is unambiguous."""

    ranging: ClassVar[Ranging] = LIGHT
    range_limit_mm: int = quantity(59_000, "mm", 1_000, 2_000_000, "[D] below the unambiguous range")
    near_range_mm: int = quantity(500, "mm", 1, 100_000, "[M] nearer, the detector is blinded")
    strong_range_mm: int = quantity(55_000, "mm", 1_000, 2_000_000, "[M] eye-safe diodes and foil: 30 to 55 m")
    minimum_intensity_cdb: int = quantity(-5_000, "0.01 dB", -20_000, 5_000, "[D] 20 dB over noise, full scale 70")
    frame_latency_ms: int = quantity(50, "ms", 0, 1_000, "[M] one integrated frame at 20 Hz")
    radar_drift_mm_s: int = quantity(5, "mm/s", 0, 100_000, "[M] delay of the diode: 10 mm/K, 30 K a minute")
    radar_scale_ppm: int = quantity(400, "ppm of range", 0, 500_000, "[M] oscillator 100 ppm, refractive index 300 ppm")
    modulation_khz: int = quantity(2_500, "kHz", 1, 1_000_000, "[D] unambiguous up to 60 m")

    @derived("mm", "half of the way of light in a period of the modulation; rounded down")
    def unambiguous_mm(self) -> int:
        """Unambiguous range."""
        return LIGHT_MM_S // (2 * self.modulation_khz * 1_000)

    @model_validator(mode="after")
    def _is_unambiguous(self) -> LightConfig:
        if max(self.range_limit_mm, self.strong_range_mm) > self.unambiguous_mm:
            raise ValueError(
                f"range_limit_mm {self.range_limit_mm} and strong_range_mm {self.strong_range_mm} must not exceed the unambiguous "
                f"range of {self.modulation_khz} kHz, {self.unambiguous_mm} mm: farther reflectors would seem near; lower "
                "them, or modulation_khz."
            )
        return self


class LaserConfig(ReflectorConfig):
    """Laser pulses: far and fine, as long as rain and fog permit."""

    ranging: ClassVar[Ranging] = LASER
    range_limit_mm: int = quantity(250_000, "mm", 1_000, 2_000_000, "[M] pulsed laser, retroreflecting foil")
    near_range_mm: int = quantity(2_000, "mm", 1, 100_000, "[M] nearer, the receiver is blinded by its own pulse")
    strong_range_mm: int = quantity(200_000, "mm", 1_000, 2_000_000, "[M] minimum intensity up to 200 m in clear air")
    minimum_intensity_cdb: int = quantity(-6_500, "0.01 dB", -20_000, 5_000, "[D] 15 dB over noise, full scale 80")
    frame_latency_ms: int = quantity(40, "ms", 0, 1_000, "[M] one turn of the mirror at 25 Hz")
    radar_drift_mm_s: int = quantity(1, "mm/s", 0, 100_000, "[M] delay of diode and comparator: 1 mm/K, 30 K a minute")
    radar_scale_ppm: int = quantity(100, "ppm of range", 0, 500_000, "[M] quartz 50 ppm, refractive index 50 ppm")
