"""Configuration of the radar, of detection, and of the reflectors along the line.

Intensity is power relative to the receiver's own mean noise in one cell of the image, in hundredths of dB (cdB):
0 is noise, 2000 is a hundred times the noise.
"""

from __future__ import annotations

import math
from fractions import Fraction

from pydantic import model_validator

from safeloc.config import Config, quantity

LIGHT_MM_S = 299_792_458_000
MILLION = 1_000_000
_SEPARATE_CELLS = 4


class Sensor(Config):
    """A radar that sends linear chirps (FMCW) and receives them with a row of antennas half a wavelength apart (RFL-2)."""

    carrier_mhz: int = quantity(77_000, "MHz", 20_000, 130_000, "[M, fairly sure] 24 or 77 GHz")
    bandwidth_mhz: int = quantity(1_000, "MHz", 50, 5_000, "[M, fairly sure] 250 MHz to 1 GHz: cells of 0.60 to 0.15 m")
    chirp_us: int = quantity(100, "us", 10, 10_000, "[M] tens to hundreds of us")
    samples: int = quantity(1_024, "samples a chirp", 64, 8_192, "[D] one range cell each: 153 m with 1 GHz")
    antennas: int = quantity(32, "antennas", 8, 256, "[M] virtual array of a long-range sensor")
    frame_period_ms: int = quantity(50, "ms", 20, 100, "[M, fairly sure] 10 to 50 Hz")
    air_ppm: int = quantity(290, "ppm", 0, 500, "[M, sure] light is slower in air by 270 to 310 ppm")
    scale_error_ppm: int = quantity(100, "ppm", 0, 10_000, "[M] sweep clock 50, weather 50")
    offset_error_mm: int = quantity(5, "mm", 0, 1_000, "[M] cables and antennas after calibration")
    angle_error_urad: int = quantity(3_000, "urad", 0, 100_000, "[M] mounting and antenna phases after calibration")
    ground_reflection_percent: int = quantity(5, "% of amplitude", 0, 30, "[M] ballast is rough at millimetre waves")
    ground_height_mm2: int = quantity(
        1_000_000, "mm2", 0, 25_000_000, "[M] antenna height x highest reflector height above the ground"
    )
    blind_mm: int = quantity(3_000, "mm", 0, 50_000, "[M] nearer, the sensor receives its own transmitter")
    full_scale_cdb: int = quantity(10_500, "cdB", 1_000, 20_000, "[D] one echo that just reaches the converter's end")
    overload_cdb: int = quantity(9_500, "cdB", 1_000, 20_000, "[D] 10 dB less: several together may reach it")
    floor_low_cdb: int = quantity(-600, "cdB", -10_000, 0, "[M] less noise than the receiver's own: it is dead")
    floor_high_cdb: int = quantity(1_500, "cdB", 0, 10_000, "[M] more noise: jammed")

    @model_validator(mode="after")
    def _hears_overload(self) -> Sensor:
        if self.overload_cdb > self.full_scale_cdb - 1_000:
            raise ValueError(
                "overload_cdb has to be at least 1000 below full_scale_cdb: three equal echoes may add up."
            )
        return self

    @property
    def cell_mm(self) -> Fraction:
        """The length of a range cell in air, c / 2B."""
        return Fraction(LIGHT_MM_S, 2 * self.bandwidth_mhz * MILLION) * MILLION / (MILLION + self.air_ppm)

    @property
    def sine_cell(self) -> Fraction:
        """The width of an angle cell, in sines of the angle."""
        return Fraction(2, self.antennas)

    @property
    def side_cells(self) -> int:
        """The number of angle cells on either side of straight ahead, up to 30 degrees."""
        return self.antennas // 4

    @property
    def shape(self) -> tuple[int, int]:
        """The range and angle cells of an image; the first range cell is at 0, angles go from right to left."""
        return self.samples, 2 * self.side_cells + 1

    @property
    def lead_us(self) -> Fraction:
        """The lead of a chirp, carrier x duration / bandwidth: it measures the range this much after its middle.

        An approaching reflector shifts the beat frequency by its Doppler frequency; in an upward chirp this appears as
        a range shorter by speed x carrier x duration / bandwidth.
        """
        return Fraction(self.carrier_mhz * self.chirp_us, self.bandwidth_mhz)


