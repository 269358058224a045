"""Sources for the errors of a range sensor: each kind of sensor has its own for the laws on its ranges."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Ranging:
    """Sources of the four laws on ranges.

    noise  the error of a single echo, and the age of its frame
    drift  the systematic error of all ranges
    scale  the error in proportion to the range
    reach  the greatest range of an echo with the minimum intensity
    """

    noise: str
    drift: str
    scale: str
    reach: str


RADAR = Ranging(
    noise="[M] noise of an FMCW radar, interpolated to centimetres; steady speed in a cycle [D]",
    drift="[M] delays of filters and cables: 2 mm/K, at most 30 K a minute",
    scale="[M] clock of the chirp: 20 to 50 ppm, and ageing",
    reach="[M] fourth power of the range; the antenna's pattern",
)
ULTRASOUND = Ranging(
    noise="[M] time of arrival of a 40 kHz pulse within a few periods of 8 mm; a frame lasts as long as sound takes to the farthest "
    "reflector and back; steady speed in a cycle [D]",
    drift="[M] threshold and ring-down of the transducer: 10 mm from cold to warm, in minutes",
    scale="[D] speed of sound: air temperature within the thermometer's error, wind along the path, humidity",
    reach="[M] absorption 1.3 dB/m at 40 kHz, and the fourth power of the range",
)
LIGHT = Ranging(
    noise="[M] phase of modulated light, integrated over a frame; ambient light; steady speed in a cycle [D]",
    drift="[M] delay of the diode against the detector: 10 mm/K, at most 30 K a minute",
    scale="[M] oscillator of the modulation 100 ppm, refractive index of air 300 ppm",
    reach="[M] eye safety limits the power; beyond the unambiguous range of the modulation an echo has to be too weak",
)
LASER = Ranging(
    noise="[M] flank of a pulse of 1 to 5 ns: centimetres, with the walk of its amplitude; steady speed in a cycle [D]",
    drift="[M] delay of diode and comparator: 1 mm/K, at most 30 K a minute",
    scale="[M] counter's quartz 50 ppm; refractive index of air corrected to 50 ppm",
    reach="[M] retroreflecting foil; rain and fog shorten it",
)
