"""The fit along the track, and its protection level checked by a solver over the rationals."""

from __future__ import annotations

from fractions import Fraction

import pytest
import z3

from safeloc.errors import InputError
from safeloc.signals.satellite.track_fit import Sight, TrackFit, fit

SLOPES = {"G05": -350_000, "G13": 120_000, "G15": 480_000, "G20": -610_000, "G29": 900_000}
WEIGHTS = {"G05": 1, "G13": 2, "G15": 1, "G20": 3, "G29": 1}


def _fit(errors_mm: dict[str, int], along_mm: int = 2_000_000, clock_mm: int = 777) -> TrackFit:
    return fit(
        {
            name: Sight(slope * along_mm // 10**6 + clock_mm + errors_mm.get(name, 0), slope, Fraction(WEIGHTS[name]))
            for name, slope in SLOPES.items()
        }
    )


def test_without_errors_the_truth_comes_back() -> None:
    """Position and clock are exact, and nothing is left over."""
    found = _fit({})
    assert (2_000_000, 777, 0, 3) == (found.along, found.clock, found.chi_square, found.degrees_of_freedom)


def _error_beyond(found: TrackFit, level: Fraction, threshold: int) -> z3.CheckSatResult:
    solver = z3.Solver()
    errors = {name: z3.Real(name) for name in found.shares}
    solver.add(*(z3.And(one <= threshold, one >= -threshold) for one in errors.values()))
    total = z3.Sum(*(z3.Q(a.numerator, a.denominator) * errors[name] for name, a in found.shares.items()))
    bound = z3.Q(level.numerator, level.denominator)
    solver.add(z3.Or(total > bound, total < -bound))
    return solver.check()


def test_the_protection_level_holds_exactly() -> None:
    """No errors within the threshold lead beyond it (z3, rationals); one millimetre less does not hold."""
    found, threshold = _fit({}), 5_000
    level = found.protection_level(threshold)
    assert z3.unsat == _error_beyond(found, Fraction(level), threshold)
    assert z3.sat == _error_beyond(found, Fraction(level - 1), threshold)


def test_a_fault_shows_in_chi_square_and_stays_within_its_share() -> None:
    """10 m on one satellite moves the position by exactly its share, and the statistic away from zero."""
    found = _fit({"G13": 10_000})
    assert found.along == 2_000_000 + found.shares["G13"] * 10_000
    assert found.chi_square > 0


def test_what_cannot_be_solved_is_no_fix() -> None:
    """One satellite; satellites that stand alike; no weight; a negative threshold."""
    with pytest.raises(InputError, match="2 are needed"):
        fit({"G01": Sight(0, 1)})
    with pytest.raises(InputError, match="alike"):
        fit({"G01": Sight(0, 5), "G02": Sight(9, 5)})
    with pytest.raises(InputError, match="positive"):
        fit({"G01": Sight(0, 5, Fraction(0)), "G02": Sight(9, 6)})
    with pytest.raises(InputError, match="negative"):
        _fit({}).protection_level(-1)
