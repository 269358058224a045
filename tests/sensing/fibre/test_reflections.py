"""Reflecting points in the light, an end without an absorber, and dark fibre."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.sensing.fibre.figures import FibreConfig, Interrogator, PointPlace
from safeloc.sensing.fibre.reflections import Reflections, coincident, reflections

POINTS = (PointPlace(id="P1", fibre_mm=1_000_000), PointPlace(id="P2", fibre_mm=2_000_000))
CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=3_000_000, pulse_ns=100), point_places=POINTS)
CHANNELS = CONFIG.interrogator.light_channels


def light(*bright: int, seed: int = 0) -> np.ndarray[tuple[int], np.dtype[np.float32]]:
    """Scatter, with points a thousand times as bright at these channels."""
    intensity = np.random.default_rng(seed).exponential(1.0, CHANNELS)
    intensity[list(bright)] = 1_000
    return intensity.astype(np.float32)


def test_points_are_found_where_the_light_says() -> None:
    """Drift moves them; they are measured, not looked up."""
    found = reflections(light(100, 203), CONFIG)
    assert {"P1": 1_005_105.5, "P2": 2_035_105.5} == found.seen
    assert ((), False, 0.0) == (found.missing, found.end_reflects, found.dark_percent)


@pytest.mark.parametrize("bright", [(100,), (100, 195, 205), (100, 250)])
def test_a_point_is_missing_when_it_is_not_the_only_one_near(bright: tuple[int, ...]) -> None:
    """None, two, or one too far away."""
    assert ("P2",) == reflections(light(*bright), CONFIG).missing


@pytest.mark.parametrize("seed", range(20))
def test_scatter_alone_reflects_nothing(seed: int) -> None:
    """Over many fibres."""
    found = reflections(light(seed=seed), CONFIG)
    assert ({}, False) == (found.seen, found.end_reflects)


def test_an_end_without_absorber_shows() -> None:
    """Bright in the last channels; a known point there is none."""
    assert reflections(light(CHANNELS - 1), CONFIG).end_reflects
    last = CONFIG.model_copy(update={"point_places": (PointPlace(id="P", fibre_mm=(CHANNELS - 1) * 10_000),)})
    assert not reflections(light(CHANNELS - 1), last).end_reflects


def test_dark_fibre_shows() -> None:
    """Stretches of three channels and more; single dark channels are fading."""
    intensity = light()
    intensity[50] = 0
    assert 0 == reflections(intensity, CONFIG).dark_percent
    assert reflections(intensity, CONFIG).faded[50]
    assert reflections(intensity, CONFIG).faded[49]
    intensity[100:] = 0
    assert 60 < reflections(intensity, CONFIG).dark_percent < 70


def test_coincidence_is_between_what_was_measured() -> None:
    """Both ends included."""
    found = Reflections({"B": 20.0, "A": 10.0}, (), False, 0.0, np.zeros(1, np.bool_))
    assert ("A", "B") == coincident(found, 10.0, 20.0)
    assert ("A",) == coincident(found, 5.0, 19.0)
    assert () == coincident(found, 11.0, 19.0)
