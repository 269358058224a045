"""Intervals hold what they promise, checked on distributions whose answer is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binom, binomtest

from safeloc.campaign.statistics import (
    Part,
    mean_share,
    proportion,
    quantile_ranks,
    rule_of_three,
    shared_confidence,
    stratified,
    weighted_mean,
)


@pytest.mark.parametrize(("events", "trials"), [(0, 1), (0, 40), (1, 40), (20, 40), (40, 40), (3, 100_000)])
def test_the_interval_of_a_share_is_the_exact_binomial_one(events: int, trials: int) -> None:
    """Another implementation gives the same ends."""
    expected = binomtest(events, trials).proportion_ci(0.95, method="exact")
    found = proportion(events, trials, 0.95)
    assert (expected.low, expected.high) == pytest.approx((found.low, found.high), rel=1e-9)
    assert events / trials == found.value


@pytest.mark.parametrize("share", [0.001, 0.02, 0.3, 0.5, 0.97])
def test_the_interval_holds_the_share_as_often_as_it_says(share: float) -> None:
    """Summed over all outcomes of 60 trials, exactly: no normal approximation stands this for a rare event."""
    found = [proportion(events, 60, 0.95) for events in range(61)]
    chances = binom.pmf(range(61), 60, share)
    assert sum(chances[[one.low <= share <= one.high for one in found]]) >= 0.95
    assert sum(chances[[share <= (one.one_sided or 0) for one in found]]) >= 0.95


def test_no_event_bounds_the_share_by_three_over_n() -> None:
    """The rule of three, with its own number at another confidence."""
    assert "0 of 1000: below 3.0/1000 = 0.003 at 95 %" == rule_of_three(1_000, 0.95)
    assert "0 of 1000: below 4.6/1000 = 0.0046 at 99 %" == rule_of_three(1_000, 0.99)
    assert 1 - 0.05 ** (1 / 1_000) == pytest.approx(proportion(0, 1_000, 0.95).one_sided)


def test_a_share_without_trials_is_refused() -> None:
    """There is nothing to say, and not 0."""
    with pytest.raises(ValueError, match=r"^0 events in 0 trials"):
        proportion(0, 0, 0.95)
    with pytest.raises(ValueError, match=r"^4 events in 3 trials"):
        proportion(4, 3, 0.95)
    with pytest.raises(ValueError, match=r"^no trial"):
        mean_share(0, 0, 0, 0.95)
    with pytest.raises(ValueError, match=r"^no trial"):
        quantile_ranks(0.5, 0, 0.95)


def test_strata_weigh_by_what_they_stand_for() -> None:
    """A fault that is run as often as the normal case, but is rare in operation, counts little; its interval holds the known share."""
    parts = [Part(0.99, 0, 500), Part(0.01, 50, 500), Part(0.0, 500, 500)]
    found = stratified(parts, 0.95)
    assert 0.01 * 0.1 == pytest.approx(found.value)
    assert (1_000, 0.0) == (found.trials, pytest.approx(0.01 * proportion(50, 500, 0.975).low - found.low, abs=1e-12))
    assert 0.99 * proportion(0, 500, 0.975).high + 0.01 * proportion(50, 500, 0.975).high == pytest.approx(found.high)


def test_the_stratified_interval_holds_as_often_as_it_says() -> None:
    """Summed over all outcomes of two strata whose shares are known."""
    weights, shares, trials = (0.9, 0.1), (0.05, 0.6), 15
    truth = sum(weight * share for weight, share in zip(weights, shares, strict=True))
    first, second = (binom.pmf(range(trials + 1), trials, share) for share in shares)
    held = 0.0
    for one in range(trials + 1):
        for other in range(trials + 1):
            found = stratified([Part(0.9, one, trials), Part(0.1, other, trials)], 0.9)
            held += first[one] * second[other] * (found.low <= truth <= found.high)
    assert held >= 0.9


def test_the_interval_of_a_mean_holds_as_often_as_it_says() -> None:
    """Shares that are nearly always 1, as availability is: the normal approximation is too narrow there."""
    rng, truth, held = np.random.default_rng(1), 1 - 0.02 * 0.5, 0
    for _ in range(2_000):
        shares = np.where(rng.random(80) < 0.02, 0.5, 1.0)
        found = mean_share(float(shares.sum()), float((shares**2).sum()), 80, 0.95)
        held += found.low <= truth <= found.high
    assert held / 2_000 >= 0.95
    assert (0.0, 1.0) == (mean_share(0.3, 0.09, 1, 0.95).low, mean_share(0.3, 0.09, 1, 0.95).high)


def test_means_of_strata_are_weighed() -> None:
    """The whole lies where the weights put it, within the weighed ends."""
    each = shared_confidence(0.95, 2)
    parts = [(0.75, mean_share(80.0, 80.0, 80, each)), (0.25, mean_share(40.0, 20.0, 80, each))]
    found = weighted_mean(parts, 0.95)
    assert (0.875, 160) == (found.value, found.trials)
    assert 0.75 * parts[0][1].low + 0.25 * parts[1][1].low == pytest.approx(found.low)


@pytest.mark.parametrize(("share", "trials"), [(0.5, 10), (0.95, 100), (0.99, 100), (0.5, 1)])
def test_ranks_hold_a_quantile_as_often_as_they_say(share: float, trials: int) -> None:
    """The number of values below the quantile is binomial, whatever the distribution; a missing rank is beyond all values."""
    ranks = quantile_ranks(share, trials, 0.95)
    low, high = ranks.low or 0, math.inf if ranks.high is None else ranks.high
    held = sum(binom.pmf(below, trials, share) for below in range(trials + 1) if low <= below < high)
    assert held >= 0.95
    assert 1 <= ranks.at <= trials
    if share == 0.99:
        assert ranks.high is None  # a hundred values do not bound their 99 % quantile from above
