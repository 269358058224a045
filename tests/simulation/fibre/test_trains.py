"""Trains as axle loads with a course."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.simulation.fibre.trains import COACH, LOCOMOTIVE, TWO_AXLE_WAGON, Course, Train, coaches, steady


def test_axles_stand_in_bogies() -> None:
    """19 m between the bogies of a coach, 2.5 m in each."""
    assert [2.45, 4.95, 21.45, 23.95] == pytest.approx(COACH.axles_m())
    assert [3.0, 11.0] == pytest.approx(TWO_AXLE_WAGON.axles_m())


def test_a_train_is_its_vehicles() -> None:
    """Lengths and axles add up."""
    train = coaches(3, Course(0.0, ((0.0, 10.0),)))
    assert 18.9 + 3 * 26.4 == pytest.approx(train.length_m)
    assert 16 == len(train.axles_m()) == len(train.loudness())
    assert np.all(np.diff(train.axles_m()) > 0)
    assert train.axles_m()[-1] < train.length_m


@pytest.mark.parametrize("ahead", [True, False])
def test_axles_lie_between_the_ends(ahead: bool) -> None:
    """Whichever end goes ahead."""
    train = Train((LOCOMOTIVE, COACH), Course(500.0, ((0.0, 20.0),)), ahead)
    low, high = train.ends_m(3.0)
    places = train.axle_places_m(np.array([3.0]))[0]
    assert low < places.min() < places.max() < high
    assert train.length_m == pytest.approx(high - low)
    assert 560 == pytest.approx(high if ahead else low)


def test_the_place_is_the_integral_of_the_speed() -> None:
    """Exactly, also before the first and after the last point, and backwards."""
    course = Course(100.0, ((10.0, 20.0), (20.0, 0.0), (30.0, -10.0)))
    seconds = np.array([0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0])
    assert [100, 200, 300, 375, 400, 350, 250] == pytest.approx(list(course.place_m(seconds)))
    fine = np.linspace(0, 40, 400_001)
    assert np.trapezoid(course.speed_m_s(fine), fine) == pytest.approx(150, abs=1e-3)


@pytest.mark.parametrize("speeds", [(), ((1.0, 5.0), (1.0, 6.0)), ((2.0, 5.0), (1.0, 6.0))])
def test_a_course_goes_on_in_time(speeds: tuple[tuple[float, float], ...]) -> None:
    """Or is refused."""
    with pytest.raises(InputError, match="ascending order of seconds"):
        Course(0.0, speeds)


def test_a_steady_train_faces_its_way() -> None:
    """Its end A in front."""
    assert [True, False] == [steady([COACH], 0.0, speed).ahead for speed in (5.0, -5.0)]
