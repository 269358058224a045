"""`safeloc replay --assumptions`: what it prints, its JSON, its exit codes, and what does not go with it."""

from __future__ import annotations

import json
from pathlib import Path

from safeloc.catalogue import load_target
from safeloc.runtime.streams.record_files import write_records
from safeloc.runtime.streams.records import DistanceRecord
from tests.cli.calling import Call

TURN_OFF = load_target("turn_off")
LAWFUL = str(TURN_OFF.streams[0])
SLIDE = str(next(path for path in load_target("odometry").streams if "wheel-slide" in path.name))


def test_a_lawful_recording(call: Call) -> None:
    """Each law with its least distance; exit code 0."""
    done = call("replay", "turn_off", LAWFUL, "--assumptions")
    assert done.code == 0
    lines = done.out.splitlines()
    assert lines[0] == f"{Path(LAWFUL).name}: 700 cycles, with the truth"
    assert lines[1].split() == ["law", "checked", "by", "least", "distance", "cycle", "broken", "in"]
    assert [line.split()[0] for line in lines[2:9]] == [f"turn_off/A{number}" for number in range(1, 8)]
    assert "inputs" in lines[2] and " mm " in lines[2] and lines[2].endswith("-")
    assert lines[-1] == "checked: 7, of them broken: 0; laws that this recording does not show: 1"


def test_a_breach_is_named_in_its_cycle(call: Call) -> None:
    """With both laws, their owners, by how much, and the values; exit code 1."""
    done = call("replay", "odometry", SLIDE, "--assumptions")
    assert done.code == 1
    assert (
        "BROKEN  odometry/A1 front_wheel obeys its error law against odometry/A3 rear_wheel obeys its error law"
        in done.out
    )
    assert "at least one of them is broken: they exclude each other" in done.out
    assert "(owner: supplier)" in done.out
    assert "    cycle 324: by " in done.out and "inputs show it; " in done.out
    assert "more cycles, the last of them" in done.out
    assert "not checked: odometry/A14  the vehicle stays on the line; owner: operator; check: route setting" in done.out


def test_as_data(call: Call) -> None:
    """The same with every breach, in the schema that it names."""
    done = call("replay", "odometry", SLIDE, "--assumptions", "--json")
    data = json.loads(done.out)
    assert (1, "safeloc-assumptions/1", "odometry", 600, False) == (
        done.code, data["schema"], data["target"], data["cycles"], data["with_truth"]
    )  # fmt: skip
    broken = [one for one in data["judged"] if one["breaches"]]
    assert {"odometry/A1", "odometry/A3"} <= {law["id"] for one in broken for law in one["laws"]}
    breach = broken[0]["breaches"][0]
    assert {"cycle", "distance", "inputs_show_it", "values"} == set(breach) and breach["distance"] < 0
    assert "border/B1" in {one["id"] for one in data["not_judged"]}
    assert all(one["check"] for one in data["not_judged"])


def test_nothing_to_judge(call: Call, tmp_path: Path) -> None:
    """Without the truth and without anything observable: exit code 3, no success."""
    path = tmp_path / "run.jsonl"
    sample = {f"channel_{channel}_{told}": told == "alive" for channel in "ab" for told in ("alive", "damped")}
    path.write_text(json.dumps(sample), encoding="utf-8")
    done = call("replay", "axle_head", str(path), "--assumptions")
    assert (3, "checked: 0, of them broken: 0; laws that this recording does not show: 3") == (
        done.code, done.out.splitlines()[-1]
    )  # fmt: skip


def test_clocks_of_single_records(call: Call, tmp_path: Path) -> None:
    """Told source by source."""
    path = tmp_path / "records.csv"
    units = (("front", 0), ("rear", 30))
    write_records(
        path,
        [
            DistanceRecord(time_ms=cycle * 100 - late_ms, end=end, unit="wheel", distance_mm=0)  # type: ignore[arg-type] # ends
            for cycle in range(1, 5)
            for end, late_ms in units
        ],
    )
    done = call("replay", "odometry", str(path), "--period-ms", "100", "--assumptions")
    assert done.code == 0
    assert "clock of rear_wheel: at least 30 ms and at most 30 ms behind another source (front_wheel)" in done.out
    assert "border/B1 all sources tell the time of one clock" in done.out


def test_what_does_not_go_with_it(call: Call, tmp_path: Path) -> None:
    """A report has no place for it, nor have rows."""
    for more in (("--out", str(tmp_path / "drawn")), ("--format", "jsonl")):
        done = call("replay", "turn_off", LAWFUL, "--assumptions", *more)
        assert done.code == 2 and "--assumptions excludes --out, --to and --format" in " ".join(
            done.err.replace("│", " ").split()
        )
