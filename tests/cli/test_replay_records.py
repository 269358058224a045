"""A whole run from what all devices recorded: heard as on board, and drawn with the line, every source, every rejection."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.language.interpret import read_inputs
from safeloc.language.system import without_ghosts
from safeloc.models.localizer.simulation.recorded_runs import FOLDER, RUNS
from safeloc.proof.verification.recordings import counted, recorded_steps
from safeloc.runtime.border import Reason
from safeloc.runtime.packed import read_packed
from safeloc.runtime.streams.record_files import write_records
from safeloc.runtime.streams.records import DistanceRecord, MarkerRecord, Record, TruthRecord, ValueRecord
from safeloc.runtime.streams.steps import Cell, read_steps
from tests.cli.calling import Call

PERIOD_MS = 100
UNITS = {"motion.odometer_mm": "front_wheel_mm", "motion.check_mm": "front_radar_mm"}
DISTANCE = re.compile(r"(front|rear)_(wheel|radar)_mm")
MARKER = re.compile(r"(front|rear)_marker(?:_(position_mm|accuracy_mm|since_mm))?")


def heard_on_board(name: str) -> list[dict[str, Cell]]:
    """The steps of a shipped recording as a vehicle has them: no ghosts; the truth stands beside them."""
    known = {var.name for var in without_ghosts(load_target("localizer").system).inputs} | {"truth_mm"}
    steps = read_steps(FOLDER / f"localizer-{name}.jsonl.gz").steps
    return [{key: cell for key, cell in step.items() if key in known} for step in steps]


def said(step: Mapping[str, Cell], time_ms: int) -> Iterator[Record]:
    """What the devices say that makes such a step: distances and markers as records of their own kinds."""
    read: dict[str, dict[str, Cell]] = {}
    for full, value in step.items():
        name = UNITS.get(full, full.removeprefix("odometry."))
        if full == "truth_mm":
            yield TruthRecord(time_ms=time_ms, position_nm=int(value) * 1_000_000)
        elif found := DISTANCE.fullmatch(name):
            row = {"end": found[1], "unit": found[2], "distance_mm": value}
            yield DistanceRecord.model_validate({**row, "time_ms": time_ms})
        elif found := MARKER.fullmatch(name):
            read.setdefault(found[1], {})[found[2] or "marker"] = value
        else:
            yield ValueRecord(time_ms=time_ms, name=full, value=value)
    yield from (MarkerRecord.model_validate({**one, "end": end, "time_ms": time_ms}) for end, one in read.items())


def recorded(folder: Path, steps: list[dict[str, Cell]]) -> Path:
    """The same run as single records."""
    path = folder / "devices.jsonl"
    write_records(path, [one for n, step in enumerate(steps, 1) for one in said(step, n * PERIOD_MS)])
    return path


@pytest.mark.thorough
@pytest.mark.parametrize("name", RUNS)
def test_records_of_all_devices_are_the_run(tmp_path: Path, name: str) -> None:
    """Odometers, markers, balises, radar, satellites, fibre: their records become the inputs of the steps, and none is refused."""
    target, steps = load_target("localizer"), heard_on_board(name)
    system = without_ghosts(target.system)
    stream, faults = recorded_steps(target, recorded(tmp_path, steps), PERIOD_MS)
    assert faults == []
    for wanted, step in zip(steps, stream.steps, strict=True):
        assert step["truth_mm"] == wanted.pop("truth_mm")
        inputs = {key: cell for key, cell in step.items() if key != "truth_mm"}
        assert read_inputs(system, inputs) == read_inputs(system, wanted)


@pytest.mark.thorough
def test_a_report_of_the_whole_run(call: Call, tmp_path: Path) -> None:
    """One command: the strip with what the front end passes, a row for each source, and the rejections with their reasons."""
    path = recorded(tmp_path, heard_on_board("metro-silent-odometer-corrupted-balise"))
    done = call("replay", "localizer", str(path), "--period-ms", str(PERIOD_MS), "--out", str(tmp_path / "drawn"))
    assert done.code == 0
    page = (tmp_path / "drawn" / "index.html").read_text(encoding="utf-8")
    assert "passes" in page
    assert {"balise", "marker"} <= set(re.findall(r'class="[^"]*\b(balise|marker)\b', page))
    for source in ("odometry", "balise", "reflector", "passed-on"):
        assert f"interval-{source}" in page
    assert "everything that was rejected, with its reason" in page
    (picture,) = json.loads(read_packed(tmp_path / "drawn" / "machines" / "localizer.json.xz"))["pictures"]
    rejected = {(row[3], row[5]) for row in picture["table"]["rows"]}
    assert {("balise", "CORRUPTED"), ("odometer", "MISSING")} <= rejected


def short(folder: Path, *records: Record) -> Path:
    """A recording of a few records."""
    path = folder / "few.jsonl"
    write_records(path, records)
    return path


def test_a_silent_device_is_no_error(tmp_path: Path) -> None:
    """A vehicle that has only odometers still has cycles; radar, satellites, fibre and links are silent in them."""
    one = DistanceRecord(time_ms=PERIOD_MS, end="front", unit="wheel", distance_mm=1_200)
    stream, faults = recorded_steps(load_target("localizer"), short(tmp_path, one), PERIOD_MS)
    assert faults == []
    assert stream.steps[0]["motion.odometer_mm"] == 1_200
    assert stream.steps[0]["reflector.frame_present"] is False


def test_half_of_what_a_device_says_is_not_used(tmp_path: Path) -> None:
    """A radar frame that lacks something is no frame, and is counted by its machine; a misspelt name is counted as well."""
    half = ValueRecord(time_ms=PERIOD_MS, name="frame_present", value=True)
    wrong = ValueRecord(time_ms=PERIOD_MS, name="frame_presnt", value=True)
    stream, faults = recorded_steps(load_target("localizer"), short(tmp_path, half, wrong), PERIOD_MS)
    assert stream.steps[0]["reflector.frame_present"] is False
    assert {(fault.channel, fault.reason) for fault in faults} == {
        ("reflector", Reason.MISSING),
        ("frame_presnt", Reason.UNKNOWN),
    }
    assert counted(faults)["reflector: nothing or too little was delivered"] == "1"


def test_a_value_out_of_range_is_not_used(tmp_path: Path) -> None:
    """Of whatever kind it is: a number, a member, a truth value."""
    wrong: list[Record] = [
        ValueRecord(time_ms=PERIOD_MS, name="train_leaves", value=7),
        ValueRecord(time_ms=PERIOD_MS, name="reference_from", value="NOWHERE"),
        DistanceRecord(time_ms=PERIOD_MS, end="front", unit="wheel", distance_mm=10**9),
    ]
    stream, faults = recorded_steps(load_target("localizer"), short(tmp_path, *wrong), PERIOD_MS)
    assert "motion.odometer_mm" not in stream.steps[0]
    assert {(fault.channel, fault.reason) for fault in faults} == {
        ("train_leaves", Reason.WRONG_TYPE),
        ("reference_from", Reason.WRONG_TYPE),
        ("front_wheel", Reason.OUT_OF_RANGE),
    }


def test_ghosts_may_be_recorded_too(tmp_path: Path) -> None:
    """What a simulation tells beside the devices goes by, to be checked against."""
    ghost = ValueRecord(time_ms=PERIOD_MS, name="true_cycle_distance_nm", value=5)
    stream, faults = recorded_steps(load_target("localizer"), short(tmp_path, ghost), PERIOD_MS)
    assert (stream.steps[0]["true_cycle_distance_nm"], faults) == (5, [])


def test_records_of_another_machine_alone_are_refused(call: Call, tmp_path: Path) -> None:
    """Nothing of them would be replayed, and all would hold; the name that was meant is told."""
    path = tmp_path / "records.csv"
    path.write_text("kind,time_ms,name,value\nvalue,100,chanel_a_damped,true\nvalue,200,chanel_a_damped,true\n")
    done = call("replay", "axle_head", str(path), "--period-ms", "100")
    assert 2 == done.code
    assert f"{path}: none of its 2 records is for axle_head; the first is of 'chanel_a_damped'" in done.err
    assert "Did you mean 'channel_a_damped'?" in done.err


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        ("value,200,channel_b_damped,maybe\n", "channel_b_damped: expected true or false, got 'maybe'."),
        ("", "axle_head needs one in each cycle.\n"),
    ],
)
def test_a_cycle_without_a_value_that_is_needed(call: Call, tmp_path: Path, wrong: str, why: str) -> None:
    """The cycle is told by its time, and the record that was refused with the reason."""
    path, names = tmp_path / "records.csv", ("a_damped", "a_alive", "b_alive", "b_damped")
    good = "".join(f"value,{time},channel_{name},true\n" for time in (100, 200) for name in names[: 5 - time // 100])
    path.write_text(f"kind,time_ms,name,value\n{good}{wrong}")
    done = call("replay", "axle_head", str(path), "--period-ms", "100")
    assert 2 == done.code
    assert f"{path}: in the cycle that ends at 200 ms, input 'channel_b_damped' has no value" in done.err
    assert why in done.err
