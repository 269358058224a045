"""The lag of a source is what its record's time is behind the latest of any other source, in the order of arrival."""

from __future__ import annotations

from safeloc.runtime.source_clocks import CLOCK_LAW, Lag, SourceClocks, lag_of


def test_the_lag_is_against_the_latest_other_source() -> None:
    """A source alone has none, and its own records do not count."""
    assert lag_of("radar", 90, {}) is None
    assert lag_of("radar", 90, {"radar": 100}) is None
    assert Lag("radar", "marker", 30) == lag_of("radar", 90, {"radar": 500, "wheel": 100, "marker": 120})
    assert Lag("radar", "wheel", -5) == lag_of("radar", 105, {"wheel": 100})


def test_a_lag_of_a_cycle_breaks_the_law() -> None:
    """One ms less does not."""
    assert [0, -1] == [Lag("radar", "wheel", lag_ms).distance_ms(100) for lag_ms in (99, 100)]
    breach = Lag("radar", "wheel", 130).breach(100)
    assert ((CLOCK_LAW,), -31, "ms") == (breach.laws, breach.distance, breach.unit)


def test_least_and_greatest_lag_of_a_recording() -> None:
    """A source that is always behind shows by its least lag; what it repeats from before tells nothing."""
    clocks = SourceClocks()
    for source, time_ms in (("a", 100), ("b", 60), ("a", 200), ("b", 150), ("b", 140), ("a", 300), ("c", 300)):
        clocks.take(source, time_ms)
    assert {"b": 40, "a": -150, "c": 0} == clocks.least
    assert {"b": 50, "a": -140, "c": 0} == {source: lag.lag_ms for source, lag in clocks.greatest.items()}
