"""Bytes become lines however they come, and nothing that is said wrongly is taken for something else."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.runtime.border import Reason
from safeloc.runtime.service.clock_lag import OUT_OF_STEP_CYCLES, Pace, Streak
from safeloc.runtime.service.counting import Counted, LineCount
from safeloc.runtime.service.lines import LONGEST_LINE, Line, LineCutter
from safeloc.runtime.service.messages import CycleEnd, Envelope, Header, Message, Reader, RecordLine, Refused, Step
from safeloc.runtime.streams.records import DistanceRecord, Unusable
from tests.runtime.embedding.driving import trusting

WHEEL = {"kind": "distance", "time_ms": 100, "end": "front", "unit": "wheel", "distance_mm": 5}


@given(st.binary(max_size=200), st.lists(st.integers(0, 200), max_size=6))
def test_cutting_does_not_depend_on_the_parts(data: bytes, cuts: list[int]) -> None:
    """Lines are those of the whole, and where the next one begins is known."""
    cutter, begin, found = LineCutter(), 0, []
    for cut in [*sorted(cuts), len(data)]:
        for line in cutter.feed(data[begin:cut]):
            found.append(line)
        begin = max(begin, cut)
    whole, _, rest = data.rpartition(b"\n") if b"\n" in data else (None, b"", data)
    expected = [] if whole is None else whole.split(b"\n")
    assert [line.text for line in found] == expected
    assert [line.number for line in found] == list(range(1, len(expected) + 1))
    assert cutter.consumed == len(data) - len(rest)
    tail = cutter.tail()
    assert (tail.text if tail else b"") == rest


@pytest.mark.parametrize("part", [1_000, 100_000])
def test_a_long_line_is_told_and_not_kept(part: int) -> None:
    """One line, with its number, whatever its length; the next one is read."""
    data = b"x" * 1_000_000 + b"\nshort\n"
    cutter = LineCutter()
    found = [line for at in range(0, len(data), part) for line in cutter.feed(data[at : at + part])]
    assert found == [Line(1, b"", f"longer than {LONGEST_LINE} bytes"), Line(2, b"short")]
    assert cutter.consumed == len(data)


def reader(*, inputs: bool = False, numbered: bool = False) -> Reader:
    """Of odometry."""
    return Reader(trusting(), {}, inputs=inputs, numbered=numbered, first={})


def said(text: str | bytes | dict[str, Any], **kind: bool) -> Message:
    """What one line says."""
    data = json.dumps(text).encode() if isinstance(text, dict) else text.encode() if isinstance(text, str) else text
    return reader(**kind).read(Line(1, data))


def test_a_record() -> None:
    """With its vehicle and number, or of the only one."""
    record = DistanceRecord(time_ms=100, end="front", unit="wheel", distance_mm=5)
    assert said(WHEEL) == RecordLine(Envelope("1"), record)
    assert said({"vehicle": "a-7", "number": 3, **WHEEL}) == RecordLine(Envelope("a-7", 3), record)


def test_a_measurement_that_is_none() -> None:
    """The device spoke: a fault of its channel."""
    text = json.dumps(WHEEL).replace("5}", "NaN}")
    assert said(text) == RecordLine(Envelope("1"), Unusable(100, "front_wheel", Reason.NOT_FINITE, "distance_mm: nan"))


def test_the_end_of_a_cycle() -> None:
    """Of the vehicle that says so."""
    assert said({"vehicle": "2", "kind": "cycle", "time_ms": 100}) == CycleEnd(Envelope("2"), 100)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not JSON"),
        (
            "time,odometer_mm",
            "not JSON (Expecting value: line 1 column 1 (char 0)); each line is one JSON object, docs/records.md",
        ),
        ("{", "not JSON"),
        ("[1]", "expected an object, got list"),
        (b"\xff\xfe", "not JSON"),
        ("[" * 100_000, "not JSON"),
        ('{"kind": "distance", "kind": "distance"}', "a name is given twice"),
        ({**WHEEL, "vehicle": "a b"}, "vehicle is 'a b'"),
        ({**WHEEL, "vehicle": 7}, "vehicle is 7; give up to"),
        ('{"vehicle": ' + "[" * 900 + "]" * 900 + "}", "vehicle is [[["),
        ({**WHEEL, "vehicle": "x" * 65}, "vehicle is"),
    ],
)
def test_lines_of_nobody_knows_whom(text: str | bytes | dict[str, Any], reason: str) -> None:
    """Refused with the reason, and no vehicle."""
    message = said(text)
    assert isinstance(message, Refused)
    assert message.reason.startswith(reason)
    assert message.vehicle is None


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"kind": "nonsense"}, "field kind"),
        ({**WHEEL, "time_ms": -1}, "field distance.time_ms"),
        ({**WHEEL, "extra": 1}, "field distance.extra"),
        ({**WHEEL, "number": 0}, "number is 0; count from 1"),
        ({**WHEEL, "number": 1.0}, "number is 1.0; count from 1"),
        ({**WHEEL, "number": 10**30}, "number is"),
        ({"kind": "cycle"}, "a line of kind cycle has only time_ms"),
        ({"kind": "cycle", "time_ms": 1.5}, "a line of kind cycle has only time_ms"),
        ({"kind": "cycle", "time_ms": 1, "more": 2}, "a line of kind cycle has only time_ms"),
    ],
)
def test_lines_of_a_vehicle_that_say_nothing(fields: dict[str, Any], reason: str) -> None:
    """Refused with the reason, and the vehicle they concern."""
    message = said({"vehicle": "7", **fields})
    assert isinstance(message, Refused)
    assert message.reason.startswith(reason)
    assert message.vehicle == "7"


def test_where_lines_may_be_lost_they_are_counted() -> None:
    """A line without a number is refused."""
    message = said(WHEEL, numbered=True)
    assert isinstance(message, Refused)
    assert message.reason.startswith("no number: lines may be lost on the way")


def test_steps() -> None:
    """Inputs by name; ghosts of a recording and the truth are no inputs."""
    fields = {"front_wheel_mm": 5, "true_cycle_distance_nm": 1, "truth_mm": 7, "front_wheel_next_wander_nm": 0}
    assert said(fields, inputs=True) == Step(Envelope("1"), None, {"front_wheel_mm": 5}, 7)
    numbered = {"vehicle": "a", "cycle": 3, "front_wheel_mm": 5}
    assert said(numbered, inputs=True) == Step(Envelope("a"), 3, {"front_wheel_mm": 5})


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"front_whel_mm": 5}, "odometry has no input 'front_whel_mm'"),
        ({"vehicle": "a", "front_wheel_mm": 5}, "no cycle: a step with a vehicle needs its cycle number"),
        ({"cycle": 0}, "cycle is 0; count from 1"),
        ({"truth_mm": 1.5}, "truth_mm is 1.5; give whole mm"),
        ({"schema": "other/1"}, "schema is 'other/1'"),
        (
            {"schema": "safeloc-stream/1", "machine": "balise"},
            "a stream of machine 'balise'; this process runs 'odometry'",
        ),
        ({"schema": "safeloc-stream/1", "first": {"mode": 2}}, "the stream begins with {'mode': 2}"),
        ({"schema": "safeloc-stream/1", "first": 5}, "`first` must be an object"),
        ({"schema": "safeloc-stream/1", "kept": "front_wheel_mm"}, "`kept` must be a list of inputs"),
        ({"schema": "safeloc-stream/1", "kept": ["front_whel_mm"]}, "odometry has no input 'front_whel_mm'"),
    ],
)
def test_steps_that_say_nothing(fields: dict[str, Any], reason: str) -> None:
    """A misspelt input is never taken for an absent one."""
    message = said(fields, inputs=True)
    assert isinstance(message, Refused)
    assert message.reason.startswith(reason)


def test_the_header_of_a_step_stream() -> None:
    """Nothing to do, if it is of this machine."""
    assert said({"schema": "safeloc-stream/1", "machine": "odometry", "first": {}}, inputs=True) == Header()


def test_counting() -> None:
    """What the numbers show: in order, again, before, lost, anew."""
    count = LineCount()
    assert [count.take(number) for number in (1, 2, 2, 1, 2, 5, 3, None, 6)] == [
        Counted(),
        Counted(),
        Counted("number 2 again"),
        Counted(lost="the sender's count restarted"),
        Counted(),
        Counted(lost="2 lines before 5"),
        Counted("number 3 after 5"),
        Counted("no number, after 5", "a line without a number"),
        Counted(),
    ]


@pytest.mark.parametrize(("number", "lost"), [(8, ""), (9, "1 lines before 9"), (None, "")])
def test_a_number_settles_what_was_unsure(number: int | None, lost: str) -> None:
    """After an interruption the next number says whether a line is missing; without numbers the doubt stays."""
    assert LineCount(7, "interrupted").take(number).lost == (lost if number else "a line without a number")
    assert LineCount(None, "interrupted").take(None) == Counted(lost="interrupted")
    assert LineCount(None, "met under way").take(40) == Counted(lost="met under way")
    assert LineCount(None, "met under way").take(1) == Counted()


def test_a_clock_that_was_set_is_believed_after_ten_cycles() -> None:
    """One wrong value is not, nor are values that do not follow each other."""
    pace = Pace(100, 1_000)
    streak = Streak(pace)
    assert not streak.goes_on(500_000)
    told = [streak.goes_on(500_000 + 100 * n) for n in range(1, OUT_OF_STEP_CYCLES + 1)]
    assert told == [False] * (OUT_OF_STEP_CYCLES - 1) + [True]
    jumping = Streak(pace)
    assert not any(jumping.goes_on(time_ms) for time_ms in (10**9, 10**12, 5, 10**7, 1, 10**15))
    streak.end()
    assert not streak.goes_on(501_100)


def test_cycles_are_aligned() -> None:
    """They end at whole periods; the end belongs to the cycle."""
    assert [Pace(100).beginning(time_ms) for time_ms in (0, 1, 100, 101, 250)] == [0, 0, 0, 100, 200]
