"""The tables of the fibre front end come from runs whose outcomes are judged against truth."""

from __future__ import annotations

import pytest

from benchmarks.fibre_accuracy import CONDITIONS, KINDS, Sample, Tally, by_condition, by_kind, by_quantity, run
from benchmarks.fibre_speed import configured, measured


@pytest.fixture(scope="module")
def tallies() -> dict[str, Tally]:
    """One run of the first condition."""
    made = {CONDITIONS[0].name: Tally()}
    run(CONDITIONS[0], made[CONDITIONS[0].name], 3)
    return made


@pytest.mark.thorough
def test_runs_are_judged(tallies: dict[str, Tally]) -> None:
    """A train that is told, within its bounds, and nothing that is not there."""
    (tally,) = tallies.values()
    assert tally.told > 20
    assert 0 == tally.false_trains
    assert all(sample.speed[1] for sample in tally.samples)
    assert 1 == sum(tally.counts.values()) == tally.runs


@pytest.mark.thorough
def test_the_tables_say_what_was_measured(tallies: dict[str, Tally]) -> None:
    """A row for each quantity, and one for the condition."""
    assert [CONDITIONS[0].name] * 4 == [row.split(" | ")[0][2:] for row in list(by_quantity(tallies))[2:]]
    assert 3 == len(list(by_condition(tallies)))
    kinds = [row.split(" | ") for row in list(by_kind(tallies))[2:]]
    assert list(KINDS) == [cells[0][2:] for cells in kinds]
    assert 1 == sum(int(cells[1]) for cells in kinds)


def test_a_truth_outside_its_bounds_would_show() -> None:
    """Half of two samples."""
    wrong = Tally(samples=[Sample((1_000.0, inside), None, (0.0, True), None, 0.0) for inside in (True, False)])
    assert "| one | front | 2 | +1.0 m | 1.0 | 1.0 | 50.00 % |" in list(by_quantity({"one": wrong}))


def test_speed_is_measured_on_trains() -> None:
    """On a short fibre: all trains are told while it is timed."""
    speed = measured(configured(4_000_000), 4, trains=2)
    assert (2, 2.0) == (speed.trains, speed.fibre_s)
    assert speed.times_real > 1
    assert speed.processor_s > 0
