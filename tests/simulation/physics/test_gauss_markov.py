"""A Gauss-Markov process is what its formula says, and correlated as theory has it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safeloc.simulation.physics.gauss_markov import gauss_markov, kept


def test_a_lone_impulse_fades_by_what_is_kept() -> None:
    """Of the first value the whole stays, of a later one the share that keeps the deviation at 1; each step keeps 0.6 of it."""
    noise = np.zeros((5, 2))
    noise[0, 0], noise[1, 1] = 1.0, 1.0
    found = gauss_markov(noise, np.array([0.6, 0.6]))
    assert [1, 0.6, 0.36, 0.216, 0.1296] == pytest.approx(found[:, 0].tolist())
    assert [0, 0.8, 0.48, 0.288, 0.1728] == pytest.approx(found[:, 1].tolist())


def test_what_is_kept_over_a_step() -> None:
    """exp(-step / length); nothing without a correlation."""
    assert [math.exp(-0.5), 0.0] == kept(2.0, [4.0, 0.0]).tolist()


@pytest.mark.parametrize("length", [0.0, 5.0, 40.0])
def test_the_correlation_of_drawn_errors_is_that_of_theory(length: float) -> None:
    """Deviation 1 and correlation exp(-lag / length), within six deviations of an estimate from so many values."""
    number, keep = 50_000, kept(1, [length])
    found = gauss_markov(np.random.default_rng(1).standard_normal((number, 1)), keep)[:, 0]
    longest = (1 + keep[0] ** 2) / (
        1 - keep[0] ** 2
    )  # values that count as one, for squares and products of the process
    bound = 6 * math.sqrt(2 * longest / number)
    for lag in (0, 1, 10):
        expected = keep[0] ** lag if lag else 1.0
        assert expected == pytest.approx(float(np.mean(found[lag:] * found[: number - lag])), abs=bound)
