"""Reads GPS, QZSS and Galileo ephemerides from RINEX navigation files, versions 2 and 3.

RINEX 3.04, tables A6 to A8 and A12; RINEX 2.11, table A4. Other constellations are skipped: their orbits have other parameters
(GLONASS, SBAS) or need another frame (BeiDou).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

from safeloc.errors import InputError, StreamError
from safeloc.runtime.outside import reading_file
from safeloc.sensing.satellite.atmosphere import Four, Klobuchar
from safeloc.sensing.satellite.ephemeris import FIT_HOURS, Ephemeris, usable
from safeloc.sensing.satellite.epochs import Epoch
from safeloc.sensing.satellite.log_lines import decimal, integer, log_lines
from safeloc.sensing.satellite.predicted import Signal, predicted
from safeloc.sensing.satellite.times import gps_seconds, of_week

_LINES = {"G": 8, "E": 8, "C": 8, "J": 8, "I": 8, "R": 4, "S": 4}
_READ = "GEJ"
_F_NAV_BIT = 0b10


@dataclass(frozen=True)
class Navigation:
    """The ephemerides of a file, and its broadcast ionosphere; None if it has none."""

    ephemerides: tuple[Ephemeris, ...]
    ionosphere: Klobuchar | None

    def valid(self, satellite: str, time_s: float) -> Ephemeris | None:
        """Return the valid ephemeris nearest in time; None, and so no prediction, if all have expired (SAT-D1)."""
        return usable(self._of.get(satellite, ()), satellite, time_s)

    def signals(self, epoch: Epoch) -> dict[str, Signal]:
        """Return how the signal of each satellite of an epoch with a valid ephemeris is predicted."""
        found = ((name, self.valid(name, epoch.time_s)) for name in epoch.satellites)
        return {name: partial(predicted, one, ionosphere=self.ionosphere) for name, one in found if one is not None}

    @cached_property
    def _of(self) -> dict[str, list[Ephemeris]]:
        found: dict[str, list[Ephemeris]] = {}
        for one in self.ephemerides:
            found.setdefault(one.satellite, []).append(one)
        return found


def read_navigation(path: Path) -> Navigation:
    """Return all GPS, QZSS and Galileo records. StreamError names file and line."""
    with reading_file(path, path.name):
        return _navigation(log_lines(path), path)


def _navigation(lines: list[str], path: Path) -> Navigation:
    end = next((i for i, line in enumerate(lines) if line[60:].strip() == "END OF HEADER"), None)
    version = lines[0][:9].strip() if lines else ""
    if end is None or version[:1] not in ("2", "3") or "NAV" not in lines[0][20:60]:
        raise StreamError(f"{path.name}:1: not a RINEX 2 or 3 navigation file; NMEA and others lack the ephemerides.")
    records = _records_2(lines, end, path) if version.startswith("2") else _records_3(lines, end, path)
    return Navigation(tuple(_record(*one, path) for one in records), _ionosphere(lines[:end]))


def _records_2(lines: list[str], end: int, path: Path) -> Iterator[tuple[int, str, str, list[str]]]:
    for at in range(end + 1, len(lines), 8):
        head = lines[at]
        if len(lines) < at + 8 or not (head[:2].strip().isdigit() and head[3:5].strip().isdigit()):
            raise StreamError(f"{path.name}:{at + 1}: no record starts here, or it is cut short; mend the file.")
        year = _year(head[2:5], f"{path.name}:{at + 1}")
        date = f"{2000 + year if year < 80 else 1900 + year}{head[5:22]}"
        yield at + 1, f"G{int(head[:2]):02d}", date, [head[22:], *(line[3:] for line in lines[at + 1 : at + 8])]


def _year(text: str, where: str) -> int:
    if not text.strip().isdecimal():
        raise StreamError(f"{where}: {text!r} is no year of two digits; mend or drop the record.")
    return int(text)


def _records_3(lines: list[str], end: int, path: Path) -> Iterator[tuple[int, str, str, list[str]]]:
    at = end + 1
    while at < len(lines):
        head = lines[at]
        size = _LINES.get(head[:1])
        if size is None or at + size > len(lines):
            raise StreamError(f"{path.name}:{at + 1}: no record starts here, or it is cut short; mend the file.")
        if head[0] in _READ:
            yield at + 1, head[:3], head[4:23], [head[23:], *(line[4:] for line in lines[at + 1 : at + 8])]
        at += size


def _record(line: int, satellite: str, date: str, fields: list[str], path: Path) -> Ephemeris:
    try:
        return _ephemeris(satellite, date, [_numbers(field) for field in fields])
    except (ValueError, IndexError, OverflowError) as error:
        raise StreamError(f"{path.name}:{line}: record of {satellite}: {error}; mend or drop it.") from error


def _ephemeris(satellite: str, date: str, rows: list[list[float]]) -> Ephemeris:
    year, month, day, hour, minute, second = date.split()
    clock, one, two, three, four, five, six, seven = rows
    european = satellite.startswith("E")
    fit = seven[1] if len(seven) > 1 and seven[1] > 0 and not european else FIT_HOURS
    return Ephemeris(
        satellite=satellite,
        clock_time_s=gps_seconds(
            integer(year), integer(month), integer(day), integer(hour), integer(minute), decimal(second)
        ),
        af0_s=clock[0],
        af1=clock[1],
        af2_per_s=clock[2],
        crs_m=one[1],
        delta_n=one[2],
        m0=one[3],
        cuc=two[0],
        eccentricity=two[1],
        cus=two[2],
        sqrt_a=two[3],
        orbit_time_s=of_week(int(five[2]), three[0]),
        cic=three[1],
        omega0=three[2],
        cis=three[3],
        i0=four[0],
        crc_m=four[1],
        omega=four[2],
        omega_dot=four[3],
        idot=five[0],
        healthy=six[1] == 0,
        group_delay_s=_european_delay_s(five, six) if european else six[2],
        sent_s=of_week(int(five[2]), seven[0]),
        fit_hours=max(fit, FIT_HOURS),
    )


def _european_delay_s(five: list[float], six: list[float]) -> float:
    """Return the broadcast group delay for the clock of the message: E5a/E1 for F/NAV, E5b/E1 for I/NAV (RINEX 3.04, table A8)."""
    return six[2] if int(five[1]) & _F_NAV_BIT else six[3]


def _numbers(text: str) -> list[float]:
    cells = (text[at : at + 19] for at in range(0, len(text.rstrip()), 19))
    return [decimal(cell.replace("D", "E").replace("d", "e")) for cell in cells if cell.strip()]


def _ionosphere(header: list[str]) -> Klobuchar | None:
    found = {
        name: _four(line, start)
        for line in header
        for name, mark, start in (("a", "GPSA", 5), ("b", "GPSB", 5), ("a", "ION ALPHA", 2), ("b", "ION BETA", 2))
        if line.startswith(mark) or line[60:].startswith(mark)
    }
    return Klobuchar(found["a"], found["b"]) if {"a", "b"} <= found.keys() else None


def _four(line: str, start: int) -> Four:
    try:
        a, b, c, d = (decimal(line[at : at + 12].replace("D", "E")) for at in range(start, start + 48, 12))
    except ValueError as error:
        raise InputError(f"ionosphere coefficients cannot be read from {line!r}; mend the header.") from error
    return a, b, c, d
