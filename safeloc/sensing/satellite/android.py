"""Reads epochs from the text layout of Android GnssLogger: `Raw` rows of GPS, QZSS and Galileo on 1575.42 MHz.

The `# Raw` header names the columns. Rows of another band (CarrierFrequencyHz) and other constellations are skipped.

Pseudorange = (receiver time - ReceivedSvTimeNanos) * c, in whole nanoseconds modulo the week (google/
gps-measurement-tools). The rate column is in m/s, positive if the distance grows.
"""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

from safeloc.errors import InputError, StreamError
from safeloc.runtime.outside import reading_file
from safeloc.sensing.satellite.epochs import Epoch, Measured, in_order
from safeloc.sensing.satellite.figures import L1_HZ, LIGHT_M_PER_S, WEEK_S
from safeloc.sensing.satellite.log_lines import decimal, integer, log_lines

_NANOS = 1_000_000_000
_TIME_OF_WEEK, _CODE_LOCK, _GALILEO_CODE_LOCK = 8, 1, 1024
_SYSTEMS = {"1": ("G", 0, _CODE_LOCK), "4": ("J", 192, _CODE_LOCK), "6": ("E", 0, _GALILEO_CODE_LOCK)}
"""ConstellationType -> letter, offset of Svid, bit of State for code lock."""
_BAND_HZ = 1e6
_NO_NUMBER = "not ASCII"
_Row = dict[str, str]


def read_android(path: Path) -> list[Epoch]:
    """Return all epochs. Rows without code lock or time of week are left out. StreamError names the file; NMEA is refused."""
    with reading_file(path, path.name):
        return _epochs(log_lines(path, "utf-8"), path)


def _epochs(lines: list[str], path: Path) -> list[Epoch]:
    header = next((line for line in lines if line.startswith("# Raw,")), None)
    if header is None:
        raise StreamError(f"{path.name}:1: no '# Raw' header; NMEA and position logs lack pseudorange and Doppler.")
    names = [name.strip() for name in header[2:].split(",")]
    rows = [_row(names, number, line, path) for number, line in enumerate(lines, 1) if line.startswith("Raw,")]
    try:
        return list(in_order(_epoch(list(group), path) for _, group in groupby(rows, key=lambda row: row["TimeNanos"])))
    except (KeyError, ValueError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise StreamError(f"{path.name}: {error}; mend or drop the row.") from error


def _row(names: list[str], number: int, line: str, path: Path) -> _Row:
    """Return a row by the names of its columns. Numbers need ASCII digits; text columns of another script are not read."""
    cells = [cell if cell.isascii() else _NO_NUMBER for cell in line.split(",")]
    if len(cells) > len(names):
        raise StreamError(f"{path.name}:{number}: {len(cells)} cells under {len(names)} columns; mend or drop the row.")
    return dict(zip(names, cells, strict=False))


def _epoch(rows: list[_Row], path: Path) -> Epoch:
    found: dict[str, Measured] = {}
    for row in rows:
        name = _tracked(row)
        if name in found:
            raise StreamError(f"{path.name}: {name} stands twice at {row['TimeNanos']} ns; drop the epoch.")
        if name is not None:
            found[name] = Measured(_pseudorange_m(row), decimal(row["PseudorangeRateMetersPerSecond"]))
    return Epoch(_receiver_nanos(rows[0]) / _NANOS, found)


def _tracked(row: _Row) -> str | None:
    """Return the satellite of a usable row; None for others."""
    letter, before, lock = _SYSTEMS.get(row["ConstellationType"], ("", 0, 0))
    state = integer(row["State"])
    if not (letter and state & lock and state & _TIME_OF_WEEK and _is_l1(row.get("CarrierFrequencyHz", ""))):
        return None
    return f"{letter}{integer(row['Svid']) - before:02d}"


def _is_l1(frequency_hz: str) -> bool:
    """Return whether the row is of L1; receivers of one band omit the frequency."""
    return not frequency_hz.strip() or abs(decimal(frequency_hz) - L1_HZ) < _BAND_HZ


def _receiver_nanos(row: _Row) -> int:
    return integer(row["TimeNanos"]) - integer(row["FullBiasNanos"])


def _pseudorange_m(row: _Row) -> float:
    week = WEEK_S * _NANOS
    travelled = (_receiver_nanos(row) - integer(row["ReceivedSvTimeNanos"]) + week // 2) % week - week // 2
    return (travelled + decimal(row["TimeOffsetNanos"]) - decimal(row["BiasNanos"])) / _NANOS * LIGHT_M_PER_S
