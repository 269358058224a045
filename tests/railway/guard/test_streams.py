"""Position streams: every line becomes a delivery, or says why it is none; the reader never stops at one."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError, StreamError
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.fields import Columns, columns_of, milliseconds
from safeloc.railway.guard.streams import csv_deliveries, jsonl_deliveries

COLUMNS = Columns(time="t", x="x", y="y", speed="v", flag="q", received="r", no_fix=frozenset({"NONE"}))
HEAD = "t,x,y,v,q,r"


def of_csv(*rows: str, columns: Columns = COLUMNS) -> list[Delivery]:
    """The deliveries of rows under the head."""
    return list(csv_deliveries([f"{line}\n" for line in (HEAD, *rows)], columns, "s.csv"))


def test_a_row() -> None:
    """Time, coordinates, speed in mm/s, flag, and when it came."""
    assert [Delivery(2, 1_500, 4.5, 50.9, 12_340, "FIXED", 1_600)] == of_csv("1500,4.5,50.9,12.34,FIXED,1600")


@pytest.mark.parametrize(
    ("row", "wrong"),
    [
        ("1500,4.5", "2 cells under 6 columns"),
        (",4.5,50.9,,,", "'t' is empty."),
        ("soon,4.5,50.9,,,", "'t': 'soon' is no number."),
        ("nan,4.5,50.9,,,", "'t': 'nan' is no time."),
        ("1500,west,50.9,,,", "'x': 'west' is no number."),
        ("1500,4.5,50.9,-1,,", "'v': '-1' m/s is no speed over ground."),
        ("1500,4.5,50.9,nan,,", "'v': 'nan' m/s is no speed over ground."),
        ("1500,4.5,50.9,,,late", "'r': 'late' is no number."),
        ("2022-13-01T00:00:00,4.5,50.9,,,", "'t': '2022-13-01T00:00:00' is no time (ISO 8601)."),
    ],
)
def test_rows_that_are_none(row: str, wrong: str) -> None:
    """What is wrong is told in the delivery, and the next row is read."""
    first, second = of_csv(row, "1500,4.5,50.9,,,")
    assert (wrong, "") == (first.wrong, second.wrong)


def test_no_position() -> None:
    """Empty coordinates and a flag that means none are deliveries without a position."""
    found = of_csv("1,,,,,", "2,4.5,50.9,,NONE,", "3,4.5,,,,")
    assert [(None, None)] * 3 == [(one.x, one.y) for one in found]


def test_not_finite_comes_through() -> None:
    """NaN and infinities are left to the guard, which withholds them by name."""
    found = of_csv("1,nan,50.9,,,", "2,4.5,-inf,,,")
    assert (True, -math.inf) == (math.isnan(found[0].x or 0), found[1].y)


def test_quotes_that_never_close_and_other_rubbish() -> None:
    """Broken quotes, NUL and an endless line are deliveries too."""
    found = of_csv('1,"4.5,50.9,,,', "2,4.5,50.9,,,", "\0,,,,,")
    assert found
    assert all(one.wrong for one in found)
    assert "" != of_csv("9" * 200_000)[0].wrong


def test_missing_and_double_columns() -> None:
    """A stream whose head does not fit is refused with its name."""
    with pytest.raises(StreamError, match=r"^s.csv:1: column 'v' is missing; there are t, x, y, q, r\.$"):
        list(csv_deliveries(["t,x,y,q,r\n"], COLUMNS, "s.csv"))
    with pytest.raises(StreamError, match="column 'x' is there twice"):
        list(csv_deliveries(["t,x,x,y,v,q,r\n"], COLUMNS, "s.csv"))


def test_json_lines() -> None:
    """Objects are read by their keys; what is no object is told."""
    lines = [
        '{"t": 1500, "x": 4.5, "y": 50.9, "v": 1, "q": "A"}\n',
        "[1]\n",
        "\n",
        "{\n",
        '{"t": 1, "x": true, "y": 1}\n',
    ]
    found = list(jsonl_deliveries(lines, COLUMNS))
    assert Delivery(1, 1_500, 4.5, 50.9, 1_000, "A") == found[0]
    assert ["expected an object, got list", "'x': True is no number."] == [found[1].wrong, found[3].wrong]
    assert found[2].wrong.startswith("not JSON")


@pytest.mark.parametrize(
    ("value", "unit", "ms"),
    [
        ("1970-01-01T00:00:01.5", "ms", 1_500),
        ("1970-01-01T01:00:00+01:00", "ms", 0),
        ("1970-01-01 00:00:00.0009", "ms", 0),
        ("1.9999", "ms", 1),
        ("1.2345", "s", 1_234),
        ("-0.0001", "s", -1),
        (1_647_335_426.2, "s", 1_647_335_426_200),
        (7, "ms", 7),
        ("1e-999999999", "s", 0),
    ],
)
def test_times(value: object, unit: str, ms: int) -> None:
    """ISO 8601, UTC where no zone is told, or a number; rounded down, so that an age is never too small."""
    assert abs(ms - milliseconds("t", value, unit)) <= (1 if isinstance(value, float) else 0)


@pytest.mark.parametrize(
    ("told", "message"),
    [
        (["z=alt"], "expected WHAT=NAME"),
        (["x"], "expected WHAT=NAME"),
        (["x=a", "x=b"], "'x' is given twice"),
    ],
)
def test_wrong_columns(told: list[str], message: str) -> None:
    """What is no column is refused."""
    with pytest.raises(InputError, match=message):
        columns_of(told, time_unit="ms", speed_unit="m/s", no_fix=[])


@pytest.mark.parametrize(("time_unit", "speed_unit"), [("min", "m/s"), ("s", "furlongs")])
def test_wrong_units(time_unit: str, speed_unit: str) -> None:
    """Unknown units are refused with those that there are."""
    with pytest.raises(InputError, match="choose one of"):
        columns_of([], time_unit=time_unit, speed_unit=speed_unit, no_fix=[])


@given(st.lists(st.text(max_size=60), max_size=8))
def test_any_text_is_read_to_its_end(lines: list[str]) -> None:
    """Whatever comes, the readers raise nothing and give whole or wrong deliveries."""
    for one in (*csv_deliveries([f"{HEAD}\n", *lines], COLUMNS, "s.csv"), *jsonl_deliveries(lines, COLUMNS)):
        assert one.wrong or one.time_ms is not None
