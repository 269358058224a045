"""The rail's adhesion along a line."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.simulation.physics.rail import at_speed, rail_of
from safeloc.simulation.vehicle_seed import VehicleSeed

SEEDS = [VehicleSeed(1, (number,)) for number in range(3)]


def drawn(end_mm: int, seeds: list[VehicleSeed] = SEEDS, spread: float = 0.5) -> np.ndarray:
    """Adhesion of sections of rails of three medians."""
    medians = np.array([0.3, 0.1, 0.05])[: len(seeds)]
    return rail_of(seeds, medians, np.full(len(seeds), spread), np.full(len(seeds), 200_000.0), -50_000, end_mm).values


def test_adhesion_falls_with_speed_as_measured() -> None:
    """[S] Curtius and Kniffler: 0.331 at standstill, 0.198 at 160 km/h, 0.183 at 300."""
    found = at_speed(np.array([0.0, 160 / 0.0036, -300 / 0.0036])) * 0.331
    assert [0.331, 0.198, 0.183] == pytest.approx(found.tolist(), abs=6e-4)


def test_a_longer_rail_begins_with_the_shorter_one_and_a_vehicle_has_its_own() -> None:
    """Bit by bit, whatever the line ahead and the vehicles beside."""
    near, far = drawn(1_000_000), drawn(9_000_000)
    assert (42, 362) == (len(near), len(far))
    assert np.array_equal(near, far[:42])
    assert np.array_equal(near[:, :1], drawn(1_000_000, SEEDS[:1]))
    assert len({tuple(column) for column in near.T}) == 3


def test_without_a_spread_every_section_is_the_median() -> None:
    """And no section exceeds what any rail has."""
    assert drawn(1_000_000, spread=0.0).tolist() == [[0.3, 0.1, 0.05]] * 42
    assert drawn(9_000_000, spread=3.0).max() == 0.6


def test_sections_are_correlated_along_the_line() -> None:
    """Neighbours of 25 m on a length of 200 m: the logarithms correlate by exp(-1/8), within six deviations of 40 000 values."""
    rail = rail_of(SEEDS[:1], np.array([0.01]), np.array([0.5]), np.array([200_000.0]), 0, 40_000 * 25_000)
    logs = np.log(rail.values[:, 0] / 0.01) / 0.5
    assert np.exp(-1 / 8) == pytest.approx(float(np.mean(logs[1:] * logs[:-1])), abs=6 * (2 * 8 / 40_000) ** 0.5)


def test_a_place_has_the_adhesion_of_its_section() -> None:
    """Beyond either end it is that of the end; a wheel farther back meets later what the first one met."""
    rail = rail_of(SEEDS[:1], np.array([0.3]), np.array([0.5]), np.array([0.0]), -50_000, 100_000)
    places = np.array([[-99_000], [-50_000], [-25_001], [0], [99_999], [900_000]]) * 1_000_000
    own = rail.values[:, 0].tolist()
    assert [own[0], own[0], own[0], own[2], own[5], own[5]] == rail.at(places)[:, 0].tolist()
