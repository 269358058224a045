"""`safeloc drive`: a recorded train becomes records; `replay` then checks every property along the run."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.railway.map.toml_files import to_toml
from safeloc.runtime.streams.record_files import read_records
from safeloc.runtime.streams.records import MarkerRecord, TruthRecord
from tests.cli.calling import Call
from tests.data_sources import data_file
from tests.railway.guard.made import CRS
from tests.railway.guard.test_other_way import BESIDE_M, double
from tests.railway.map.imports.test_geojson import SWITCH
from tests.railway.map.recorded_trains import EDGES_31259, PATHS

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
    """Sixteen fixes, 11 m and one second apart, from the stem on; the ninth one 200 m off the track."""
    rows = [
        f"2026-01-01T00:00:{second:02},{0.0098 + 0.0001 * second},{0.002 if second == 8 else 0},A"
        for second in range(16)
    ]
    path = tmp_path / "log.csv"
    path.write_text(HEADING + "\n".join(rows) + "\n", encoding="utf-8")
    return str(path)


def test_a_train_over_a_switch(call: Call, network: str, log: str, tmp_path: Path) -> None:
    """Distances of both units at both ends, groups where they were placed, satellites; truth where the guard trusts a fix: the
    fifth in a row and on, until one is false."""
    where = tmp_path / "run.jsonl"
    arguments = ["--edges", "stem, south", "--balise-at-mm", "1160000", "--balise-at-mm", "1240000"]
    called = call("drive", network, log, *arguments, "--satellite", "A=5000", "--out", str(where))
    assert (0, f"16 fixes, 15 near the track, 7 of them trusted by the guard, 2 balise readings: {where}\n") == (
        called.code,
        called.err,
    )
    records = read_records(where)
    channels = {record.channel for record in records}
    assert {"front_wheel", "front_radar", "rear_wheel", "rear_radar", "front_marker", "truth"} == channels
    markers = [record.marker for record in records if isinstance(record, MarkerRecord)]
    assert [500_004, 500_005, 500_006, 1, 500_013, 2, 500_015] == markers
    assert 7 == sum(isinstance(record, TruthRecord) for record in records)


def test_a_train_on_another_way_than_the_given_one(call: Call, tmp_path: Path) -> None:
    """All of its fixes are trusted, since the receiver alone tells no track; but the route is told to be doubtful, with figures."""
    line, log, where = tmp_path / "line.toml", tmp_path / "log.csv", tmp_path / "run.jsonl"
    line.write_text(to_toml(double()), encoding="utf-8")
    degrees = pytest.importorskip("pyproj").Transformer.from_crs(CRS, "EPSG:4326", always_xy=True)
    for aside, doubted in ((BESIDE_M, True), (0.0, False)):
        places = [degrees.transform(20 + 11 * second, aside) for second in range(80)]
        rows = [f"2026-01-01T00:{n // 60:02}:{n % 60:02},{x:.9f},{y:.9f},A" for n, (x, y) in enumerate(places)]
        log.write_text(HEADING + "\n".join(rows) + "\n", encoding="utf-8")
        called = call(
            "drive", str(line), str(log), "--edges", "stem,main", "--max-speed-mm-s", "30000", "--out", str(where)
        )
        assert called.code == 0
        assert "80 fixes, 80 near the track, 76 of them trusted by the guard" in called.err
        warned = "warning: at 56 fixes the route is doubtful: 11 of the last 11 fixes that were passed on"
        assert (warned in called.err) == doubted
        assert ("warning" in called.err) == doubted


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give the train's route: either --path or --edges."),
        (["--edges", "stem", "--path", "x"], "give the train's route: either --path or --edges."),
        (["--edges", "stem"], "the direction along 'stem' is unknown"),
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
    assert called.err.startswith("714 fixes, 714 near the track, 710 of them trusted by the guard")
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
    assert (
        f"1189 fixes, 783 near the track, 669 of them trusted by the guard, 0 balise readings: {where}\n" == called.err
    )


@pytest.mark.parametrize("by", ["2013", "3955,5977,7820"], ids=["left track", "middle track"])
def test_what_the_guard_withholds_is_no_truth(call: Call, tmp_path: Path, by: str) -> None:
    """In log 28586 the receiver drags a false place back over the way: none of it is written as truth, and none as a marker."""
    where = tmp_path / "run.jsonl"
    edges = f"5916,2026,7855,7818,9754,5831,{by},9755,2014,7819,7154,9422,1388"
    way = ",".join(f"88_L_{number}" for number in edges.split(","))
    line, log = str(data_file("trains/network_airport.geojson")), str(data_file("trains/log_28586.csv"))
    called = call("drive", line, log, "--edges", way, "--satellite", "PROPAGATED=10000", "--out", str(where))
    assert 0 == called.code
    told = [record.time_ms for record in read_records(where) if isinstance(record, TruthRecord | MarkerRecord)]
    assert len(told) > 600
    assert [time_ms for time_ms in told if 225_000 < time_ms < 541_000] == []
