"""Simulates a run past reflectors as the radar sees it: masts, ballast, ghosts and rain, and faults.

All randomness comes from an explicit generator. Every image comes with the true place.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from safeloc.config import Config, quantity
from safeloc.language.units import NM_PER_MM
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import RadarImage
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.motion import Motion
from safeloc.simulation.radar import Bias, Interference, Points, Weather, image, points
from safeloc.simulation.radar_track import Arc, Pose, Reflector, corners, pose, seen_from

KINDS = Kinds(
    "a radar",
    plain(
        "missing", "frozen", "duplicate", "late", "not finite", "wrong shape", "negative", "dead",
        "interference", "jamming", "overload", "cloudburst", "film",
    ),
)  # fmt: skip
"""Faults of the only radar (no place), in frames."""
_FRONT_SECTION_M2 = 10.0
_PLATE_SECTION_M2 = 10_000.0
_JAMMER_DB = 20.0
_BEAM_STERADIAN = 0.2
_DROPS = 200


class Clutter(Config):
    """Other objects along the line that reflect."""

    masts_every_mm: int = quantity(50_000, "mm", 1_000, 1_000_000, "[M] overhead line")
    mast_cdbsm: int = quantity(0, "cdB over 1 m2", -6_000, 6_000, "[M] mean of a lognormal spread of 5 dB")
    stones_per_m: int = quantity(2, "points a metre", 0, 20, "[M] ballast, rails and plants as points")
    stone_cdbsm: int = quantity(-2_500, "cdB over 1 m2", -9_000, 3_000, "[M] mean of a lognormal spread of 5 dB")


@dataclass(frozen=True, eq=False)
class World:
    """The surroundings of the vehicle. `wall_mm`: distance to a smooth wall on the left, which mirrors every reflector.

    places, sections   clutter: [point, (x, y, height)] and m2
    """

    config: RadarConfig
    track: tuple[Arc, ...]
    reflectors: tuple[Reflector, ...]
    places: NDArray[np.float64]
    sections: NDArray[np.float64]
    wall_mm: float | None = None
    double_bounce: bool = False


@dataclass(frozen=True, eq=False)
class Shot:
    """One frame: true place and speed of the antenna, delivered image (None: nothing) and time of delivery."""

    along_mm: float
    speed_mm_s: float
    image: RadarImage | None
    delivered_ms: int


def world(
    config: RadarConfig,
    reflectors: Sequence[Reflector],
    rng: np.random.Generator,
    *,
    track: Sequence[Arc] = (),
    length_mm: float = 400_000,
    clutter: Clutter | None = None,
    wall_mm: float | None = None,
    double_bounce: bool = False,
) -> World:
    """Return a scene with clutter along the track; masts alternate between right and left, 3.5 to 4 m away."""
    clutter = clutter or Clutter()
    masts = int(length_mm / clutter.masts_every_mm)
    mast_places = [
        (clutter.masts_every_mm * (index + rng.uniform(-0.1, 0.1)), (-1) ** index * rng.uniform(3_500, 4_000))
        for index in range(1, masts + 1)
    ]
    stones = int(length_mm / 1_000 * clutter.stones_per_m)
    stone_places = list(zip(rng.uniform(0, length_mm, stones), rng.uniform(-6_000, 6_000, stones), strict=True))
    places = [(*pose(track, along).aside(left), 0.0) for along, left in [*mast_places, *stone_places] if along >= 0]
    level = np.repeat([clutter.mast_cdbsm, clutter.stone_cdbsm], [masts, stones])
    sections = 10 ** ((level + rng.normal(0, 500, masts + stones)) / 1_000)
    everything = np.array(places, dtype=np.float64).reshape(-1, 3)
    return World(config, tuple(track), tuple(reflectors), everything, sections, wall_mm, double_bounce)


def seen(scene: World, along_mm: float) -> Points:
    """Return all points that reflect power to an antenna at this place, without rain."""
    antenna = pose(scene.track, along_mm)
    corner = _reflectors(scene, antenna)
    found = corner.together(points(*seen_from(antenna, scene.places), scene.sections))
    if scene.double_bounce:
        found = found.together(_bounced(corner))
    return found


def _reflectors(scene: World, antenna: Pose) -> Points:
    places = [corners(one, scene.config.reflectors) for one in scene.reflectors]
    section = 10 ** (scene.config.reflectors.section_cdbsm(scene.config.sensor.carrier_mhz) / 1_000)
    direct = _corners(antenna, places, section)
    if scene.wall_mm is None:
        return direct
    mirrored = [np.column_stack([one[:, 0], 2 * scene.wall_mm - one[:, 1], one[:, 2]]) for one in places]
    return direct.together(_corners(antenna, mirrored, section / 10))


def _corners(antenna: Pose, places: list[NDArray[np.float64]], section: float) -> Points:
    every = np.concatenate([np.zeros((0, 3)), *places])
    return points(*seen_from(antenna, every), section, on_ground=True)


def _bounced(corner: Points) -> Points:
    """Return echoes from one corner to the vehicle's front, to another corner and back: at the sum of both ranges."""
    ahead = np.isfinite(corner.range_mm)
    metres, sine, section = corner.range_mm[ahead] / 1_000, corner.sine[ahead], corner.section_m2[ahead]
    range_m = metres[:, None] + metres[None, :]
    pairs = section[:, None] * section[None, :] * _FRONT_SECTION_M2
    power = pairs * range_m**4 / (4 * np.pi * metres[:, None] ** 2 * metres[None, :] ** 2) ** 2
    sines = np.broadcast_to(sine[None, :], range_m.shape)
    return points(range_m.ravel() * 1_000, sines.ravel(), power.ravel())


