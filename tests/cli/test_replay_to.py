"""`safeloc replay ... --to FILE`: the whole run for another program."""

from __future__ import annotations

import csv
from pathlib import Path

from tests.cli.calling import Call


def test_a_recording_that_ships(call: Call, tmp_path: Path) -> None:
    """State and outputs of every step, at the configured cycle length."""
    path = tmp_path / "run.csv"
    called = call("replay", "axle_head", _first(call), "--to", str(path))
    assert (called.code, f"run: {path}" in called.err) == (0, True)
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 10
    assert any(name.startswith("state.") for name in rows[0])
    assert [row["step"] for row in rows] == [str(number) for number in range(1, len(rows) + 1)]


def _first(call: Call) -> str:
    listed = call("list", "recordings", "axle_head").out.split()
    return next(word for word in listed if word.startswith("axle_head-"))


def test_wrong_use(call: Call, tmp_path: Path) -> None:
    """Another ending, and data that has no run."""
    called = call("replay", "odometry", "odometry-service", "--to", str(tmp_path / "run.doc"))
    assert called.code == 2
    assert "a run is written as .csv, .parquet, .vcd, .mcap" in called.err
    called = call("replay", "odometry", "odometry-service", "--assumptions", "--to", str(tmp_path / "run.csv"))
    assert called.code == 2
    assert "--assumptions excludes" in called.err
    assert not (tmp_path / "run.csv").exists()
    called = call("replay", "odometry", "odometry-reversal", "--to", str(tmp_path / "none" / "run.csv"))
    assert called.code == 2
    assert "run.csv: cannot be written: No such file or directory." in called.err
