"""A place on the WGS 84 ellipsoid, its Earth-fixed coordinates, and directions of satellites seen from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.sensing.satellite.figures import EARTH_FLATTENING, EARTH_RADIUS_M

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Place:
    """Geodetic latitude and longitude (rad) and height above the ellipsoid (m). InputError if not finite."""

    latitude_rad: float
    longitude_rad: float
    height_m: float

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, (self.latitude_rad, self.longitude_rad, self.height_m))):
            raise InputError("a place needs finite latitude, longitude and height; none is assumed.")

    @classmethod
    def degrees(cls, latitude: float, longitude: float, height_m: float) -> Place:
        """Return a place from degrees."""
        return cls(math.radians(latitude), math.radians(longitude), height_m)

    @classmethod
    def of_earth_fixed(cls, point_m: Vector) -> Place:
        """Return a place from Earth-fixed coordinates, to a micrometre; InputError unless 6200 to 6500 km from the centre."""
        x, y, z = point_m
        if not 6.2e6 < math.hypot(x, y, z) < 6.5e6:
            raise InputError(f"{point_m} is not near the Earth's surface; give Earth-fixed metres.")
        level, squared = math.hypot(x, y), EARTH_FLATTENING * (2 - EARTH_FLATTENING)
        latitude = math.atan2(z, level * (1 - squared))
        for _ in range(6):
            normal = EARTH_RADIUS_M / math.sqrt(1 - squared * math.sin(latitude) ** 2)
            latitude = math.atan2(z + squared * normal * math.sin(latitude), level)
        normal = EARTH_RADIUS_M / math.sqrt(1 - squared * math.sin(latitude) ** 2)
        height = level * math.cos(latitude) + z * math.sin(latitude) - EARTH_RADIUS_M**2 / normal
        return cls(latitude, math.atan2(y, x), height)

    def earth_fixed_m(self) -> Vector:
        """Return Earth-centred, Earth-fixed coordinates."""
        squared = EARTH_FLATTENING * (2 - EARTH_FLATTENING)
        normal = EARTH_RADIUS_M / math.sqrt(1 - squared * math.sin(self.latitude_rad) ** 2)
        level = (normal + self.height_m) * math.cos(self.latitude_rad)
        return (
            level * math.cos(self.longitude_rad),
            level * math.sin(self.longitude_rad),
            (normal * (1 - squared) + self.height_m) * math.sin(self.latitude_rad),
        )

    def elevation_azimuth_rad(self, direction: Vector) -> tuple[float, float]:
        """Return the elevation and azimuth (clockwise from north) of an Earth-fixed unit vector."""
        x, y, z = direction
        sin_lat, cos_lat = math.sin(self.latitude_rad), math.cos(self.latitude_rad)
        outward = math.cos(self.longitude_rad) * x + math.sin(self.longitude_rad) * y
        east = -math.sin(self.longitude_rad) * x + math.cos(self.longitude_rad) * y
        up = max(-1.0, min(1.0, cos_lat * outward + sin_lat * z))
        return math.asin(up), math.atan2(east, -sin_lat * outward + cos_lat * z)


def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
