"""Distances of units that over-read and under-read by different rates, corrected: the symmetric law that is left of them is proved."""

from __future__ import annotations

import pytest

from safeloc.language.interpret import run
from safeloc.language.system import lower
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.reading_rates import ReadingRates
from tests.models.edited_terms import keeps
from tests.theorems.odometry.corrected_distance import corrected_distance, lawful, one_off

UNIT = ErrorLaw(kind="wheel", constant_mm=0, rate_ppm=0)
PERIOD_MS = 100
RATES = [
    ReadingRates(under_ppm=under, over_ppm=over)
    for under, over in (
        (100_000, 20_000),
        (20_000, 100_000),
        (100_000, 0),
        (0, 100_000),
        (50_001, 50_000),
        (1, 900_000),
    )
]
"""Pairs in which either side is the greater, or alone, or hardly greater."""


@pytest.mark.parametrize("rates", RATES, ids=lambda rates: f"{rates.under_ppm} and {rates.over_ppm}")
def test_both_figures_count_and_may_not_be_exchanged(rates: ReadingRates) -> None:
    """Proved for every distance; with the two rates exchanged in the correction it is not, nor with none, nor with a law less by a tenth."""
    law = rates.law(UNIT, PERIOD_MS)
    difference = rates.under_ppm - rates.over_ppm
    made = corrected_distance(rates)
    claims = [lawful(made, law, PERIOD_MS), one_off(made, law)]
    assert all(keeps((made.machine, claims), one.name) for one in claims)
    for wrong in (-difference, 0) if abs(difference) > 1 else ():
        other = corrected_distance(rates, shift_ppm=wrong)
        claim = lawful(other, law, PERIOD_MS)
        assert not keeps((other.machine, [claim]), claim.name), wrong
    tight = lawful(made, law.model_copy(update={"rate_ppm": law.rate_ppm * 9 // 10}), PERIOD_MS)
    assert not keeps((made.machine, [tight]), tight.name)


@pytest.mark.parametrize("rates", RATES, ids=lambda rates: f"{rates.under_ppm} and {rates.over_ppm}")
def test_the_machine_is_the_correction(rates: ReadingRates) -> None:
    """Step by step the same whole mm as the code that hosts call."""
    measured = [3, -7, 1_000, 1_001, -999, 0, 25, 25, 25, -25, 4_444, 1, 1, 1]
    correction, system = rates.correction(), lower(corrected_distance(rates).machine)
    steps = [{"measured_mm": one, "true_run_nm": one * 1_000_000} for one in measured]
    trace = run(system, steps)
    assert [correction.distance_mm(one) for one in measured] == [step.outputs["corrected_mm"] for step in trace.steps]
