"""The receiver's clock: a median, and where it breaks down."""

from __future__ import annotations

import math

import pytest
import z3

from safeloc.errors import InputError
from safeloc.sensing.satellite.clock import common_part, without_clock


def test_fewer_than_half_faulty_stay_visible() -> None:
    """Two of five far off: the healthy three keep their small differences, the faulty ones keep their fault."""
    rest = without_clock({"G01": 100.0, "G02": 101.0, "G03": 99.0, "G04": 9_100.0, "G05": 9_200.0})
    assert max(abs(rest[name]) for name in ("G01", "G02", "G03")) <= 2
    assert min(abs(rest[name]) for name in ("G04", "G05")) > 8_900


def test_a_faulty_majority_breaks_it() -> None:
    """Three of five off together look healthy: the stated assumption, shown."""
    assert common_part({"a": 0.0, "b": 1.0, "c": 9_000.0, "d": 9_000.0, "e": 9_000.0}) == 9_000


def test_what_cannot_be_averaged_is_refused() -> None:
    """No satellite, and a value that is not finite."""
    with pytest.raises(InputError, match="no satellite"):
        common_part({})
    with pytest.raises(InputError, match="G07"):
        common_part({"G07": math.nan, "G08": 1.0})


def test_each_constellation_has_its_own_clock() -> None:
    """Two time scales half a kilometre apart: both are taken off, and a fault in one shows in it."""
    rest = without_clock({"G01": 1.0, "G02": 2.0, "G03": 3.0, "E01": 501.0, "E02": 502.0, "E03": 603.0})
    assert {"G01": -1.0, "G02": 0.0, "G03": 1.0, "E01": -1.0, "E02": 0.0, "E03": 101.0} == rest


@pytest.mark.parametrize("count", [3, 4, 7, 8])
def test_the_breakdown_point_is_proved(count: int) -> None:
    """z3: with fewer than half disturbed, however much, the middle lies within the extremes of the healthy; with half not."""
    assert z3.unsat == _middle_outside(count, (count - 1) // 2)
    assert z3.sat == _middle_outside(count, (count + 1) // 2)


def _middle_outside(count: int, disturbed: int) -> z3.CheckSatResult:
    """Whether a middle value can lie beyond every healthy one: half or more of all values on either side of it."""
    values = [z3.Real(f"value_{n}") for n in range(count)]
    bad = [z3.Bool(f"disturbed_{n}") for n in range(count)]
    middle, solver = z3.Real("middle"), z3.Solver()
    solver.add(z3.PbLe([(one, 1) for one in bad], disturbed))
    solver.add(z3.PbGe([(one <= middle, 1) for one in values], (count + 1) // 2))
    solver.add(z3.PbGe([(one >= middle, 1) for one in values], (count + 1) // 2))
    above = z3.And([z3.Or(b, value > middle) for b, value in zip(bad, values, strict=True)])
    below = z3.And([z3.Or(b, value < middle) for b, value in zip(bad, values, strict=True)])
    solver.add(z3.Or(above, below))
    return solver.check()
