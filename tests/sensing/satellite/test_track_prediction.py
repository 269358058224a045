"""The predicted state: constant acceleration, laid along the mapped portion."""

from __future__ import annotations

import math

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.places import Vector
from safeloc.sensing.satellite.track_prediction import Portion, TrackState, on_portion

RADIUS_M = 500.0


def curve(step_m: float = 20.0, pieces: int = 20) -> Portion:
    """A curve of constant radius, its points surveyed every so many metres of the arc."""
    angles = [n * step_m / RADIUS_M for n in range(pieces + 1)]
    points = tuple((RADIUS_M * math.sin(angle), RADIUS_M * (1 - math.cos(angle)), 0.0) for angle in angles)
    return Portion(1_000.0, points, (step_m,) * pieces)


STRAIGHT = Portion(1_000.0, ((0.0, 0.0, 0.0), (300.0, 0.0, 0.0)))


def _true(distance_m: float) -> tuple[Vector, Vector]:
    angle = (distance_m - 1_000) / RADIUS_M
    point = (RADIUS_M * math.sin(angle), RADIUS_M * (1 - math.cos(angle)), 0.0)
    return point, (math.cos(angle), math.sin(angle), 0.0)


def test_the_way_is_laid_along_the_track() -> None:
    """2 s at 60 m/s braking 10 m/s2 on a curve: 100 m of way along the arc, 40 m/s in the direction there."""
    state = TrackState(1_050.0, 60.0, -10.0).after(2.0)
    assert TrackState(1_150.0, 40.0, -10.0) == state
    (place,) = on_portion(state, [curve()])
    point, along = _true(1_150.0)
    assert math.dist(point, place.point_m) < 0.001
    assert math.dist(place.velocity_m_per_s, [40 * part for part in along]) < 0.03


def test_a_curve_is_met_between_its_points() -> None:
    """Everywhere on it the course is within millimetres, and its direction within a twentieth of a degree."""
    for distance in range(1_000, 1_401, 3):
        (point, along), (true, there) = curve().at(distance), _true(distance)
        assert math.dist(point, true) < 0.01, distance
        assert math.dist(along, there) < 0.001, distance


def test_the_bend_is_never_less_than_it_is() -> None:
    """1/500 m in the curve; 0 on the straight."""
    assert 1 / RADIUS_M * 0.99 < curve().bend_per_m(1_100, 1_200) < 1 / RADIUS_M * 1.05
    assert abs(STRAIGHT.bend_per_m(1_000, 1_300)) < 1e-12


def test_the_bend_bounds_the_way_off_the_tangent() -> None:
    """d metres on, the course is no more than bend d2/2 off the tangent, and has turned by no more than bend d."""
    track = curve()
    bend = track.bend_per_m(1_100, 1_200)
    (start, along), reach = track.at(1_100), range(0, 101, 5)
    for way in reach:
        point, there = track.at(1_100 + way)
        straight = [p + way * a for p, a in zip(start, along, strict=True)]
        assert math.dist(point, straight) <= bend * way**2 / 2 + 1e-9
        assert math.dist(along, there) <= bend * way + 1e-9


def test_the_map_says_how_long_a_piece_is() -> None:
    """A piece that is 1 % longer on the map than straight across is run 1 % slower in space."""
    portion = Portion(0.0, ((0.0, 0.0, 0.0), (100.0, 0.0, 0.0)), (101.0,))
    assert portion.end_m == 101.0
    assert portion.at(50.5)[1][0] == pytest.approx(100 / 101)


def test_an_undecided_switch_gives_both() -> None:
    """Two possible portions: a prediction on each."""
    places = on_portion(TrackState(1_150.0, 40.0, 0.0), [curve(), STRAIGHT])
    assert [150.0, _true(1_150.0)[0][0]] == [places[1].point_m[0], pytest.approx(places[0].point_m[0])]


def test_beyond_the_map_nothing_is_predicted() -> None:
    """Past the end, with no portion, with a portion of one point, with lengths that do not fit, with time that stands."""
    with pytest.raises(InputError, match="not on the mapped portion"):
        STRAIGHT.at(1_301.0)
    with pytest.raises(InputError, match="not on the mapped portion"):
        STRAIGHT.bend_per_m(900.0, 1_100.0)
    with pytest.raises(InputError, match="no stretch"):
        STRAIGHT.bend_per_m(1_200.0, 1_100.0)
    with pytest.raises(InputError, match="no portion"):
        on_portion(TrackState(0.0, 0.0, 0.0), [])
    with pytest.raises(InputError, match="two or more"):
        Portion(0.0, ((0.0, 0.0, 0.0),))
    with pytest.raises(InputError, match="as many lengths"):
        Portion(0.0, ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), (1.0, 2.0))
    with pytest.raises(InputError, match="no time forward"):
        TrackState(0.0, 0.0, 0.0).after(0.0)
