"""The distance to failing is negative exactly where a condition fails."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.interpret import evaluate
from safeloc.proof.drawn_runs.slack import Slack
from tests.proof.drawn_runs.test_allowed import CONDITIONS, FLAG, X, Y


@given(st.integers(-60, 60), st.integers(-60, 60), st.booleans())
def test_slack_is_negative_exactly_where_it_fails(x: int, y: int, flag: bool) -> None:
    """The distance to failing is negative exactly if the term fails; it is infinite for purely logical terms."""
    values = {X: x, Y: y, FLAG: flag}
    for term in CONDITIONS:
        assert evaluate([term], values)[0] == (Slack(term)(values) >= 0)
    assert Slack(X <= Y)(values) == y - x
    assert Slack((X <= Y) & (X <= 5))(values) == min(y - x, 5 - x)
    assert Slack((X <= Y) | (X <= 5))(values) == max(y - x, 5 - x)
    assert Slack(FLAG)(values) == (float("inf") if flag else float("-inf"))