def rain(mm_h: float, rng: np.random.Generator, reach_mm: float) -> Points:
    """Return rain as points between 1 m and the reach; eta = 1e-5 m2/m3 x mm/h [M, unsure], a beam of 0.2 sr."""
    range_mm = rng.uniform(1_000, reach_mm, _DROPS)
    shell_m3 = (range_mm / 1_000) ** 2 * _BEAM_STERADIAN * reach_mm / 1_000 / _DROPS
    return points(range_mm, rng.uniform(-0.5, 0.5, _DROPS), 1e-5 * mm_h * shell_m3 * rng.exponential(1.0, _DROPS))


def slant_mm(scene: World, reflector: Reflector, along_mm: float) -> float:
    """Return the true slant range from an antenna at this place to the reflector's nearest corner; NaN if it is not ahead."""
    nearest = corners(replace(reflector, lost=()), scene.config.reflectors)[:1]
    return float(seen_from(pose(scene.track, along_mm), nearest)[0][0])


def shots(
    motion: Motion,
    scene: World,
    rng: np.random.Generator,
    *,
    weather: Weather | None = None,
    bias: Bias | None = None,
    faults: Sequence[Fault] = (),
) -> Iterator[Shot]:
    """Yield one frame at the end of every cycle of the motion. InputError for a fault that would test nothing."""
    KINDS.require(faults, places=[""], length=len(motion.position_nm))
    last: RadarImage | None = None
    for number, (position_nm, speed) in enumerate(zip(motion.position_nm, motion.speed_mm_s, strict=True)):
        kinds = {fault.kind for fault in faults if fault.active(number)}
        along, time_ms = int(position_nm) / NM_PER_MM, (number + 1) * motion.period_ms
        power = _power(scene, along, float(speed), kinds, weather or Weather(), bias, rng)
        taken = RadarImage(_spoilt(power, kinds), time_ms, number)
        delivered = _delivered(taken, last, kinds)
        yield Shot(along, float(speed), delivered, time_ms + (500 if "late" in kinds else 0))
        last = delivered or last


def _power(
    scene: World,
    along: float,
    speed: float,
    kinds: set[str],
    weather: Weather,
    bias: Bias | None,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Return the image, with the faults that act outside the sensor."""
    found = seen(scene, along)
    if "cloudburst" in kinds:
        weather = weather.model_copy(update={"rain_mm_h": 100})
    if "film" in kinds:
        weather = weather.model_copy(update={"film_cdb": 4_000})
    if weather.rain_mm_h:
        found = found.together(rain(weather.rain_mm_h, rng, float(scene.config.sensor.cell_mm) * 1_000))
    if "overload" in kinds:
        found = found.together(points(np.array([4_000.0]), np.array([0.0]), _PLATE_SECTION_M2))
    strange = Interference(sine=float(rng.uniform(-0.5, 0.5))) if "interference" in kinds else None
    return image(
        found, scene.config, rng, speed_mm_s=speed, weather=weather, bias=bias, interference=strange,
        noise_db=_JAMMER_DB if "jamming" in kinds else 0.0,
    )  # fmt: skip


def _spoilt(power: NDArray[np.float64], kinds: set[str]) -> NDArray[np.float64]:
    """Return the image, with the faults of the sensor itself."""
    power = power.copy()
    if "not finite" in kinds:
        power[len(power) // 2, 0] = math.nan
    if "negative" in kinds:
        power[len(power) // 2, 0] = -1.0
    if "dead" in kinds:
        power[:] = 0.0
    return power[:-1] if "wrong shape" in kinds else power


def _delivered(taken: RadarImage, last: RadarImage | None, kinds: set[str]) -> RadarImage | None:
    if "missing" in kinds:
        return None
    if "duplicate" in kinds:
        return last
    if "frozen" in kinds and last is not None:
        return RadarImage(last.power, taken.time_ms, taken.sequence)
    return taken
