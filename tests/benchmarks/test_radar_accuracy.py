"""The tables of docs/signals.md come from runs whose outcomes are judged against truth."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.radar_accuracy import CONDITIONS, Shot, by_condition, by_range, by_speed, run


@pytest.fixture(scope="module")
def runs() -> dict[str, list[Shot]]:
    """A few frames of two conditions: a line, and a reflector without a corner."""
    chosen = [one for one in CONDITIONS if one.name in ("line with masts and ballast", "one corner lost")]
    return {one.name: list(run(one, 6, 0)) for one in chosen}


def test_outcomes_are_judged(runs: dict[str, list[Shot]]) -> None:
    """All right on a line, none known without a corner."""
    assert [{"right"}, {"not known"}] == [{shot.verdict for shot in shots} for shots in runs.values()]


def test_the_tables_say_what_was_measured(runs: dict[str, list[Shot]]) -> None:
    """Shares, the bound where nothing was seen, and errors."""
    rows = list(by_condition(runs))
    assert "| line with masts and ballast | 6 | 100.0 % | 0.0 % | 0 (< 50.00 %) | 0 (< 50.00 %) | 0.0 % |" in rows
    assert "| one corner lost | 6 | 0.0 % | 100.0 % | 0 (< 50.00 %) | 0 (< 50.00 %) | 0.0 % |" in rows
    assert len(list(by_speed(runs))) == 4
    assert len(list(by_range(runs["line with masts and ballast"]))) > 2


def test_a_truth_outside_the_bound_would_show(runs: dict[str, list[Shot]]) -> None:
    """A range 100 mm off is more than its bound."""
    shots = [replace(shot, true_mm=shot.true_mm + 100) for shot in runs["line with masts and ballast"]]
    assert any(float(row.split("|")[8]) > 1 for row in list(by_range(shots))[2:])
