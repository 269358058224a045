"""Reflected signals: correlated in time, and between satellites in similar directions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safeloc.simulation.physics.multipath import (
    COMMON,
    DEVIATION,
    DIRECTIONS,
    LASTS,
    RATE,
    SMOOTH,
    WINDOW,
    Reflections,
    reflections,
    shares_of,
)
from safeloc.simulation.vehicle_seed import VehicleSeed

CYCLES, KEPT = 8_000, math.exp(-1 / 5)
BOUND = 6 * math.sqrt(2 * (1 + KEPT**2) / (1 - KEPT**2) / CYCLES)
"""Six deviations of an estimate from so many values of which each keeps so much of the last one."""


def drawn(
    common: float, *, vehicles: int = 1, satellites: int = 5, cycles: int = CYCLES, rate: float = 0, smooth: float = 0
) -> Reflections:
    """Reflections of 3 m that last for 5 cycles."""
    figures = {DEVIATION: 3_000.0, COMMON: common, LASTS: 5.0, RATE: rate, SMOOTH: smooth, WINDOW: 4.0}
    seeds = [VehicleSeed(3, (number,)) for number in range(vehicles)]
    return reflections({name: np.full(vehicles, one) for name, one in figures.items()}, seeds, satellites, cycles)


def alike(one: float, other: float) -> float:
    """The correlation of two directions by theory."""
    return sum(a * b for a, b in zip(shares_of(one), shares_of(other), strict=True))


def test_directions_share_by_how_near_they_are() -> None:
    """Every satellite has deviation 1; one in the same direction the same process, one across nothing of it."""
    for azimuth in (0.0, 0.3, 2.0, 6.2, -0.1):
        assert 1 == pytest.approx(alike(azimuth, azimuth))
        assert 0 == alike(azimuth, azimuth + math.pi)
    turn = 2 * math.pi / DIRECTIONS
    assert math.cos(math.pi / 4) == pytest.approx(alike(0, turn / 2))
    assert [1, 0] == pytest.approx([alike(0, 1e-9), alike(0, turn)], abs=1e-6)


@pytest.mark.parametrize("common", [0.0, 0.5, 1.0])
def test_deviation_and_correlation_are_those_of_theory(common: float) -> None:
    """Between satellites: the common share times what their directions have in common; in time: exp(-1/5) a cycle."""
    found = drawn(common)
    excess, azimuth = found.excess_mm[:, :, 0] / 3_000, found.azimuth[:, 0].tolist()
    for one in range(5):
        assert KEPT == pytest.approx(float(np.mean(excess[one][1:] * excess[one][:-1])), abs=BOUND)
        for other in range(one + 1):
            expected = 1.0 if one == other else common * alike(azimuth[one], azimuth[other])
            assert expected == pytest.approx(float(np.mean(excess[one] * excess[other])), abs=BOUND)


def test_a_vehicle_and_a_satellite_have_their_own() -> None:
    """Bit by bit, whatever vehicles stand beside and satellites come after."""
    all_, one, few = (
        drawn(0.5, vehicles=number, satellites=seen, cycles=50) for number, seen in ((3, 5), (1, 5), (3, 2))
    )
    assert np.array_equal(all_.excess_mm[:, :, :1], one.excess_mm)
    assert np.array_equal(all_.excess_mm[:2], few.excess_mm)
    assert np.array_equal(all_.azimuth[:2], few.azimuth)
    assert 15 == len({tuple(row) for row in all_.excess_mm.transpose(0, 2, 1).reshape(15, 50)})


def test_range_rates_are_the_change_of_the_excess_length() -> None:
    """As much of it as they show, of the first cycle as of the second; by default nothing, and the lengths are the same."""
    plain, half = drawn(0.5, cycles=50), drawn(0.5, cycles=50, rate=0.5)
    assert not plain.changing.any() and half.changing.all()
    assert np.array_equal(plain.excess_mm, half.excess_mm)
    assert np.allclose(np.diff(half.excess_mm, axis=1) / 2, half.change_mm[:, 1:])
    assert np.allclose(half.change_mm[:, 0], half.change_mm[:, 1])


def test_smoothed_lengths_keep_deviation_and_correlation_and_change_steadily() -> None:
    """Deviation 3 m from the first cycle on; between satellites as without; the change as the low pass has it by theory."""
    hold = math.exp(-1 / 20)
    found = drawn(1.0, smooth=20, rate=1)
    excess, azimuth = found.excess_mm[:, :, 0] / 3_000, found.azimuth[:, 0].tolist()
    bound = BOUND * 3
    for other in range(5):
        assert alike(azimuth[0], azimuth[other]) == pytest.approx(float(np.mean(excess[0] * excess[other])), abs=bound)
    variance = (1 - hold) / (1 + hold) * (1 + hold * KEPT) / (1 - hold * KEPT)
    next_ = hold + (1 - hold) * KEPT * ((1 - hold) / (1 - hold * KEPT)) / variance
    assert math.sqrt(2 - 2 * next_) * 3_000 == pytest.approx(float(found.change_mm.std()), rel=0.1)
    many = drawn(0.5, vehicles=400, satellites=1, cycles=2, smooth=20)
    assert [3_000, 3_000] == pytest.approx(many.excess_mm[0].std(axis=1).tolist(), rel=6 / math.sqrt(800))
