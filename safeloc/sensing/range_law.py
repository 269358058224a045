"""The range law: power falls with the fourth power of range, 12 dB for each doubling; the rest is the radar cross-section.

An echo much stronger or weaker than a reflector's corner can be at its range is not that corner. This excludes the fronts of
vehicles, and most echoes that took a detour.
"""

from __future__ import annotations

import math

from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import in_cdb

REFERENCE_MM = 100_000


def loss_cdb(range_mm: float) -> int:
    """Return the loss of an echo at this range > 0 compared with 100 m, in hundredths of dB; negative if nearer."""
    return round(4_000 * math.log10(range_mm / REFERENCE_MM))


def section_cdbsm(power: float, range_mm: float, config: RadarConfig) -> int:
    """Return the radar cross-section for this power at this range without rain, in hundredths of dB over 1 m2."""
    return in_cdb(power) - config.reference_cdb + loss_cdb(range_mm)


def is_lawful(section: int, config: RadarConfig) -> bool:
    """Return whether a corner can have this radar cross-section, also if wet, dirty or amplified by the ground."""
    reflectors = config.reflectors
    nominal = reflectors.section_cdbsm(config.sensor.carrier_mhz)
    return nominal - reflectors.weaker_cdb <= section <= nominal + reflectors.stronger_cdb
