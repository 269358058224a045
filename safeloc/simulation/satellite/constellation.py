"""Simulates constellations of satellites, as broadcast ephemerides with orbits and clocks.

These are Walker constellations: planes evenly spaced around the equator, satellites evenly spaced in a plane. All follow the
orbit model of GPS; names begin with the letter of the constellation, as in RINEX.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.sensing.satellite.atmosphere import Klobuchar
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.navigation import Navigation
from safeloc.sensing.satellite.times import gps_seconds

START_S = gps_seconds(2024, 6, 24, 8, 0, 0)
"""Reference time of orbits and clocks: a Monday, in the middle of a simulated run's window."""
_IONOSPHERE = Klobuchar((1.8626e-08, 2.2352e-08, -1.1921e-07, -5.9605e-08), (1.2902e5, 1.6384e5, -1.9661e5, -2.6214e5))
"""The coefficients broadcast on that day."""


@dataclass(frozen=True)
class Walker:
    """One constellation: letter, planes, satellites in a plane, semi-major axis (m), inclination (degrees), phasing."""

    letter: str
    planes: int
    in_plane: int
    axis_m: float
    inclination_deg: float
    phasing: int


GPS = Walker("G", 6, 5, 26_559_800.0, 55.0, 2)
GALILEO = Walker("E", 3, 8, 29_600_318.0, 56.0, 1)
BEIDOU = Walker("C", 3, 8, 27_906_100.0, 55.0, 1)
"""Shapes of the published constellations: GPS in six planes, Galileo, and BeiDou's medium orbits."""


def constellation(walkers: Sequence[Walker], rng: np.random.Generator, *, start_s: float = START_S) -> Navigation:
    """Return ephemerides around `start_s`, and the ionosphere.

    The rotation of a constellation around the Earth is random; clocks, eccentricities and harmonics have usual magnitudes.
    """
    return Navigation(tuple(one for walker in walkers for one in _satellites(walker, rng, start_s)), _IONOSPHERE)


def _satellites(walker: Walker, rng: np.random.Generator, start_s: float) -> Iterator[Ephemeris]:
    total = walker.planes * walker.in_plane
    first_node, first_anomaly = rng.uniform(0, 2 * math.pi, 2)
    for number in range(total):
        plane, slot = divmod(number, walker.in_plane)
        node = first_node + 2 * math.pi * plane / walker.planes
        anomaly = first_anomaly + 2 * math.pi * (slot / walker.in_plane + walker.phasing * plane / total)
        yield _ephemeris(f"{walker.letter}{number + 1:02d}", walker, node, anomaly, rng, start_s)


def _ephemeris(
    name: str, walker: Walker, node: float, anomaly: float, rng: np.random.Generator, start_s: float
) -> Ephemeris:
    harmonics = rng.normal(0, 1, 6)
    return Ephemeris(
        satellite=name,
        clock_time_s=start_s,
        af0_s=float(rng.normal(0, 2e-4)),
        af1=float(rng.normal(0, 5e-12)),
        af2_per_s=0.0,
        crs_m=60.0 * harmonics[0],
        delta_n=4.5e-9,
        m0=anomaly,
        cuc=3e-6 * harmonics[1],
        eccentricity=float(rng.uniform(0.0002, 0.015)),
        cus=5e-6 * harmonics[2],
        sqrt_a=math.sqrt(walker.axis_m),
        orbit_time_s=start_s,
        cic=1e-7 * harmonics[3],
        omega0=node,
        cis=1e-7 * harmonics[4],
        i0=math.radians(walker.inclination_deg),
        crc_m=250.0 + 40.0 * harmonics[5],
        omega=0.0,
        omega_dot=-8e-9,
        idot=float(rng.normal(0, 3e-10)),
        healthy=True,
        group_delay_s=float(rng.normal(0, 5e-9)),
        sent_s=start_s - 7_200,
    )
