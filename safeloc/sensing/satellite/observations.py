"""Reads pseudorange and Doppler on 1575.42 MHz from RINEX 3 observation files (RINEX 3.04, tables A2 and A3).

GPS and QZSS L1 C/A, Galileo E1 (pilot, or data and pilot together). Other constellations and bands are skipped.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.runtime.outside import reading_file
from safeloc.sensing.satellite.epochs import Epoch, Measured, in_order
from safeloc.sensing.satellite.log_lines import decimal, integer, log_lines
from safeloc.sensing.satellite.predicted import rate_of_doppler
from safeloc.sensing.satellite.times import gps_seconds

_Columns = dict[str, tuple[int, int]]
_SIGNALS = {"G": ("1C",), "J": ("1C",), "E": ("1C", "1X", "1B")}


def read_observations(path: Path) -> list[Epoch]:
    """Return all epochs with the satellites of each. StreamError names file and line; NMEA is refused.

    InputError for epochs out of order or repeated.
    """
    with reading_file(path, path.name):
        lines = log_lines(path)
        _refuse_others(lines, path)
        end = next((i for i, line in enumerate(lines) if line[60:].strip() == "END OF HEADER"), None)
        if end is None:
            raise StreamError(f"{path.name}:1: the header does not end; mend the file.")
        return list(in_order(_epochs(lines, end + 1, _columns(lines[:end], path), path)))


def _refuse_others(lines: list[str], path: Path) -> None:
    first = lines[0] if lines else ""
    if first.startswith("$"):
        raise StreamError(f"{path.name}:1: NMEA has positions, but no pseudorange and no Doppler; record RINEX 3.")
    if not first[:9].strip().startswith("3") or first[20:21] != "O":
        raise StreamError(f"{path.name}:1: not a RINEX 3 observation file; convert it.")


def _columns(header: list[str], path: Path) -> _Columns:
    names: dict[str, list[str]] = {}
    system = ""
    for line in header:
        if line[60:].strip() == "SYS / # / OBS TYPES":
            system = line[0] if line[0] != " " else system
            names.setdefault(system, []).extend(line[7:60].split())
    found = {system: pair for system in _SIGNALS if (pair := _pair(system, names.get(system, []))) is not None}
    if not found:
        raise StreamError(f"{path.name}:1: no C1C and D1C of GPS, QZSS or Galileo among the types; record both.")
    return found


def _pair(system: str, names: list[str]) -> tuple[int, int] | None:
    """Return the columns of the first signal with both pseudorange and Doppler; None without one."""
    signal = next((one for one in _SIGNALS[system] if f"C{one}" in names and f"D{one}" in names), None)
    return None if signal is None else (names.index(f"C{signal}"), names.index(f"D{signal}"))


def _epochs(lines: list[str], at: int, columns: _Columns, path: Path) -> Iterator[Epoch]:
    while at < len(lines):
        head, count = _head(lines, at, path)
        body = lines[at + 1 : at + 1 + count]
        if len(body) < count:
            raise StreamError(f"{path.name}:{at + 1}: {count} satellites announced, {len(body)} follow; it is cut.")
        if head[31] in "01":
            yield Epoch(_time(head, f"{path.name}:{at + 1}"), _satellites(body, at + 2, columns, path))
        at += 1 + count


def _head(lines: list[str], at: int, path: Path) -> tuple[str, int]:
    count = lines[at][32:35].strip()
    if lines[at].startswith(">") and count.isdecimal():  # a negative count would lead back, without end
        return lines[at], int(count)
    raise StreamError(f"{path.name}:{at + 1}: no epoch starts here; mend the file.")


def _time(head: str, where: str) -> float:
    try:
        year, month, day, hour, minute, second = head[1:29].split()
        return gps_seconds(integer(year), integer(month), integer(day), integer(hour), integer(minute), decimal(second))
    except (ValueError, OverflowError) as error:
        raise StreamError(f"{where}: {head[1:29]!r} is no time ({error}); mend or drop the epoch.") from error


def _satellites(body: list[str], first: int, columns: _Columns, path: Path) -> dict[str, Measured]:
    found: dict[str, Measured] = {}
    for number, line in enumerate(body, first):
        if line[:1] not in columns:
            continue
        if line[:3] in found:
            raise StreamError(f"{path.name}:{number}: {line[:3]} stands twice in one epoch; drop the epoch.")
        found[line[:3]] = _measured(line, columns[line[0]], f"{path.name}:{number}")
    return found


def _measured(line: str, columns: tuple[int, int], where: str) -> Measured:
    texts = [line[3 + 16 * column : 17 + 16 * column].strip() for column in columns]
    try:
        code, doppler = (decimal(text) if text else None for text in texts)
        return Measured(code, None if doppler is None else rate_of_doppler(doppler))
    except ValueError as error:
        raise StreamError(f"{where}: {error}; mend or drop the epoch.") from error
