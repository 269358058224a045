"""Errors of a map that are correlated along the line."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.simulation.physics.map_errors import REFLECTORS, Survey, figures_of_survey, map_error
from safeloc.simulation.vehicle_seed import VehicleSeed

PLACES = np.array([0.0, 40_000.0, 100_000.0, 150_000.0, 2_000_000.0])


def test_without_a_walk_all_places_err_alike() -> None:
    """By the offset; of a vehicle's own errors nothing is said here."""
    assert [-700.0] * 5 == map_error(VehicleSeed(1), -700, 0, 0.2, 2_000_000).at(PLACES).tolist()


def test_a_longer_line_begins_alike_and_the_walk_begins_at_the_offset() -> None:
    """Between the nodes it runs straight; every vehicle has another map."""
    near, far, other = (
        map_error(VehicleSeed(seed), 50, 300, 0.9, end) for seed, end in ((1, 200_000), (1, 2_000_000), (2, 200_000))
    )
    assert np.array_equal(near.at(PLACES[:4]), far.at(PLACES[:4]))
    found = far.at(PLACES).tolist()
    assert 50 == found[0]
    assert found[0] + 0.4 * (found[2] - found[0]) == pytest.approx(found[1])
    assert near.at(PLACES[2:3]) != other.at(PLACES[2:3])


def test_the_walk_gathers_as_the_root_of_the_way() -> None:
    """Deviation 300 mm after 1 km and 600 after 4; the first half is all that the errors at 1 km and 4 km share."""
    ends = np.array(
        [map_error(VehicleSeed(7, (one,)), 0, 300, 0.9, 4_000_000).at(np.array([1e6, 4e6])) for one in range(4_000)]
    )
    bound = 6 / (2 * 4_000) ** 0.5
    assert [300, 600] == pytest.approx(ends.std(axis=0).tolist(), rel=bound)
    shared = np.mean(ends[:, 0] * ends[:, 1]) / (ends.std(axis=0).prod())
    assert 0.5 == pytest.approx(float(shared), abs=6 / 4_000**0.5)


def surveyed(vehicles: int, common: float, walk_mm: float, own_mm: float) -> Survey:
    """The survey of reflectors on maps that err by 1 m."""
    seeds = [VehicleSeed(9, (one,)) for one in range(vehicles)]
    figures = {
        f"{REFLECTORS}_map_{name}": np.full(vehicles, value)
        for name, value in (("common", common), ("walk_mm", walk_mm), ("own_mm", own_mm))
    }
    return Survey(REFLECTORS, figures, seeds, [map_error(seed, 1_000, 0, 0.9, 4_000_000) for seed in seeds])


def test_by_default_reflectors_stand_where_the_map_has_them() -> None:
    """Whatever the map's own error is."""
    assert [0, 0, 0] == [one.default for one in figures_of_survey(REFLECTORS).values()]
    found = surveyed(3, 0, 0, 0)
    assert not found.errs.any() and not found.errors_mm([10, 20]).any()


def test_what_was_surveyed_with_the_balises_errs_with_them() -> None:
    """By the share that they have in common."""
    found = surveyed(2, 0.6, 0, 0)
    assert found.errs.all()
    assert [[600, 600]] * 3 == found.errors_mm([0, 250_000, 4_000_000]).tolist()


def test_a_survey_of_its_own_gathers_and_each_errs_by_itself() -> None:
    """Deviation 300 mm after 1 km; neighbours share the walk, not their own errors, which are uniform."""
    walk = surveyed(4_000, 0, 300, 0).errors_mm([1_000_000, 1_000_100])
    assert 300 == pytest.approx(float(walk[0].std()), rel=6 / (2 * 4_000) ** 0.5)
    assert np.abs(walk[1] - walk[0]).max() < 1
    own = surveyed(4_000, 0, 0, 300).errors_mm([1_000_000, 1_000_100])
    assert np.abs(own).max() <= 300
    assert 300 / 3**0.5 == pytest.approx(float(own[0].std()), rel=0.05)
    assert 0 == pytest.approx(float(np.mean(own[0] * own[1])) / 30_000, abs=6 / 4_000**0.5)
