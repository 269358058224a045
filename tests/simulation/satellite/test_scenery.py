"""What walls do to signals, for rays whose fate can be told by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.simulation.satellite.scenery import (
    Rays,
    Received,
    Scene,
    canyon,
    cutting,
    received,
    station_roof,
    tunnel,
)

WALLS = Scene("urban canyon", 0.0, 300.0, wall_m=10.0, height_m=20.0, reflecting=0.5)


def _rays(elevation_deg: float, beside_deg: float, place_m: float = 150.0, speed_m_per_s: float = 20.0) -> Rays:
    return Rays(
        np.radians([[elevation_deg]]), np.radians([[beside_deg]]), np.array([place_m]), np.array([speed_m_per_s])
    )


def _got(scene: Scene, rays: Rays) -> Received:
    return received((scene,), rays, np.random.default_rng(1))


@pytest.mark.parametrize(
    ("elevation", "beside", "heard", "reflected"),
    [(70.0, 90.0, True, False), (60.0, 90.0, True, True), (30.0, 90.0, False, False), (10.0, 0.0, True, False)],
)
def test_walls_of_equal_height(elevation: float, beside: float, heard: bool, reflected: bool) -> None:
    """Walls of 20 m, 10 m aside: over them; by the other one (26 m at the far side: no, 52 m over the near: yes); gone; along."""
    got = _got(WALLS, _rays(elevation, beside))
    assert (heard, reflected) == (bool(got.received[0, 0]), bool(got.reflected[0, 0]))


def test_a_detour_is_twice_the_distance_of_the_wall() -> None:
    """At 60 degrees, square to the track: 2 x 10 m x cos 60. Walls along the track do not change the rate."""
    got = _got(WALLS, _rays(60.0, 90.0))
    assert 10.0 == pytest.approx(got.error_m[0, 0])
    assert 0.0 == got.error_m_per_s[0, 0]


def test_a_front_ahead_bends_the_rate() -> None:
    """A satellite behind, seen by a house ahead: a long detour that shrinks while the train runs towards it."""
    facing = Scene("urban canyon", 0.0, 300.0, 10.0, 20.0, reflecting=0.5, facing_percent=100)
    behind = _got(facing, _rays(60.0, 120.0))
    assert behind.reflected[0, 0]
    assert 0 > behind.error_m_per_s[0, 0] == pytest.approx(-2 * 20 * math.cos(math.radians(60)) * 0.5)


def test_each_scene_in_its_place() -> None:
    """Open outside, nothing in a tunnel, the low ones gone in a cutting, the high ones in a hall."""
    scenes = (station_roof(0, 100), cutting(200, 300), tunnel(300, 400))

    def at(place_m: float, up_deg: float) -> Received:
        return received(scenes, _rays(up_deg, 90.0, place_m), np.random.default_rng(1))

    assert at(150.0, 15.0).received.all() and not at(150.0, 15.0).reflected.any()
    assert not at(350.0, 80.0).received.any()
    assert not at(250.0, 45.0).received.any() and at(250.0, 50.0).received.all()
    assert at(50.0, 80.0).reflected.all() and not at(50.0, 30.0).reflected.any()


def test_houses_differ_by_seed_and_never_by_call() -> None:
    """One seed, one street."""
    rays = Rays(np.full((60, 1), 0.7), np.full((60, 1), 1.3), np.linspace(0, 599, 60), np.full(60, 20.0))
    first, again, other = (received((canyon(0, 600),), rays, np.random.default_rng(seed)).error_m for seed in (1, 1, 2))
    assert (first == again).all()
    assert not (first == other).all()


def test_scenes_that_cannot_be_are_refused() -> None:
    """Without length, without walls, and one within another."""
    with pytest.raises(InputError, match="has no length"):
        tunnel(5, 5)
    with pytest.raises(InputError, match="needs walls"):
        Scene("cutting", 0, 10)
    with pytest.raises(InputError, match="begins within the tunnel"):
        received((tunnel(0, 100), cutting(50, 200)), _rays(50, 0), np.random.default_rng(1))
