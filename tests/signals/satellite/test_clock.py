"""The receiver's clock: a median, and where it breaks down."""

from __future__ import annotations

import math

import pytest

from safeloc.errors import InputError
from safeloc.signals.satellite.clock import common_part, without_clock


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
