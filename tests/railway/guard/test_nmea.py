"""NMEA sentences as deliveries: position, speed, date, and what is no fix or no sentence."""

from __future__ import annotations

from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.nmea import nmea_deliveries

pytest.importorskip("pynmeagps")


def sentence(body: str) -> str:
    """With its checksum."""
    return f"${body}*{reduce(lambda sum_, letter: sum_ ^ ord(letter), body, 0):02X}\r\n"


def one_of(body: str, kind: str = "RMC") -> Delivery:
    """The one delivery of a sentence."""
    (found,) = nmea_deliveries([sentence(body)], kind)
    return found


def test_rmc() -> None:
    """Degrees from minutes, mm/s from knots, time with its date."""
    found = one_of("GPRMC,092726.20,A,5053.19326,N,00427.88308,E,10.000,,150322,,,A")
    assert 1_647_336_446_200 == found.time_ms
    assert (4.464718, 50.886554333) == pytest.approx((found.x, found.y), abs=1e-8)
    assert (5_144, "A", "") == (found.speed_mm_s, found.flag, found.wrong)


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        ("GPRMC,092726.20,V,,,,,,,150322,,,N", "RMC"),
        ("GPRMC,,V,,,,,,,,,,N", "RMC"),
        ("GPGGA,092725.00,,,,,0,00,99.99,,,,,,", "GGA"),
        ("GNGNS,092725.00,,,,,NN,00,99.99,,,,,", "GNS"),
        ("GPGLL,,,,,092321.00,V,N", "GLL"),
    ],
)
def test_no_fix(body: str, kind: str) -> None:
    """A sentence that says that there is no position is a delivery without one."""
    found = one_of(body, kind)
    assert (None, None, "") == (found.x, found.y, found.wrong)


@pytest.mark.parametrize(
    ("line", "wrong"),
    [
        ("$GPRMC,092726.20,A,5053.19326,N,00427.88308,E,10.000,,150322,,,A*00\n", "invalid checksum"),
        ("once upon a time\n", "no sentence"),
        ("$GPRMC,092726.20,A,5053\n", ""),
        (sentence("GPRMC,092726.20,A,5053.19326,N,00427.88308,E,9999999,,150322,,,A"), "no speed over ground"),
    ],
)
def test_lines_that_are_none(line: str, wrong: str) -> None:
    """Damaged sentences and other lines are told as such."""
    (found,) = nmea_deliveries([line])
    assert found.wrong
    assert wrong in found.wrong


def test_other_sentences_are_passed_over() -> None:
    """Only one kind makes the stream; proprietary ones are none of it."""
    lines = [sentence("GPGGA,092725.00,4717.11399,N,00833.91590,E,1,08,1.01,499.6,M,48.0,M,,"), sentence("PUBX,00,1")]
    assert [] == list(nmea_deliveries(lines))
    assert 1 == len(list(nmea_deliveries(lines, "GGA")))


def test_midnight_without_a_date() -> None:
    """A time of day that falls back by more than half a day is of the next day."""
    position = "4717.11399,N,00833.91590,E,1,08,1.01,499.6,M,48.0,M,,"
    lines = [sentence(f"GPGGA,{time},{position}") for time in ("235959.00", "000001.00", "000000.50")]
    first, second, third = (one.time_ms or 0 for one in nmea_deliveries(lines, "GGA"))
    assert (2_000, -500) == (second - first, third - second)


def test_an_unknown_kind_is_refused() -> None:
    """A sentence without a position makes no stream."""
    with pytest.raises(InputError, match="choose one of RMC, GGA, GNS, GLL"):
        list(nmea_deliveries([], "GSV"))


@given(st.lists(st.one_of(st.text(max_size=80), st.text(max_size=60).map(lambda body: f"$GPRMC,{body}")), max_size=6))
def test_any_text_is_read_to_its_end(lines: list[str]) -> None:
    """Whatever comes, the reader raises nothing."""
    for one in nmea_deliveries(lines):
        assert one.wrong or one.x is None or one.time_ms is not None
