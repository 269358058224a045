"""`safeloc drive`: a recorded train becomes records; `replay` then checks every property along the run."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.runtime.streams.record_files import read_records
from safeloc.runtime.streams.records import MarkerRecord, TruthRecord
from tests.cli.calling import Call
from tests.data_sources import data_file
from tests.railway.map.imports.test_geojson import SWITCH
from tests.railway.map.recorded import EDGES_31259, PATHS

CONFIG = "period_ms = 400\nreader_latency_ms = 0\nvehicle_length_mm = 100000\ntrust_first_marker = true\n"
HEADING = "timestamp,longitude,latitude,position_type\n"


@pytest.fixture
def network(tmp_path: Path) -> str:
    """A switch near the equator."""
    path = tmp_path / "network.geojson"
    path.write_text(json.dumps(SWITCH), encoding="utf-8")
    return str(path)


@pytest.fixture
def log(tmp_path: Path) -> str:
    """Five fixes, 11 m and one second apart, from the stem on; the third one 200 m off the track."""
    rows = [
        f"2026-01-01T00:00:0{second},{0.0098 + 0.0001 * second},{0.002 if second == 2 else 0},A" for second in range(5)
    ]
    path = tmp_path / "log.csv"
    path.write_text(HEADING + "\n".join(rows) + "\n", encoding="utf-8")
    return str(path)


def test_a_train_over_a_switch(call: Call, network: str, log: str, tmp_path: Path) -> None:
    """Distances of both units at both ends, groups where they were placed, satellites, truth where it is trusted."""
    where = tmp_path / "run.jsonl"
    arguments = ["--edges", "stem, south", "--balise-at-mm", "1095000", "--balise-at-mm", "1130000"]
    called = call("drive", network, log, *arguments, "--satellite", "A=5000", "--out", str(where))
    assert (0, f"5 fixes, 4 of them trusted, 2 balise readings: {where}\n") == (called.code, called.err)
    records = read_records(where)
    channels = {record.channel for record in records}
    assert {"front_wheel", "front_radar", "rear_wheel", "rear_radar", "front_marker", "truth"} == channels
    markers = [record.marker for record in records if isinstance(record, MarkerRecord)]
    assert [500_000, 1, 500_003, 2] == markers
    assert 4 == sum(isinstance(record, TruthRecord) for record in records)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give the train's route: either --path or --edges."),
        (["--edges", "stem", "--path", "x"], "give the train's route: either --path or --edges."),
        (["--edges", "stem"], "the direction along 'stem' is not told"),
        (["--edges", "stem", "--first", "up"], "--first 'up': choose increasing or decreasing."),
        (["--edges", "stem,west"], "the network has no element 'west'."),
        (["--edges", "north,south"], "no vehicle can run over 'north', 'south' in this order."),
        (["--path", "none.geojson"], "none.geojson: cannot be read"),
        (["--edges", "stem,south", "--satellite", "A"], "--satellite 'A': expected FLAG=MM"),
        (["--edges", "stem,south", "--satellite", "A=-1"], "--satellite 'A=-1': expected FLAG=MM"),
        (["--edges", "stem,south", "--balise-at-mm", "9999999"], "9999999 mm is not on a route"),
    ],
)
def test_wrong_usage(call: Call, network: str, log: str, tmp_path: Path, arguments: list[str], message: str) -> None:
    """Told in one line, with exit code 2."""
    called = call("drive", network, log, *arguments, "--out", str(tmp_path / "run.jsonl"))
    assert 2 == called.code
    assert message in called.err


def test_a_clean_recording_keeps_every_property(call: Call, tmp_path: Path) -> None:
    """Over the way it took, with a balise every 250 m: no property is broken, and the truth is always contained."""
    where, config = tmp_path / "run.jsonl", tmp_path / "config.toml"
    config.write_text(CONFIG, encoding="utf-8")
    called = call(
        "drive",
        str(data_file("trains/network_airport.geojson")),
        str(data_file("trains/log_31176.csv")),
        "--path",
        str(data_file(f"trains/{PATHS['31176']}")),
        "--balise-spacing-mm",
        "250000",
        "--out",
        str(where),
    )
    assert called.err.startswith("714 fixes, 714 of them trusted")
    replayed = call("replay", "odometry", str(where), "--config", str(config), "--period-ms", "400")
    assert 0 == replayed.code
    assert "contained: " in replayed.out
    assert "violated" not in replayed.out


def test_a_way_may_be_told_edge_by_edge(call: Call, tmp_path: Path) -> None:
    """The log without a published path, over an imported line."""
    line, where = tmp_path / "line.toml", tmp_path / "run.csv"
    call("import", str(data_file("trains/network_airport.geojson")), "--out", str(line))
    edges = ",".join(f"88_L_{number}" for number in EDGES_31259)
    called = call("drive", str(line), str(data_file("trains/log_31259.csv")), "--edges", edges, "--out", str(where))
    assert f"1189 fixes, 783 of them trusted, 0 balise readings: {where}\n" == called.err
