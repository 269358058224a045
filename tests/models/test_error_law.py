"""The error law of a distance-measuring unit: what one cycle adds, in figures on both sides of the knee."""

from __future__ import annotations

import pytest

from safeloc.language.expr import as_num
from safeloc.language.interpret import evaluate
from safeloc.language.units import MM, MS
from safeloc.models.vocabulary.error_law import ACCELEROMETER, OPTICAL, RADAR, WHEEL, ErrorLaw

PERIOD_MS = 100


@pytest.mark.parametrize(
    ("law", "distance_mm", "age_ms", "added_nm"),
    [
        (WHEEL, 0, 0, 0),
        (WHEEL, 1_000, 60_000, 50_000_000),  # 5 %, however long ago the reference is
        (RADAR, 0, 0, 55_600_000),  # 2 km/h in a tenth of a second
        (RADAR, 833, 0, 55_600_000),  # 30 km/h is 833.3 mm in a cycle: whole millimetres above 833 count
        (RADAR, 834, 0, 55_621_277),
        (RADAR, 1_833, 0, 76_877_000),
        (ACCELEROMETER, 0, 0, 2_000_000),
        (ACCELEROMETER, 0, 2_000, 3_000_000),
        (ACCELEROMETER, 1_000, 2_000, 4_000_000),
        (OPTICAL, 100, 0, 6_000_000),
    ],
)
def test_what_a_cycle_adds(law: ErrorLaw, distance_mm: int, age_ms: int, added_nm: int) -> None:
    """Rate above the knee, floor and drift add up, in whole nanometres."""
    assert [added_nm] == evaluate([law.growth_nm(as_num(distance_mm, MM), as_num(age_ms, MS), PERIOD_MS)], {})


def test_the_constant_wanders_half_to_either_side() -> None:
    """SUBSET-041: 5 m for a wheel."""
    assert 2_500_000_000 == WHEEL.wander_nm


def test_a_share_of_a_cycle_is_rounded_up() -> None:
    """A third of 50 000 ppm is 16 667 ppm, a third of 556 mm/s is 186 mm/s; drift has no share."""
    assert (16_667, 0) == (WHEEL.portion(333_334).rate_ppm, WHEEL.portion(333_334).floor_mm_s)
    assert 186 == RADAR.portion(333_334).floor_mm_s
    assert 0 == ACCELEROMETER.portion(333_334).drift_mm_s2
