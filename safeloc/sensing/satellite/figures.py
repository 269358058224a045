"""Constants of the GPS interface (IS-GPS-200, 20.3.3 and 3.3) and of the WGS 84 ellipsoid."""

from __future__ import annotations

LIGHT_M_PER_S = 299_792_458.0
EARTH_RATE_RAD_PER_S = 7.2921151467e-5
EARTH_GRAVITY_M3_PER_S2 = 3.986005e14
GALILEO_GRAVITY_M3_PER_S2 = 3.986004418e14
"""Galileo OS SIS ICD, table 57; the rest of its orbit model is that of GPS."""
L1_HZ = 1_575_420_000.0
L1_WAVELENGTH_M = LIGHT_M_PER_S / L1_HZ
WEEK_S = 604_800
EARTH_RADIUS_M = 6_378_137.0
EARTH_FLATTENING = 1 / 298.257223563
