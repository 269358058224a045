"""The benchmark of wrong radars: within the supplier's figures no precise interval is ever wrong, and gross errors are said."""

from __future__ import annotations

import pytest

from benchmarks.radar_self_test import RADARS, Radar, biased, driven, scaled, table

LAWFUL = [one for one in RADARS if one.lawful]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("radar", LAWFUL, ids=[one.name for one in LAWFUL])
def test_a_wrong_radar_never_makes_a_precise_interval_wrong(radar: Radar) -> None:
    """Whatever its constant error, and whatever drift and scale the supplier's figures allow."""
    assert 0 == driven(radar).wrong


@pytest.mark.parametrize(
    "radar", [biased(-1_400), biased(5_000), biased(40_000), scaled(60_000)], ids=lambda one: one.name
)
def test_what_the_self_test_can_see_is_said(radar: Radar) -> None:
    """A radar that is farther off than balise, echo and survey explain is not precise in a single cycle."""
    one = driven(radar)
    assert (0, True) == (one.precise, "MISMATCH" in one.errors)


def test_a_right_radar_is_precise() -> None:
    """In both view zones, and never called wrong."""
    one = driven(RADARS[0])
    assert one.precise > 100
    assert "MISMATCH" not in one.errors


def test_the_table_has_a_row_for_each() -> None:
    """As it is printed."""
    rows = list(table(RADARS[:1]))
    assert "| right | yes | 113 | 0 | 0.00 m | 2.6 m |  |" == rows[-1]
