"""A simulated run survives the way over records and cycles, and faults on that way are seen in the steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.models.odometry.simulate import simulate
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.runtime.border import Reason
from safeloc.runtime.streams.cycles import cycles
from safeloc.runtime.streams.record_files import read_records, write_records
from safeloc.runtime.streams.records import MarkerRecord, Record
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, VehicleConfig, move
from safeloc.simulation.record_faults import disturb
from safeloc.simulation.recording import records
from safeloc.simulation.sensors import measure, read_markers

PERIOD_MS = 100
CHANNELS = {"front_wheel": 1, "rear_radar": 1}


def run(dropout: float = 0.0) -> list[Record]:
    """Twenty seconds with two units and a reader at either end."""
    rng = np.random.default_rng(3)
    motion = move(VehicleConfig(), [Leg(15_000, 20.0)], PERIOD_MS)
    units = [
        measure(name, motion, ErrorLaw(kind="wheel", constant_mm=5_000, rate_ppm=20_000), rng, dropout=dropout)
        for name in CHANNELS
    ]
    places = [(number, number * 40_000) for number in range(1, 9)]
    readings = [
        reading
        for end, offset_mm in ((0, 0), (1, 20_000))
        for reading in read_markers(motion, end, offset_mm, places, 200, rng, foreign=0.02)
    ]
    return records(motion, units, readings)


def test_a_sound_run_is_one_step_a_cycle_without_rejections(tmp_path: Path) -> None:
    """Two hundred cycles, each with both distances, markers known and foreign, and the truth, also after a file."""
    path = tmp_path / "run.csv"
    write_records(path, run())
    steps = list(cycles(read_records(path), PERIOD_MS, expected=CHANNELS))
    assert len(steps) == 200
    assert not any(step.rejected or step.missing for step in steps)
    assert all("truth_mm" in step.remarks and "front_wheel_mm" in step.inputs for step in steps)
    placed = [step for step in steps if "front_marker_position_mm" in step.inputs]
    assert placed
    assert any("front_marker" in step.inputs and step not in placed for step in steps)


def test_drop_outs_are_missing_channels() -> None:
    """What a unit did not say is absent from the step and named."""
    steps = list(cycles(run(dropout=0.3), PERIOD_MS, expected=CHANNELS))
    silent = [step for step in steps if "front_wheel" in step.missing]
    assert 20 < len(silent) < 120
    assert not any("front_wheel_mm" in step.inputs for step in silent)


@pytest.mark.parametrize(
    ("kind", "reason"),
    [("duplicate", Reason.DUPLICATE), ("late", Reason.OUT_OF_ORDER), ("swap", Reason.OUT_OF_ORDER)],
)
def test_a_record_fault_is_rejected_with_its_reason(kind: str, reason: Reason) -> None:
    """The fault of one channel silences that channel, in the cycles it strikes, and no other."""
    broken = disturb(run(), [Fault(kind, "front_wheel", 5_000, 5_001, {"reach": 9} if kind == "late" else {})])
    steps = list(cycles(broken, PERIOD_MS, expected=CHANNELS))
    rejected = [one for step in steps for one in step.rejected if one.channel == "front_wheel"]
    assert [one.reason for one in rejected] == [reason]
    assert 1 <= sum("front_wheel_mm" not in step.inputs for step in steps) <= 2
    others = [one for step in steps for one in step.rejected if one.channel != "front_wheel"]
    assert kind == "swap" or not others


def test_frozen_records_repeat_what_was_said_before() -> None:
    """A frozen unit looks alive: only its value gives it away."""
    broken = disturb(run(), [Fault("freeze", "front_wheel", 3_000, 6_000)])
    steps = list(cycles(broken, PERIOD_MS, expected=CHANNELS))
    values = {step.inputs["front_wheel_mm"] for step in steps if 2_900 <= step.end_ms < 6_000}
    assert len(values) == 1
    assert not any(step.rejected for step in steps)


def test_dropped_records_are_absent() -> None:
    """Nothing takes their place."""
    broken = disturb(run(), [Fault("drop", "rear_radar", 3_000, 3_300)])
    steps = list(cycles(broken, PERIOD_MS, expected=CHANNELS))
    assert [step.end_ms for step in steps if step.missing] == [3_000, 3_100, 3_200]


def test_cross_talk_reads_a_sound_marker_of_the_wrong_place() -> None:
    """Only map and motion can tell: the record itself is in order."""
    fault = Fault("cross-talk", "front_marker", 0, 20_000, {"identity": 55, "position_mm": 9_000_000})
    read = [record for record in disturb(run(), [fault]) if isinstance(record, MarkerRecord)]
    assert {(55, 9_000_000)} == {(one.marker, one.position_mm) for one in read if one.end == "front"}
    assert 55 not in {one.marker for one in read if one.end == "rear"}


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (
            Fault("drop", "front_whel", 0, 9_000),
            r"of a stream of records there are front_marker, front_wheel, ",
        ),
        (Fault("drop", "front_wheel", 5, 6), r"hits no record\.$"),
        (
            Fault("cross-talk", "front_wheel", 0, 900),
            r"^cross-talk is a fault of marker readings, not of ",
        ),
    ],
)
def test_a_fault_that_cannot_be_is_refused(fault: Fault, message: str) -> None:
    """It would test nothing."""
    with pytest.raises(InputError, match=message):
        disturb(run(), [fault])


def test_the_simulator_of_the_odometry_machine_refuses_a_misspelt_sensor() -> None:
    """A fault of a sensor that is not there is an error, not a sound run."""
    with pytest.raises(
        InputError, match=r"of a distance sensor there are front_wheel, front_radar, rear_wheel, rear_radar\.$"
    ):
        simulate(OdometryConfig(), seed=1, seconds=5, faults=[Fault("stuck", "front_whel", 0, 9)])
