"""The fit along the track, and its protection level checked by a solver over the rationals."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest
import z3

from safeloc.errors import InputError
from safeloc.sensing.satellite.track_fit import Sight, TrackFit, fit

SLOPES = {"G05": -350_000, "G13": 120_000, "G15": 480_000, "G20": -610_000, "G29": 900_000}
MIXED = {"G01": -400_000, "G02": 300_000, "E01": 700_000, "E02": -100_000}
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
    assert [2_000_000, 777, 0, 3] == [found.along, found.clocks["G"], found.chi_square, found.degrees_of_freedom]


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


def test_the_dilution_is_the_level_of_a_unit() -> None:
    """What errors of 1 m in each satellite make of the position, exactly: at least 1 m, as no slope is steeper than 1."""
    found = _fit({})
    assert found.protection_level(1_000_000) == math.ceil(found.dilution * 1_000_000)
    assert found.dilution >= 1


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


def _by_fractions(sights: dict[str, Sight]) -> list[Fraction]:
    """Along, across and clock by elimination over the rationals, written the plain way."""
    rows = [
        ([Fraction(c, 10**6) for c in (one.slope_ppm, *one.across_ppm)] + [Fraction(1)], one) for one in sights.values()
    ]
    size = len(rows[0][0])
    matrix = [
        [sum((one.weight * row[i] * row[j] for row, one in rows), Fraction(0)) for j in range(size)]
        + [sum((one.weight * row[i] * one.difference for row, one in rows), Fraction(0))]
        for i in range(size)
    ]
    for at in range(size):
        matrix[at] = [value / matrix[at][at] for value in matrix[at]]
        for n in range(size):
            if n != at:
                matrix[n] = [a - matrix[n][at] * b for a, b in zip(matrix[n], matrix[at], strict=True)]
    return [row[size] for row in matrix]


@pytest.mark.parametrize("across", [0, 2])
@pytest.mark.parametrize("seed", range(5))
def test_the_solution_is_the_exact_one(across: int, seed: int) -> None:
    """Along the track and free of it: what plain elimination over the rationals gives, to the last digit."""
    draw = random.Random(seed)
    sights = {
        f"G{n:02d}": Sight(
            draw.randint(-20_000, 20_000),
            draw.randint(-950_000, 950_000),
            Fraction(draw.randint(1, 9), draw.randint(1, 9)),
            tuple(draw.randint(-950_000, 950_000) for _ in range(across)),
        )
        for n in range(7)
    }
    found, plain = fit(sights), _by_fractions(sights)
    assert [plain[0], plain[-1], across + 2] == [found.along, found.clocks["G"], found.unknowns]
    assert found.along == sum(found.shares[name] * one.difference for name, one in sights.items())


def test_two_constellations_have_a_clock_each() -> None:
    """A bias between their clocks does not move the position; it costs one unknown, and so one satellite."""
    apart = {name: Sight(one * 2 + (5_000 if name[0] == "E" else 0), one, clock=name[0]) for name, one in MIXED.items()}
    found = fit(apart)
    assert [2_000_000, 0, 5_000, 3] == [found.along, found.clocks["G"], found.clocks["E"], found.unknowns]
    with pytest.raises(InputError, match="2 usable satellites for 3 unknowns"):
        fit({name: apart[name] for name in ("G01", "E01")})


def test_bounds_may_differ() -> None:
    """Each satellite's own bound counts with its share; one that is missing is refused."""
    found = _fit({})
    apart = {name: 1_000 * (n + 1) for n, name in enumerate(found.shares)}
    exact = sum((abs(share) * apart[name] for name, share in found.shares.items()), Fraction(0))
    assert found.protection_level(apart) - 1 < exact <= found.protection_level(apart)
    with pytest.raises(InputError, match="G05 is missing"):
        found.protection_level({name: 1 for name in found.shares if name != "G05"})
