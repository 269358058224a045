"""What the benchmarks compare is the same machine, run in many ways."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("sismic", reason="the benchmarks' packages are an extra")
pytest.importorskip("statemachine", reason="the benchmarks' packages are an extra")

from benchmarks import contenders
from benchmarks.odometer import expected
from benchmarks.turns import Target, judged, race, table
from benchmarks.whole_machines import WHOLE, Whole

FEW = 250


def test_every_way_to_run_the_odometer_ends_alike(tmp_path: Path) -> None:
    """After some hundred steps, every contender is in the interpreter's state."""
    for contender in contenders.contenders(tmp_path):
        assert expected(FEW) == contender.prepare(FEW)(), contender.name


@pytest.mark.thorough
@pytest.mark.parametrize("whole", [WHOLE[0], pytest.param(WHOLE[1], marks=pytest.mark.slow)], ids=lambda one: one.title)
def test_every_way_to_run_a_whole_machine_ends_alike(whole: Whole) -> None:
    """The same for shipped machines, over the first seconds of a service."""
    for contender in whole.contenders():
        assert whole.expected(20) == contender.prepare(20)(), contender.name


def test_a_contender_that_computes_something_else_is_found(tmp_path: Path) -> None:
    """A race is no comparison if one of the runners takes a shorter way."""
    honest = contenders.contenders(tmp_path)[:1]
    with pytest.raises(AssertionError, match=r"^python-statemachine ends in a state of its own"):
        race(honest, lambda steps: (0, steps, 0), rounds=1)
    assert race(honest, expected, rounds=1)["python-statemachine"] > 0


def test_the_table_shows_ratios_slowest_first() -> None:
    """Speeds are compared with the unit's."""
    assert table("Title", {"unit": 2_000.0, "slow": 500.0}, "unit") == [
        "Title",
        "            steps/s  ratio to unit",
        "slow            500      0.2500",
        "unit          2,000      1.0000",
    ]


@pytest.mark.parametrize(
    ("line", "target"),
    [
        ("met     fast >= 2 x slow: 4.00", Target("fast", 2.0, "slow")),
        ("MISSED  slow >= 1 x fast: 0.25", Target("slow", 1.0, "fast")),
        ("met     fast >= 8,000 steps/s: 8,000", Target("fast", 8e3, None)),
        ("not measured  C >= 1 x slow", Target("C", 1.0, "slow")),
    ],
    ids=["met", "missed", "absolute", "absent"],
)
def test_targets_are_judged_and_shown(line: str, target: Target) -> None:
    """Met or missed, with what was found."""
    assert line == judged(target, {"fast": 8_000.0, "slow": 2_000.0})
