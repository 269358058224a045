"""From cable to track."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.railway.map.elements import Fibre, FibrePoint, Stretch
from safeloc.sensing.fibre.fibre_map import FibreMap, from_line, one_to_one, place_of
from safeloc.sensing.rounding import ExactBounds

MAP = FibreMap(((0, 0), (1_000, 980), (1_050, 980), (3_000, 2_900)), error_mm=10)


def test_slack_is_spread_between_surveyed_points() -> None:
    """A loop in a shaft is cable at one place; beyond the last point the last piece goes on."""
    assert [0, 490, 980, 980, 2_900] == [MAP.path_mm(one) for one in (0, 500, 1_010, 1_050, 3_000)]
    assert 2_900 + 195 * (2_900 - 980) / 1_950 == pytest.approx(float(MAP.path_mm(3_195)))
    assert -49 == MAP.path_mm(-50)


@given(st.integers(0, 3_000), st.integers(0, 3_000), st.integers(0, 3_000))
def test_bounds_on_the_fibre_become_bounds_on_the_track(one: int, other: int, truth: int) -> None:
    """What lies between two places of the cable lies between their places on the track."""
    low, high = min(one, other), max(one, other)
    found = MAP.on_track(ExactBounds(low, high))
    if low <= truth <= high:
        assert found.low <= MAP.path_mm(truth) - 10
        assert MAP.path_mm(truth) + 10 <= found.high


@pytest.mark.parametrize("points", [((0, 0),), ((0, 0), (0, 5)), ((0, 10), (5, 9))])
def test_a_map_goes_on(points: tuple[tuple[int, int], ...]) -> None:
    """Along fibre and path, with two points at least."""
    with pytest.raises(InputError):
        FibreMap(points)


def line_fibre(*points: tuple[int, str, int]) -> Fibre:
    """Along edge A, then against edge B."""
    return Fibre(
        id="F",
        length_mm=5_000,
        path=(Stretch(edge="A", from_mm=0, to_mm=2_000), Stretch(edge="B", from_mm=1_500, to_mm=0)),
        map_points=tuple(FibrePoint(fibre_mm=fibre, edge=edge, position_mm=place) for fibre, edge, place in points),
    )


def test_the_lines_map_points_give_the_map() -> None:
    """Positions against an edge count from where it is entered."""
    made = from_line(line_fibre((0, "A", 0), (2_100, "A", 2_000), (3_700, "B", 0)))
    assert ((0, 0), (2_100, 2_000), (3_700, 3_500)) == made.points


def test_a_surveyed_point_lies_on_the_path() -> None:
    """Or the map is refused."""
    with pytest.raises(InputError, match="2100 mm of fibre F does not lie on its path"):
        from_line(line_fibre((0, "A", 0), (2_100, "C", 5)))


def test_places_along_the_path_are_places_on_edges() -> None:
    """And back; beyond the path there are none."""
    path = line_fibre((0, "A", 0), (10, "A", 10)).path
    assert [("A", 500), ("B", 1_400)] == [place_of(path, 500), place_of(path, 2_100)]
    with pytest.raises(InputError, match="3500 mm long"):
        place_of(path, 3_501)


def test_without_slack_all_is_one_to_one() -> None:
    """Exactly."""
    assert ExactBounds(5, 9) == one_to_one(100).on_track(ExactBounds(5, 9))
