"""The law of motion that the prediction's bounds follow from, over the rationals: what bounded jerk has to do with it."""

from __future__ import annotations

import pytest
import z3

PERIODS_S = [z3.Q(1, 5), z3.Q(1, 1), z3.Q(2, 1)]
ACCELERATION, JERK = z3.Q(3, 2), z3.Q(8, 10)


def _refuted(given: list[z3.BoolRef], goal: z3.BoolRef) -> z3.CheckSatResult:
    solver = z3.Solver()
    solver.add(*given, z3.Not(goal))
    return solver.check()


def _within(term: z3.ArithRef, bound: z3.ArithRef) -> z3.BoolRef:
    return z3.And(term <= bound, -term <= bound)


@pytest.mark.parametrize("period", PERIODS_S, ids=str)
def test_bounded_jerk_keeps_the_acceleration_law(period: z3.RatNumRef) -> None:
    """Acceleration within A at both ends of a cycle, changing evenly: the way is v T up to A T2/2, the speed up to A T."""
    start, jerk = z3.Reals("acceleration jerk")
    given = [_within(start, ACCELERATION), _within(start + jerk * period, ACCELERATION), _within(jerk, JERK)]
    way = start * period * period / 2 + jerk * period * period * period / 6
    assert z3.unsat == _refuted(given, _within(way, ACCELERATION * period * period / 2))
    assert z3.unsat == _refuted(given, _within(start * period + jerk * period * period / 2, ACCELERATION * period))
    assert z3.sat == _refuted(given[:1], _within(way, ACCELERATION * period * period / 2))


@pytest.mark.parametrize("period", PERIODS_S, ids=str)
def test_with_the_acceleration_known_jerk_bounds_the_prediction(period: z3.RatNumRef) -> None:
    """At constant acceleration from a true state the way is off by J T3/6 at most, the speed by J T2/2; and no less will do."""
    jerk = z3.Real("jerk")
    given = [_within(jerk, JERK)]
    off, off_speed = jerk * period * period * period / 6, jerk * period * period / 2
    most, most_speed = JERK * period * period * period / 6, JERK * period * period / 2
    assert z3.unsat == _refuted(given, z3.And(_within(off, most), _within(off_speed, most_speed)))
    assert z3.sat == _refuted(given, _within(off, most * z3.Q(99, 100)))


@pytest.mark.parametrize("period", PERIODS_S, ids=str)
def test_predictor_and_train_may_accelerate_against_each_other(period: z3.RatNumRef) -> None:
    """Both within A: the way is off by A T2, the speed by 2 A T; A T2 / 2 would be too little."""
    true, guessed = z3.Reals("true guessed")
    given = [_within(true, ACCELERATION), _within(guessed, ACCELERATION)]
    off = (true - guessed) * period * period / 2
    assert z3.unsat == _refuted(given, _within(off, ACCELERATION * period * period))
    assert z3.unsat == _refuted(given, _within((true - guessed) * period, 2 * ACCELERATION * period))
    assert z3.sat == _refuted(given, _within(off, ACCELERATION * period * period / 2))
