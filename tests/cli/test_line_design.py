"""`safeloc margins LINE --for tolerance=...`: the designed line as text, JSON and files, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.railway.map.toml_files import to_toml
from tests.cli.calling import Call
from tests.railway.map.made import straight


@pytest.mark.thorough
def test_a_line_is_designed(call: Call, tmp_path: Path) -> None:
    """The written line passes its audit, and the written run is one that the machine's claims hold on."""
    told = call("margins", "valley", "--for", "tolerance=60m", "--out", str(tmp_path), "--json")
    data = json.loads(told.out)
    assert (0, 14_000, 14_000) == (told.code, data["cost_eur"], data["least_eur"])
    assert [("proved", True)] == [(one["verdict"], one["lost_in_cycle"] is not None) for one in data["machine"]]
    assert call("audit", str(tmp_path / "valley.toml")).code == 1  # for 30 m
    again = call("margins", str(tmp_path / "valley.toml"), "--for", "tolerance=60000mm")
    assert "7 kept, 0 left out, 0 added" in again.out
    run = ("replay", "balise", str(tmp_path / "lost-after-1000.jsonl"), "--config", str(tmp_path / "balise.json"))
    assert call(*run).code == 0


READS = "[localization]\ntolerance_mm = 30_000\n[localization.markers]\ngroups_are_markers = false\n"


@pytest.mark.thorough
def test_a_line_is_designed_for_a_vehicle_that_reads_markers(call: Call, tmp_path: Path) -> None:
    """The written line passes its audit for that vehicle, and the claims of the odometry machine hold on the written run."""
    vehicle, line = tmp_path / "reader.toml", tmp_path / "line.toml"
    vehicle.write_text(READS, encoding="utf-8")
    line.write_text(to_toml(straight(1_300_000)), encoding="utf-8")
    of = ("--vehicle", str(vehicle))
    told = call(
        "margins", str(line), "--for", "tolerance=30m", *of, "--add", "markers=5", "--out", str(tmp_path), "--json"
    )
    data = json.loads(told.out)
    assert (0, 5_000, 5_000) == (told.code, data["cost_eur"], data["least_eur"])
    assert [("odometry", "proved", 156)] == [
        (one["machine"], one["verdict"], one["lost_in_cycle"]) for one in data["machine"]
    ]
    assert call("audit", str(tmp_path / "straight.toml"), *of).code == 0
    run = ("replay", "odometry", str(tmp_path / "lost-after-300.jsonl"), "--config", str(tmp_path / "odometry.json"))
    assert call(*run).code == 0


@pytest.mark.thorough
def test_the_nearest_tolerance_is_told(call: Call, tmp_path: Path) -> None:
    """It is told on an empty track, and 1 mm less is refused again."""
    path = tmp_path / "line.toml"
    path.write_text(to_toml(straight(300_000)), encoding="utf-8")
    told = call("margins", str(path), "--for", "tolerance=7.5m")
    assert told.code == 2
    assert "the nearest tolerance that one keeps is" in told.err
    nearest = told.err.rpartition("keeps is ")[2].split(" m")[0]
    assert call("margins", str(path), "--for", f"tolerance={float(nearest) - 0.001:.3f}m").code == 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--for", "30m"), "tolerance=30m"),
        (("--for", "tolerance=0m"), "at least 1 mm"),
        (("--for", "tolerance=30m", "--cost", "balise=3"), "add_group_eur"),
        (("--for", "tolerance=30m", "--add", "view=1"), "location_accuracy_mm"),
        (("--for", "tolerance=30m", "--keep", "B99"), "B99"),
        (("--for", "tolerance=30m", "--add", "markers=3"), "[localization.markers]"),
        (("--keep", "B1"), "--for"),
    ],
)
def test_wrong_usage(call: Call, arguments: tuple[str, ...], said: str) -> None:
    """Each is refused before anything is searched."""
    told = call("margins", "valley", *arguments)
    assert told.code == 2
    assert said in told.err
