"""Estimates with intervals that hold for every number of runs: no normal approximation.

The independent trials are vehicles. Cycles of one vehicle depend on each other, so no interval here counts cycles as trials.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from scipy.special import bdtr, betaincinv


@dataclass(frozen=True)
class Estimate:
    """A figure with the interval that holds it with at least this confidence.

    trials    the number of vehicles it rests on
    one_sided the upper bound alone with the same confidence; None where only the interval is given
    method    how the interval was made
    """

    value: float
    low: float
    high: float
    confidence: float
    trials: int
    method: str
    one_sided: float | None = None


@dataclass(frozen=True)
class Part:
    """A stratum: its weight in the whole, and of its vehicles those with the event."""

    weight: float
    events: int
    trials: int


def proportion(events: int, trials: int, confidence: float) -> Estimate:
    """Return the share of vehicles with an event, with the exact binomial (Clopper-Pearson) interval. ValueError without a trial."""
    if not 0 <= events <= trials or trials < 1:
        raise ValueError(f"{events} events in {trials} trials: there must be trials, and no more events.")
    outside = 1 - confidence
    low, high = _lower(events, trials, outside / 2), _upper(events, trials, outside / 2)
    return Estimate(
        events / trials,
        low,
        high,
        confidence,
        trials,
        "exact binomial (Clopper-Pearson)",
        _upper(events, trials, outside),
    )


def _lower(events: int, trials: int, outside: float) -> float:
    return 0.0 if events == 0 else float(betaincinv(events, trials - events + 1, outside))


def _upper(events: int, trials: int, outside: float) -> float:
    return 1.0 if events == trials else float(betaincinv(events + 1, trials - events, 1 - outside))


def rule_of_three(trials: int, confidence: float) -> str:
    """Return what no event in so many trials says: `0 of n: below 3.0/n at 95 %`."""
    bound = _upper(0, trials, 1 - confidence) * trials
    return f"0 of {trials}: below {bound:.1f}/{trials} = {bound / trials:.2g} at {confidence * 100:g} %"


def stratified(parts: Sequence[Part], confidence: float) -> Estimate:
    """Return the share in the whole: the weighted sum of the strata, whose exact intervals hold all at once (Bonferroni).

    The interval is wider than an approximate one, and holds for every number of trials. ValueError for a stratum of weight without
    a trial.
    """
    weighed = [part for part in parts if part.weight > 0]
    each = 1 - (1 - confidence) / max(1, len(weighed))
    found = [(part.weight, proportion(part.events, part.trials, each)) for part in weighed]
    value, low, high = (sum(weight * getattr(one, name) for weight, one in found) for name in ("value", "low", "high"))
    one_sided = sum(weight * (one.one_sided or 0.0) for weight, one in found)
    trials = sum(part.trials for part in weighed)
    method = f"weighted sum of {len(weighed)} strata, exact binomial intervals that hold all at once (Bonferroni)"
    return Estimate(value, low, high, confidence, trials, method, one_sided)


def mean_share(total: float, squares: float, trials: int, confidence: float) -> Estimate:
    """Return the mean of one share (0 to 1) of each vehicle, with the empirical Bernstein interval of Maurer and Pontil.

    total, squares  the sum of the shares, and of their squares. ValueError without a trial
    """
    if trials < 1:
        raise ValueError("no trial: there is nothing to take the mean of.")
    mean = total / trials
    if trials == 1:
        return Estimate(mean, 0.0, 1.0, confidence, 1, "one vehicle alone")
    variance = max(0.0, (squares - trials * mean**2) / (trials - 1))
    tail = math.log(4 / (1 - confidence))
    room = math.sqrt(2 * variance * tail / trials) + 7 * tail / (3 * (trials - 1))
    return Estimate(mean, max(0.0, mean - room), min(1.0, mean + room), confidence, trials, "empirical Bernstein")


def tilted_share(total: float, squares: float, trials: int, greatest: float, confidence: float) -> Estimate:
    """Return the mean of weights (0 to `greatest`) of vehicles with an event, or of weights times shares: importance sampling.

    total, squares  the sum over vehicles, and of the squares. The interval holds for every number of vehicles (empirical Bernstein).
    """
    one = mean_share(total / greatest, squares / greatest**2, trials, confidence)
    value, low, high = (part * greatest for part in (one.value, one.low, one.high))
    return Estimate(value, low, min(1.0, high), confidence, trials, f"importance sampling, {one.method}")


def weighted_mean(parts: Sequence[tuple[float, Estimate]], confidence: float) -> Estimate:
    """Return the weighted sum of estimates; each must hold with `shared_confidence`, so that all hold at once."""
    weighed = [(weight, one) for weight, one in parts if weight > 0]
    value, low, high = (
        sum(weight * getattr(one, name) for weight, one in weighed) for name in ("value", "low", "high")
    )
    kinds = " and ".join(dict.fromkeys(one.method for _, one in weighed))
    method = f"weighted sum of {len(weighed)} strata, intervals that hold all at once (Bonferroni): {kinds}"
    return Estimate(value, low, high, confidence, sum(one.trials for _, one in weighed), method)


def shared_confidence(confidence: float, strata: int) -> float:
    """Return the confidence that each of several intervals needs, so that all hold at once with `confidence`."""
    return 1 - (1 - confidence) / max(1, strata)


@dataclass(frozen=True)
class Ranks:
    """Ranks, from 1, in the sorted values: that of a quantile, and those between which it lies; None: beyond all values."""

    at: int
    low: int | None
    high: int | None


def quantile_ranks(share: float, trials: int, confidence: float) -> Ranks:
    """Return the ranks of a quantile's interval, which holds for every distribution (order statistics)."""
    if trials < 1:
        raise ValueError("no trial: there is no quantile.")
    outside = (1 - confidence) / 2
    low = _last(lambda rank: bdtr(rank - 1, trials, share) <= outside, trials)
    high = _last(lambda rank: bdtr(rank - 1, trials, share) < 1 - outside, trials) + 1
    return Ranks(max(1, math.ceil(share * trials)), low or None, high if high <= trials else None)


def _last(holds: object, trials: int) -> int:
    """Return the last rank from 1 on at which a condition holds that holds up to some rank; 0 if it never does."""
    assert callable(holds)
    low, high = 0, trials
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if holds(middle) else (low, middle - 1)
    return low
