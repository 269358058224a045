"""Images that several tests read: reflectors of the default figures on a straight track, with or without clutter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import RadarImage
from safeloc.sensing.radar import Frame, read
from safeloc.sensing.signature import Model
from safeloc.simulation.radar import Bias, Points, image
from safeloc.simulation.radar_scene import Clutter, World, seen, world
from safeloc.simulation.radar_track import Reflector

CONFIG = RadarConfig()
BARE = Clutter(stones_per_m=0, masts_every_mm=1_000_000)


def bare(reflectors: Sequence[Reflector], *, wall_mm: float | None = None, double_bounce: bool = False) -> World:
    """Reflectors and nothing else."""
    rng = np.random.default_rng(0)
    return world(CONFIG, reflectors, rng, length_mm=300_000, clutter=BARE, wall_mm=wall_mm, double_bounce=double_bounce)


def frame(
    points: Points, seed: int = 0, *, speed_mm_s: float = 0.0, bias: Bias | None = None, config: RadarConfig = CONFIG
) -> Frame:
    """What the front end reads in the image of these points."""
    power = image(points, config, np.random.default_rng(seed), speed_mm_s=speed_mm_s, bias=bias)
    outcome = read(RadarImage(power, 0, 0), config)
    assert isinstance(outcome, Frame), outcome
    return outcome


def frame_at(
    scene: World, along_mm: float, seed: int = 0, *, speed_mm_s: float = 0.0, bias: Bias | None = None
) -> Frame:
    """What the front end reads there."""
    return frame(seen(scene, along_mm), seed, speed_mm_s=speed_mm_s, bias=bias)


def models(found: Frame) -> list[Model]:
    """Models without doubt, nearest first."""
    return [echo.model for echo in found.echoes if echo.model is not Model.UNKNOWN]
