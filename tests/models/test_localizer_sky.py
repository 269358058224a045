"""A simulated satellite front end: least squares along the track."""

from __future__ import annotations

import pytest

from safeloc.models.localizer_sky import directions, drawn_along

EIGHT = [True] * 8


@pytest.mark.parametrize("used", [EIGHT, [False, *EIGHT[1:]], [True, False, False, True, True, False, False, True]])
def test_a_place_further_on_is_found(used: list[bool]) -> None:
    """Signals that are off as a vehicle 30 m further along makes them, and a clock, draw the solution 30 m along."""
    off = [round(5_000 - 30_000 * along) for along, _ in directions(8)]
    assert drawn_along(used, off) == pytest.approx(30_000, abs=2)


def test_a_way_across_draws_nothing_along_where_satellites_stand_evenly() -> None:
    """With one of them missing it does."""
    off = [round(-10_000 * across) for _, across in directions(8)]
    assert abs(drawn_along(EIGHT, off)) <= 1
    assert abs(drawn_along([False, *EIGHT[1:]], off)) > 500
