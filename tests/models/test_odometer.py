"""The odometer that several machines share: a distance is used only if the vehicle can have run it; figures at the border."""

from __future__ import annotations

import pytest

from safeloc.language.expr import Lit, Var
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Value
from safeloc.models.vocabulary.error_law import WHEEL
from safeloc.models.vocabulary.measured import ADMITTED, JUMP, MISSING, TOO_FAST, Limits
from safeloc.models.vocabulary.odometer import odometer

LIMITS = Limits(
    period_ms=100, tolerance_mm=10_000, max_speed_mm_s=50_000, max_cycle_distance_mm=5_100, max_cycle_distance_change_mm=53, gap_limit=5,
    lone_limit=5, age_limit_ms=60_000, position_limit_mm=1_000_000, single_fault_safe=False,
)  # fmt: skip


@pytest.mark.parametrize(
    ("distance_mm", "last_mm", "gap_cycles", "verdict"),
    [
        (None, 100, 0, MISSING),
        (153, 100, 0, ADMITTED),  # changed by 53 mm in one cycle
        (154, 100, 0, JUMP),
        (47, 100, 0, ADMITTED),
        (46, 100, 0, JUMP),
        (206, 100, 1, ADMITTED),  # by 106 mm in two cycles, since one distance was missing
        (207, 100, 1, JUMP),
        (418, 100, 5, ADMITTED),
        (419, 100, 5, JUMP),
        (419, 100, 6, ADMITTED),  # the last distance is too old to be compared with
        (5_100, 5_100, 0, ADMITTED),
        (5_101, 5_100, 0, TOO_FAST),
        (-5_101, -5_100, 0, TOO_FAST),
    ],
)
def test_what_the_vehicle_can_have_run(distance_mm: int | None, last_mm: int, gap_cycles: int, verdict: Lit) -> None:
    """The greatest distance, and the greatest change for each cycle since the last distance, count as possible; 1 mm more does not."""
    one = odometer(WHEEL, LIMITS)
    values: dict[Var, Value] = {
        one.measured.present: distance_mm is not None, one.measured.value: distance_mm or 0, one.last: last_mm, one.gap: gap_cycles
    }  # fmt: skip
    assert [verdict.value] == evaluate([one.verdict], values)
