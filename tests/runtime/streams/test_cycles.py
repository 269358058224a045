"""The cycle builder: every record is either in a step or rejected there with a reason."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.runtime.border import Channel, Fault, Reason
from safeloc.runtime.streams.cycles import cycles
from safeloc.runtime.streams.records import (
    DistanceRecord,
    MarkerRecord,
    PulseRecord,
    Record,
    TruthRecord,
    Unusable,
    ValueRecord,
)


def wheel(time_ms: int, distance_mm: int = 10) -> DistanceRecord:
    """A distance of the front wheel."""
    return DistanceRecord(time_ms=time_ms, end="front", unit="wheel", distance_mm=distance_mm)


def marker(time_ms: int, identity: int = 7) -> MarkerRecord:
    """A marker read at the front."""
    return MarkerRecord(time_ms=time_ms, end="front", marker=identity, position_mm=500)


def test_records_fall_into_the_cycle_of_their_time() -> None:
    """The end of a cycle belongs to it; the next instant does not."""
    steps = list(cycles([wheel(100, 1), wheel(101, 2), marker(200)], 100))
    assert [step.inputs for step in steps] == [
        {"front_wheel_mm": 1},
        {"front_wheel_mm": 2, "front_marker": 7, "front_marker_position_mm": 500},
    ]
    assert [(step.number, step.end_ms) for step in steps] == [(1, 100), (2, 200)]


def test_distances_of_one_cycle_are_added_up() -> None:
    """A unit that speaks more often than the cycle loses nothing."""
    (step,) = cycles([wheel(25, 3), wheel(50, 4), wheel(100, -1)], 100)
    assert step.inputs == {"front_wheel_mm": 6}


def test_pulses_of_one_cycle_are_added_up() -> None:
    """They have an input of their own."""
    (step,) = cycles([PulseRecord(time_ms=time_ms, end="rear", pulses=3) for time_ms in (25, 50)], 100)
    assert step.inputs == {"rear_wheel_pulses": 6}


def test_silent_periods_give_steps_without_inputs() -> None:
    """A gap is a run of steps, each naming the channels that were expected."""
    steps = list(cycles([wheel(100), wheel(400)], 100, expected={"front_wheel": 1}))
    assert [step.missing for step in steps] == [(), ("front_wheel",), ("front_wheel",), ()]
    assert [step.inputs for step in steps] == [{"front_wheel_mm": 10}, {}, {}, {"front_wheel_mm": 10}]


@pytest.mark.parametrize(
    ("records", "reason"),
    [
        ([wheel(150), wheel(150)], Reason.DUPLICATE),
        ([wheel(150), wheel(150, 99)], Reason.DUPLICATE),
        ([wheel(180), wheel(150)], Reason.OUT_OF_ORDER),
        ([marker(150, 1), marker(180, 2)], Reason.SURPLUS),
    ],
)
def test_a_channel_with_a_rejected_record_gives_no_input(records: list[Record], reason: Reason) -> None:
    """Which of two readings is right cannot be known: the input is absent and the reason is listed."""
    step = list(cycles(records, 100))[-1]
    assert step.inputs == {}
    assert [(1, reason)] == [(one.number, one.reason) for one in step.rejected]


def test_a_late_record_is_stale_in_the_cycle_it_arrives_in() -> None:
    """It does not reach back into a step that is over, and it silences only its own channel."""
    late = [ValueRecord(time_ms=150, name="door", value=1), wheel(50)]
    steps = list(cycles(late, 100))
    assert [step.inputs for step in steps] == [{}, {"door": 1}]
    assert [one.reason for one in steps[1].rejected] == [Reason.STALE]


def test_part_of_a_distance_is_no_distance() -> None:
    """Of two expected records one came late: the sum would be too small, so there is no input."""
    steps = list(cycles([wheel(50), wheel(150), wheel(100), wheel(200)], 100, expected={"front_wheel": 2}))
    assert [step.inputs for step in steps] == [{}, {}]
    assert [step.missing for step in steps] == [("front_wheel",), ()]
    assert [(one.number, one.reason) for one in steps[1].rejected] == [(2, Reason.OUT_OF_ORDER)]


def test_the_first_cycle_has_its_beginning() -> None:
    """A recording that begins at time 0 loses nothing."""
    (step,) = cycles([wheel(0), wheel(100)], 100)
    assert step.inputs == {"front_wheel_mm": 20}


def test_truth_is_a_remark_rounded_down() -> None:
    """No machine can read where the vehicle really is."""
    (step,) = cycles([TruthRecord(time_ms=100, position_nm=-1)], 100)
    assert step.inputs == {}
    assert step.as_step() == {"truth_mm": -1}


def test_a_leap_of_time_is_refused() -> None:
    """One wrong clock must not make millions of empty steps, nor everything after it stale."""
    with pytest.raises(
        InputError, match=r"^record 1 \(front_wheel\) is 99900 ms ahead, more than longest_gap_ms 1000; "
    ):
        list(cycles([wheel(100), wheel(100_000)], 100, longest_gap_ms=1000))


def test_a_cycle_takes_time() -> None:
    """A period of nothing is refused."""
    with pytest.raises(InputError, match=r"^period_ms is 0; give at least 1 ms\.$"):
        list(cycles([], 0))


RANGES = (
    Channel("front_wheel_mm", "mm", -15, 15, 100),
    Channel("front_marker_position_mm", "mm", 0, 499, 100),
    Channel("door", "1", 0, 1, 100),
)


@pytest.mark.parametrize(
    ("records", "fault"),
    [
        ([wheel(50), wheel(60)], Fault("front_wheel", Reason.OUT_OF_RANGE, "front_wheel_mm: above 15 mm")),
        (
            [marker(50)],
            Fault("front_marker", Reason.OUT_OF_RANGE, "front_marker_position_mm: above 499 mm", 0),
        ),
        ([ValueRecord(time_ms=50, name="door", value="OPEN")], Fault("door", Reason.WRONG_TYPE, "door: str", 0)),
        ([Unusable(50, "front_wheel", Reason.NOT_FINITE, "distance_mm: nan"), wheel(60)],
         Fault("front_wheel", Reason.NOT_FINITE, "distance_mm: nan", 0)),
    ],
    ids=["a sum", "one of several values", "a type", "no measurement"],
)  # fmt: skip
def test_what_is_outside_its_range_is_no_input(records: list[Record], fault: Fault) -> None:
    """Neither clipped nor left to the machine, and a reading with one wrong value gives none of its values."""
    (step,) = cycles(records, 100, channels=RANGES)
    assert step.inputs == {}
    assert step.faults == (fault,)


def test_within_the_ranges_nothing_changes() -> None:
    """The sum is judged, not its parts; inputs without a range pass."""
    (step,) = cycles(
        [wheel(50, 20), wheel(60, -10), ValueRecord(time_ms=60, name="lamp", value="LIT")], 100, channels=RANGES
    )
    assert step.inputs == {"front_wheel_mm": 10, "lamp": "LIT"}
    assert step.faults == ()


@given(st.lists(st.tuples(st.integers(0, 1000), st.booleans()), max_size=30), st.integers(1, 300))
def test_no_record_is_lost(said: list[tuple[int, bool]], period_ms: int) -> None:
    """Distance in the steps and records rejected account for every record, in any order of arrival."""
    records: list[Record] = [
        DistanceRecord(time_ms=time_ms, end="rear" if rear else "front", unit="wheel", distance_mm=1)
        for time_ms, rear in said
    ]
    steps = list(cycles(records, period_ms))
    rejected = {one.number for step in steps for one in step.rejected}
    doubtful = {(step.number, one.channel) for step in steps for one in step.rejected}
    silenced = _accepted(records, rejected, period_ms, doubtful)
    used = sum(int(value) for step in steps for value in step.inputs.values())
    assert len(records) == used + silenced + len(rejected)
    assert list(range(1, len(steps) + 1)) == [step.number for step in steps]


def _accepted(records: list[Record], rejected: set[int], period_ms: int, doubtful: set[tuple[int, str]]) -> int:
    """How many records that were not rejected lie in a step in which their channel is doubtful."""
    kept = [record for number, record in enumerate(records) if number not in rejected]
    return sum((max(1, -(-record.time_ms // period_ms)), record.channel) in doubtful for record in kept)
