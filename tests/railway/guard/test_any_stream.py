"""Whatever a receiver says, the guard goes on, gives a reason each time, and never narrows by what it withholds."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.models.guard.variables import JUDGED
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.guard import MODES, Judgement
from safeloc.railway.guard.judgement_data import as_data
from tests.railway.guard.made import fix, guard, place

pytest.importorskip("shapely")
pytest.importorskip("pyproj")

ODD = st.sampled_from([math.nan, math.inf, -math.inf, 0.0, 1e308, -1e9, 90.0, 500.0])
NEAR = st.builds(lambda x, y: place(x, y), st.floats(-50, 1_100), st.floats(-40, 80))
TIMES = st.one_of(st.integers(0, 5_000), st.integers(-(10**12), 10**13), st.none())


@st.composite
def deliveries(draw: st.DrawFn) -> Delivery:
    """A delivery with anything in it that a reader lets through."""
    x, y = draw(st.one_of(NEAR, st.tuples(ODD, ODD), st.just((None, None))))
    speed = draw(st.one_of(st.none(), st.integers(0, 1_000_000)))
    received = draw(st.one_of(st.none(), st.integers(0, 6_000)))
    return Delivery(
        1, draw(TIMES), x, y, speed, draw(st.text(max_size=3)), received, draw(st.sampled_from(["", "", "bad"]))
    )


def after_a_row(others: list[Delivery]) -> list[Judgement]:
    """The judgements of others, once a receiver at rest is believed."""
    made = guard()
    for number in range(3):
        made.judge(fix(0.4 * number, 300))
    return [made.judge(one) for one in others]


@settings(max_examples=settings.default.max_examples // 2)
@given(st.lists(deliveries(), max_size=12))
def test_it_goes_on_whatever_comes(others: list[Delivery]) -> None:
    """No delivery stops it, each has a known reason and mode, and only passed ones have a position."""
    for found in after_a_row(others):
        told = as_data(found)
        assert found.reason in {reason.label for reason in JUDGED}
        assert found.mode in MODES
        assert found.passed is (found.reason == "PASSED") is (told["position"] is not None)
        assert not found.passed or found.interval_mm is not None


@pytest.mark.thorough
@given(st.lists(deliveries(), max_size=12))
def test_what_is_withheld_narrows_nothing(others: list[Delivery]) -> None:
    """After a delivery that is withheld no window lies within the one before."""
    made = guard()
    window = None
    for one in [*(fix(0.4 * number, 300) for number in range(3)), *others]:
        found = made.judge(one)
        if not found.passed and window is not None and found.window_mm is not None:
            assert found.window_mm[0] <= window[0] or found.window_mm[1] >= window[1]
            assert found.window_mm[1] - found.window_mm[0] >= window[1] - window[0]
        window = found.window_mm


@pytest.mark.thorough
@given(st.lists(deliveries(), min_size=1, max_size=12))
def test_the_flag_changes_nothing(others: list[Delivery]) -> None:
    """With other quality flags the judgements are the same."""
    flagged = [replace(one, flag="NARROW_INT3") for one in others]
    one, other = after_a_row(others), after_a_row(flagged)
    assert [(each.reason, each.window_mm) for each in one] == [(each.reason, each.window_mm) for each in other]
