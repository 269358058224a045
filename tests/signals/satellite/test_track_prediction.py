"""The predicted state: constant acceleration, laid along the mapped portion."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.signals.satellite.track_prediction import Portion, TrackState, on_portion

BENT = Portion(1_000.0, ((0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (100.0, 100.0, 0.0)))
STRAIGHT = Portion(1_000.0, ((0.0, 0.0, 0.0), (300.0, 0.0, 0.0)))


def test_the_way_is_laid_along_the_track() -> None:
    """2 s at 60 m/s braking 10 m/s2: 100 m of way, 50 m of it past the bend, 40 m/s in the new direction."""
    state = TrackState(1_050.0, 60.0, -10.0).after(2.0)
    assert TrackState(1_150.0, 40.0, -10.0) == state
    assert [((100.0, 50.0, 0.0), (0.0, 40.0, 0.0))] == on_portion(state, [BENT])


def test_an_undecided_switch_gives_both() -> None:
    """Two possible portions: a prediction on each."""
    points = [point for point, _ in on_portion(TrackState(1_150.0, 40.0, 0.0), [BENT, STRAIGHT])]
    assert [(100.0, 50.0, 0.0), (150.0, 0.0, 0.0)] == points


def test_beyond_the_map_nothing_is_predicted() -> None:
    """Past the end, with no portion, with a portion of one point, with time that stands."""
    with pytest.raises(InputError, match="not on the mapped portion"):
        BENT.at(1_201.0)
    with pytest.raises(InputError, match="no portion"):
        on_portion(TrackState(0.0, 0.0, 0.0), [])
    with pytest.raises(InputError, match="two or more"):
        Portion(0.0, ((0.0, 0.0, 0.0),))
    with pytest.raises(InputError, match="no time forward"):
        TrackState(0.0, 0.0, 0.0).after(0.0)
