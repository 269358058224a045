"""The range law."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.sensing.range_law import is_lawful, loss_cdb, section_cdbsm
from tests.sensing.scenes import CONFIG

NOMINAL = CONFIG.reflectors.section_cdbsm(CONFIG.sensor.carrier_mhz)


@given(st.floats(1_000, 1_000_000))
def test_twelve_db_a_doubling(range_mm: float) -> None:
    """12.04 dB, to a hundredth on either side for rounding."""
    assert loss_cdb(2 * range_mm) - loss_cdb(range_mm) == pytest.approx(1_204.12, abs=1)


def test_a_corner_of_15_cm_at_77_ghz() -> None:
    """4 pi a^4 / 3 lambda^2 = 139.9 m2, 21.46 dB over 1 m2; at 24 GHz 10.1 dB less."""
    assert NOMINAL == 2_146
    assert NOMINAL - CONFIG.reflectors.section_cdbsm(24_000) == pytest.approx(1_012.5, abs=1)


@given(st.floats(1_000, 200_000), st.floats(-30, 30))
def test_the_section_is_what_is_left(range_mm: float, dbsm: float) -> None:
    """Power by the law gives the section back, rounded down."""
    power = 10 ** (CONFIG.reference_cdb / 1_000 + dbsm / 10) * (100_000 / range_mm) ** 4
    assert section_cdbsm(power, range_mm, CONFIG) == pytest.approx(100 * dbsm, abs=1.6)


def test_too_strong_and_too_weak_are_told() -> None:
    """At the ends of what a corner may have."""
    assert is_lawful(NOMINAL + CONFIG.reflectors.stronger_cdb, CONFIG)
    assert is_lawful(NOMINAL - CONFIG.reflectors.weaker_cdb, CONFIG)
    assert not is_lawful(NOMINAL + CONFIG.reflectors.stronger_cdb + 1, CONFIG)
    assert not is_lawful(NOMINAL - CONFIG.reflectors.weaker_cdb - 1, CONFIG)
