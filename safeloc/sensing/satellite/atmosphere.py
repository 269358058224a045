"""Delays of the atmosphere: the broadcast ionosphere (IS-GPS-200, 20.3.3.5.2.5) and a simple troposphere."""

from __future__ import annotations

import math
from dataclasses import dataclass

from safeloc.sensing.satellite.figures import LIGHT_M_PER_S
from safeloc.sensing.satellite.places import Place

Four = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Klobuchar:
    """The eight broadcast coefficients alpha and beta."""

    alpha: Four
    beta: Four

    def delay_m(self, place: Place, elevation_rad: float, azimuth_rad: float, time_s: float) -> float:
        """Return the delay on L1 in metres. The model removes about half of the real delay (IS-GPS-200)."""
        height = elevation_rad / math.pi
        angle = 0.0137 / (height + 0.11) - 0.022
        latitude = max(-0.416, min(0.416, place.latitude_rad / math.pi + angle * math.cos(azimuth_rad)))
        longitude = place.longitude_rad / math.pi + angle * math.sin(azimuth_rad) / math.cos(latitude * math.pi)
        magnetic = latitude + 0.064 * math.cos((longitude - 1.617) * math.pi)
        local_s = (43_200 * longitude + time_s) % 86_400
        amplitude_s = max(0.0, _cubic(self.alpha, magnetic))
        phase = 2 * math.pi * (local_s - 50_400) / max(72_000.0, _cubic(self.beta, magnetic))
        day = amplitude_s * (1 - phase**2 / 2 + phase**4 / 24) if abs(phase) < 1.57 else 0.0
        return LIGHT_M_PER_S * (1 + 16 * (0.53 - height) ** 3) * (5e-9 + day)


def _cubic(coefficients: Four, x: float) -> float:
    return sum(c * x**power for power, c in enumerate(coefficients))


def troposphere_m(height_m: float, elevation_rad: float) -> float:
    """Return 2.47 m over sin(elevation) + 0.0121, falling by 13.3 % with each kilometre of height.

    Model of Spilker (Global Positioning System: Theory and Applications I, 1996, chapter 13); 1 m at 10 degrees.
    """
    return 2.47 / (math.sin(elevation_rad) + 0.0121) * math.exp(-0.000133 * height_m)
