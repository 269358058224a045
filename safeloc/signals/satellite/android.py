"""Epochs from the public Android GnssLogger text layout: GPS `Raw` rows, columns found by the `# Raw` header.

Pseudorange = (receiver time - ReceivedSvTimeNanos) * c, in whole nanoseconds modulo the week (google/
gps-measurement-tools). The rate column is in m/s and positive when the distance grows.
"""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.signals.satellite.epochs import Epoch, Measured, in_order
from safeloc.signals.satellite.figures import LIGHT_M_PER_S, WEEK_S

_NANOS = 1_000_000_000
_CODE_LOCK_AND_TIME_OF_WEEK = 1 | 8
_GPS = "1"
Row = dict[str, str]


def read_android(path: Path) -> list[Epoch]:
    """All epochs. Rows without code lock or time of week are left out. StreamError names the file; NMEA is refused."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    header = next((line for line in lines if line.startswith("# Raw,")), None)
    if header is None:
        raise StreamError(f"{path.name}:1: no '# Raw' header; NMEA and position logs lack pseudorange and Doppler.")
    names = [name.strip() for name in header[2:].split(",")]
    rows = [dict(zip(names, line.split(","), strict=False)) for line in lines if line.startswith("Raw,")]
    try:
        return list(in_order(_epoch(list(group), path) for _, group in groupby(rows, key=lambda row: row["TimeNanos"])))
    except (KeyError, ValueError) as error:
        raise StreamError(f"{path.name}: {error}; mend or drop the row.") from error


def _epoch(rows: list[Row], path: Path) -> Epoch:
    found: dict[str, Measured] = {}
    for row in rows:
        if row["ConstellationType"] == _GPS and int(row["State"]) & 9 == _CODE_LOCK_AND_TIME_OF_WEEK:
            name = f"G{int(row['Svid']):02d}"
            if name in found:
                raise StreamError(f"{path.name}: {name} stands twice at {row['TimeNanos']} ns; drop the epoch.")
            found[name] = Measured(_pseudorange_m(row), float(row["PseudorangeRateMetersPerSecond"]))
    return Epoch(_receiver_nanos(rows[0]) / _NANOS, found)


def _receiver_nanos(row: Row) -> int:
    return int(row["TimeNanos"]) - int(row["FullBiasNanos"])


def _pseudorange_m(row: Row) -> float:
    week = WEEK_S * _NANOS
    travelled = (_receiver_nanos(row) - int(row["ReceivedSvTimeNanos"]) + week // 2) % week - week // 2
    return (travelled + float(row["TimeOffsetNanos"]) - float(row["BiasNanos"])) / _NANOS * LIGHT_M_PER_S
