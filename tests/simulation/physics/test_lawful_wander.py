"""A law counts as broken exactly where no one-off error explains what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from safeloc.models.vocabulary.error_law import RADAR, ErrorLaw
from safeloc.simulation.physics.lawful_wander import can_be_run, growth_nm, lawful_wander

NM = 1_000_000
LAW = ErrorLaw(kind="wheel", constant_mm=4, rate_ppm=500_000)
"""One-off errors from -2 to 2 mm, and half of what is measured."""


@dataclass(frozen=True)
class Limits:
    """Limits of a vehicle that runs up to 100 mm in a cycle."""

    farthest_mm: int = 100
    change_mm: int = 10
    gap_limit_cycles: int = 2


def explained(true: list[int], told: list[int]) -> bool:
    """Whether a whole wander explains the run, by trying all of them; all figures in half mm."""
    for path in product(range(-4, 5), repeat=len(true)):
        before = (0, *path[:-1])
        errors = [2 * (a - b) - (now - was) for a, b, now, was in zip(true, told, path, before, strict=True)]
        if all(abs(error) <= abs(one) for error, one in zip(errors, told, strict=True)):
            return True
    return False


@given(st.lists(st.tuples(st.integers(-5, 5), st.integers(-3, 3)), min_size=1, max_size=4))
def test_a_law_is_broken_where_no_wander_explains_the_run(run: list[tuple[int, int]]) -> None:
    """As trying all wanders finds it; a wander that is found is within the law."""
    true, told = ([one[which] for one in run] for which in (0, 1))
    exact = np.array(true)[:, None] * NM
    measured = np.array(told)[:, None]
    wander, broken = lawful_wander(exact, measured, np.ones(exact.shape, dtype=np.bool_), LAW, 100)
    assert explained(true, told) != bool(broken.any())
    assert np.abs(wander).max() <= 2 * NM
    errors = exact - measured * NM - np.diff(wander, axis=0, prepend=0)
    assert (np.abs(errors) <= growth_nm(LAW, measured, 100))[~broken].all()


def test_a_breach_breaks_one_cycle() -> None:
    """9 mm unseen once: afterwards the law goes on from the end that is nearest."""
    true = np.array([0, 9, 0, 0])[:, None] * NM
    wander, broken = lawful_wander(true, np.zeros((4, 1), dtype=np.int64), np.ones((4, 1), dtype=np.bool_), LAW, 100)
    assert [False, True, False, False] == broken[:, 0].tolist()
    assert [2 * NM] * 3 == wander[1:, 0].tolist()


def test_a_distance_that_counts_for_nothing_moves_no_wander() -> None:
    """Whatever the vehicle ran meanwhile."""
    counts = np.array([[True], [False], [True]])
    true = np.array([[1], [700], [0]]) * NM
    wander, broken = lawful_wander(true, np.array([[0], [50], [0]]), counts, LAW, 100)
    assert not broken.any()
    assert [NM] * 3 == wander[:, 0].tolist()


def test_the_radars_law_adds_its_floor_and_counts_from_its_knee() -> None:
    """556 mm/s over 100 ms, and 2.1 % of what is measured above 833.3 mm."""
    told = np.array([[0], [833], [-1_833]])
    assert [55_600_000, 55_600_000, 55_600_000 + 999_700 * 21_277 // 1_000] == growth_nm(RADAR, told, 100)[
        :, 0
    ].tolist()


def test_distances_that_a_vehicle_can_have_run() -> None:
    """Not too far, and not too far from the last one that counted, while that is remembered; the first one counts."""
    told = np.array([90, 101, 79, 80, 0, 60, 50, 0, 0, 0, 0])[:, None]
    present = np.ones(told.shape, dtype=np.bool_)
    present[[4, 8]] = False
    expected = [True, False, True, True, False, True, True, False, False, False, True]
    assert expected == can_be_run(told, present, Limits())[:, 0].tolist()