class Detection(Config):
    """Thresholds for a cell of the image above noise and clutter."""

    window_cells: int = quantity(
        33, "range cells", 9, 513, "[D] on either side: 5 m, of which corners take less than half"
    )
    threshold_cdb: int = quantity(1_300, "cdB", 500, 5_000, "[D] e^-20 a cell: a false peak in 30,000 frames of noise")
    noise_bound_cdb: int = quantity(1_150, "cdB", 0, 3_000, "[D] noise power exceeds its mean 14 times with e^-14")
    most_peaks: int = quantity(200, "peaks", 10, 2_000, "[D] more is no picture of a track")

    @model_validator(mode="after")
    def _odd(self) -> Detection:
        if self.window_cells % 2 == 0:
            raise ValueError(f"window_cells has to be odd, so that it has a middle; got {self.window_cells}.")
        return self


class Reflectors(Config):
    """The reflectors along the line (RFL-10): three corners of sheet metal each, in one row along the track."""

    edge_mm: int = quantity(150, "mm", 20, 1_000, "[M] trihedral corner: 140 m2 at 77 GHz")
    unit_mm: int = quantity(600, "mm", 50, 10_000, "[D] marks of a model are whole multiples; four cells of 0.15 m")
    mark_tolerance_mm: int = quantity(100, "mm", 1, 2_500, "[D] two corners at the far end of the view, bounds added")
    balance_cdb: int = quantity(
        900, "cdB", 100, 3_000, "[M] corners of one reflector, with ground and dirt between them"
    )
    purity_cdb: int = quantity(
        700, "cdB", 0, 3_000, "[D] a foreign echo this far below the weakest corner is tolerated"
    )
    stronger_cdb: int = quantity(600, "cdB", 0, 3_000, "[M] above the range law: ground adds")
    weaker_cdb: int = quantity(1_200, "cdB", 0, 5_000, "[M] below the range law: dirt, rain, ground subtracts")
    equal_spacing_mm: int = quantity(
        20_000, "mm", 0, 10_000_000, "[D] line audit: reflectors of one model in one view are farther apart"
    )
    minimum_cdb: int = quantity(2_000, "cdB", 0, 10_000, "RFL-1: the prescribed minimum intensity")

    def section_cdbsm(self, carrier_mhz: int) -> int:
        """Return the radar cross-section of one corner in hundredths of dB over 1 m2: 4 pi a^4 / 3 lambda^2."""
        wave_mm = LIGHT_MM_S / (carrier_mhz * MILLION)
        return round(1_000 * math.log10(4 * math.pi * self.edge_mm**4 / (3 * wave_mm**2) / MILLION))


class Installation(Config):
    """Geometry of reflectors, track and antenna: converts measured range into distance along the track (RFL-3)."""

    offset_mm: int = quantity(3_000, "mm", 0, 20_000, "[M] beside the ballast, from the antenna's path (001 l. 117)")
    offset_error_mm: int = quantity(100, "mm", 0, 5_000, "[M] survey, track position and sway of the vehicle")
    height_difference_mm: int = quantity(500, "mm", 0, 5_000, "[M] at most, between antenna and reflector")
    least_radius_mm: int = quantity(
        190_000, "mm", 150_000, 10_000_000_000, "[M, sure] turnout 1:9; sharpest curve in view of a reflector"
    )


class RadarConfig(Config):
    """The configuration of the front end. ValueError if signatures cannot be resolved or the view reaches around a curve."""

    sensor: Sensor = Sensor()
    detection: Detection = Detection()
    reflectors: Reflectors = Reflectors()
    installation: Installation = Installation()
    reference_cdb: int = quantity(2_000, "cdB", -5_000, 10_000, "[M] a section of 1 m2 at 100 m, before rain")

    @model_validator(mode="after")
    def _resolves(self) -> RadarConfig:
        unit, cell = self.reflectors.unit_mm, self.sensor.cell_mm
        if unit < _SEPARATE_CELLS * cell * Fraction(99, 100):
            raise ValueError(
                f"corners {unit} mm apart cannot be resolved with cells of {float(cell):.0f} mm: "
                f"take more bandwidth or a unit of {math.ceil(_SEPARATE_CELLS * cell)} mm."
            )
        if self.reflectors.mark_tolerance_mm * 3 > unit:
            raise ValueError(f"a tolerance of marks above a third of the unit ({unit} mm) makes models overlap.")
        reach = self.sensor.samples * cell
        if self.installation.least_radius_mm < reach * Fraction(6, 5):
            raise ValueError(
                f"a view of {math.ceil(reach)} mm reaches around a curve of {self.installation.least_radius_mm} mm: "
                "take fewer samples, or configure the true least radius in view zones."
            )
        return self
