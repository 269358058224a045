"""How the ground shakes."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.simulation.fibre.ground import Car, GroundFigures, Noise, Sources
from safeloc.simulation.fibre.trains import COACH, Course, Train

CELLS_M = np.arange(1_000) * 2.5
SECONDS = np.arange(1_000) / 1_000


def strain(
    *trains: Train, cars: tuple[Car, ...] = (), figures: GroundFigures | None = None
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """One second, [frames, cells]."""
    sources = Sources(trains, cars, figures or GroundFigures(), 1_000, np.random.default_rng(0))
    made = np.zeros((len(SECONDS), len(CELLS_M)))
    for cells, piece in sources.strain(SECONDS, CELLS_M):
        made[:, cells] += piece
    return made


def standing(speed: float, level: float = 2.5) -> Train:
    """One coach at 1000 m that rolls as loud as at a speed, without its weight's bend moving much."""
    return Train((COACH,), Course(1_000.0, ((0.0, speed),)), True, level)


def test_noise_has_unit_rms_and_no_seams() -> None:
    """Block after block it is one stream."""
    parts = Noise(3, 200, 1_000, np.random.default_rng(0))
    joined = np.concatenate([parts.next(500) for _ in range(20)])
    assert np.allclose(1, joined.std(axis=0), atol=0.05)
    steps = np.abs(np.diff(joined, axis=0))
    assert steps[499::500].mean() == pytest.approx(steps.mean(), rel=0.3)


def test_noise_ends_at_its_corner() -> None:
    """Ten times above it, a hundredth of the power."""
    spectrum = np.abs(np.fft.rfft(Noise(1, 20, 1_000, np.random.default_rng(0)).next(8_000)[:, 0])) ** 2
    assert spectrum[8 * 200 :].mean() < spectrum[: 8 * 10].mean() / 100


def test_a_train_shakes_its_place_and_not_far_from_it() -> None:
    """Energy falls with the fourth power of distance."""
    rms = strain(standing(30.0), figures=GroundFigures(bend=0)).std(axis=0)
    inside, near, far = rms[390:410].mean(), rms[(CELLS_M > 1_042) & (CELLS_M < 1_046)].mean(), rms[CELLS_M > 1_100]
    assert inside > 5 * near > 0
    assert np.all(far == 0)


def test_a_train_is_louder_the_faster_it_goes_and_silent_when_it_stands() -> None:
    """In proportion; engines that remain are a figure."""
    loud = [strain(standing(speed), figures=GroundFigures(bend=0)).std() for speed in (0.0, 15.0, 30.0)]
    assert 0 == loud[0]
    assert 2 == pytest.approx(loud[2] / loud[1], rel=0.25)
    humming = Train((COACH,), Course(1_000.0, ((0.0, 0.0),)), True, 2.5, standing=0.2)
    assert strain(humming, figures=GroundFigures(bend=0)).std() > 0


def test_axles_press_and_lift() -> None:
    """Below a standing axle the full bend, beside it the other way."""
    still = strain(standing(0.0))[0]
    axle = int(np.argmin(np.abs(CELLS_M - (1_000 - COACH.axles_m()[0]))))
    assert still[axle] > 15
    assert still.min() < -5


def test_cars_shake_slowly_and_wide() -> None:
    """25 m to the road: a car is felt over 50 m and more, below 20 Hz."""
    made = strain(cars=(Car(1_000.0, 0.0),))
    rms = made.std(axis=0)
    assert rms[(CELLS_M > 1_024) & (CELLS_M < 1_026)].mean() > 0.4 * rms.max()
    spectrum = np.abs(np.fft.rfft(made[:, 400])) ** 2
    assert spectrum[60:].sum() < spectrum[:60].sum() / 50


def test_what_is_outside_the_cable_shakes_nothing() -> None:
    """A train beyond its end."""
    assert np.all(strain(Train((COACH,), Course(9_000.0, ((0.0, 30.0),)))) == 0)
