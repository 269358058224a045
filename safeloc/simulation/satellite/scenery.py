"""Simulates objects beside the track, and their effect on satellite signals.

Walls stand parallel to the track. A wall blocks a direct signal that would cross it below its top. A blocked signal may still
arrive by the wall across the track: a detour of twice the wall's distance, times the sine of the angle of incidence. A house
that faces the train gives a detour that shrinks while the train approaches it, so the rate is wrong too. An echo beside a
direct signal shifts the code by a share of its detour that depends on the phase of the carrier.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from safeloc.errors import InputError
from safeloc.sensing.array_types import Flags, Floats
from safeloc.sensing.satellite.figures import L1_WAVELENGTH_M

SceneKind = Literal["open sky", "urban canyon", "cutting", "tunnel", "station roof"]
_BLOCK_M = 30.0
"""The length of a house; each has its own height."""


@dataclass(frozen=True)
class Scene:
    """The surroundings of a stretch of line, in m along it.

    wall_m       distance from the track's axis to the wall on each side
    height_m     height of the wall above the antenna; the share `uneven` of it varies between houses of a canyon
    gap_percent  share of missing houses
    reflecting   share of the amplitude that a wall reflects; earth reflects nothing
    facing_percent  share of houses with a front that faces the train
    """

    kind: SceneKind
    from_m: float
    to_m: float
    wall_m: float = 0.0
    height_m: float = 0.0
    uneven: float = 0.0
    gap_percent: int = 0
    reflecting: float = 0.0
    facing_percent: int = 0

    def __post_init__(self) -> None:
        if not self.from_m < self.to_m:
            raise InputError(f"{self.kind} from {self.from_m} m to {self.to_m} m has no length.")
        if self.kind not in ("open sky", "tunnel") and not (self.wall_m > 0 and self.height_m > 0):
            raise InputError(f"{self.kind} at {self.from_m} m needs walls: distance and height above 0.")


def canyon(from_m: float, to_m: float) -> Scene:
    """Return a street with five-storey houses and the tracks in the middle. [M] figures of an inner city."""
    return Scene("urban canyon", from_m, to_m, 11.0, 15.0, 0.4, 12, 0.5, 25)


def cutting(from_m: float, to_m: float) -> Scene:
    """Return a cutting with earth on both sides, 8 m high. [M]"""
    return Scene("cutting", from_m, to_m, 7.0, 8.0)


def tunnel(from_m: float, to_m: float) -> Scene:
    """Return a tunnel, without view of the sky."""
    return Scene("tunnel", from_m, to_m)


def station_roof(from_m: float, to_m: float) -> Scene:
    """Return a steel station hall: signals enter only below the edge of the roof, 9 m aside and 6 m up. [M]"""
    return Scene("station roof", from_m, to_m, 9.0, 6.0, 0.0, 0, 0.6, 0)


@dataclass(frozen=True)
class Rays:
    """The directions of satellites: elevation, and azimuth to the right of the track (rad), arrays [epoch, satellite]; place (m)
    and speed (m/s) of the antenna, arrays [epoch]."""

    elevation: Floats
    beside: Floats
    place_m: Floats
    speed_m_per_s: Floats


@dataclass(frozen=True)
class Received:
    """The signals at the antenna, arrays [epoch, satellite].

    received    a signal arrives, direct or not
    reflected   it arrives by a detour only
    error_m, error_m_per_s  errors of pseudorange and rate from detour or echo
    """

    received: Flags
    reflected: Flags
    error_m: Floats
    error_m_per_s: Floats


def received(scenes: Sequence[Scene], rays: Rays, rng: np.random.Generator) -> Received:
    """Compute the signals at the antenna; outside all scenes the sky is open. InputError for scenes that overlap."""
    ordered = sorted(scenes, key=lambda scene: scene.from_m)
    for before, after in pairwise(ordered):
        if before.to_m > after.from_m:
            raise InputError(f"{after.kind} at {after.from_m} m begins within the {before.kind}; separate them.")
    shape = rays.elevation.shape
    result = Received(rays.elevation > 0, np.zeros(shape, np.bool_), np.zeros(shape), np.zeros(shape))
    for scene in ordered:
        inside = (rays.place_m >= scene.from_m) & (rays.place_m < scene.to_m)
        if inside.any():
            _put(result, inside, _in_scene(scene, _part(rays, inside), rng))
    return result


def _part(rays: Rays, inside: Flags) -> Rays:
    return Rays(rays.elevation[inside], rays.beside[inside], rays.place_m[inside], rays.speed_m_per_s[inside])


def _put(result: Received, inside: Flags, part: Received) -> None:
    for name in ("received", "reflected", "error_m", "error_m_per_s"):
        getattr(result, name)[inside] = getattr(part, name)


def _in_scene(scene: Scene, rays: Rays, rng: np.random.Generator) -> Received:
    shape = rays.elevation.shape
    nothing = Received(np.zeros(shape, np.bool_), np.zeros(shape, np.bool_), np.zeros(shape), np.zeros(shape))
    if scene.kind == "tunnel":
        return nothing
    if scene.kind == "open sky":
        return Received(rays.elevation > 0, nothing.reflected, nothing.error_m, nothing.error_m_per_s)
    walls = _Walls(scene, rng)
    up = rays.elevation > 0
    crossing = scene.wall_m * np.tan(rays.elevation) / np.maximum(np.abs(np.sin(rays.beside)), 1e-3)
    near, far = walls.height(rays, 1), walls.height(rays, -1)
    direct = up & ((crossing < scene.height_m) if scene.kind == "station roof" else (crossing > near))
    across = up & ~direct & (scene.reflecting > 0) & _by_the_other_wall(scene, crossing, near, far)
    return _with_detours(scene, rays, direct, across, walls)


def _by_the_other_wall(scene: Scene, crossing: Floats, near: Floats, far: Floats) -> Flags:
    """Return whether the signal passes over the near wall to the far one; in a hall it always meets steel."""
    if scene.kind == "station roof":
        return np.ones(crossing.shape, np.bool_)
    return np.asarray((3 * crossing > near) & (crossing < far))


def _with_detours(scene: Scene, rays: Rays, direct: Flags, across: Flags, walls: _Walls) -> Received:
    side = 2 * scene.wall_m * np.cos(rays.elevation) * np.abs(np.sin(rays.beside))
    ahead, facing = walls.front(rays)
    front = 2 * ahead[:, None] * np.cos(rays.elevation) * np.maximum(np.cos(rays.beside) * -1, 0)
    shrinks = -2 * rays.speed_m_per_s[:, None] * np.cos(rays.elevation) * np.maximum(np.cos(rays.beside) * -1, 0)
    by_front = across & facing[:, None] & (front > side)
    detour, rate = np.where(by_front, front, side), np.where(by_front, shrinks, 0.0)
    echo = direct & (scene.reflecting > 0)
    bent = 0.25 * scene.reflecting * side * np.exp(-side / 75) * np.cos(2 * math.pi * side / L1_WAVELENGTH_M)
    error = np.where(across, detour, np.where(echo, bent, 0.0))
    return Received(direct | across, across, error, np.where(across, rate, 0.0))


class _Walls:
    """The houses of a scene: each block of each side with a height, some with a front that faces the train."""

    def __init__(self, scene: Scene, rng: np.random.Generator) -> None:
        self.scene = scene
        self.blocks = math.ceil((scene.to_m - scene.from_m) / _BLOCK_M)
        heights = scene.height_m * (1 + scene.uneven * rng.uniform(-1, 1, (2, self.blocks)))
        self.heights = np.where(rng.integers(0, 100, (2, self.blocks)) < scene.gap_percent, 0.0, heights)
        self.facing = rng.integers(0, 100, self.blocks) < scene.facing_percent

    def height(self, rays: Rays, towards: int) -> Floats:
        """Return the height of the wall on the satellite's side where its ray crosses (1), or of the wall across the track (-1)."""
        right = np.sin(rays.beside) * towards > 0
        run = self.scene.wall_m * np.cos(rays.beside) / np.maximum(np.abs(np.sin(rays.beside)), 0.05)
        within = rays.place_m[:, None] + run - self.scene.from_m
        block = np.clip((within // _BLOCK_M).astype(np.int64), 0, self.blocks - 1)
        return np.asarray(self.heights[np.where(right, 1, 0), block])

    def front(self, rays: Rays) -> tuple[Floats, Flags]:
        """Return the distance to the end of the block beside the train, and whether a house there faces the train."""
        within = rays.place_m - self.scene.from_m
        block = np.clip((within // _BLOCK_M).astype(np.int64), 0, self.blocks - 1)
        return (block + 1) * _BLOCK_M - within + _BLOCK_M, self.facing[block]
