"""Writes a run as a file for other programs: tables for pandas, waves for GTKWave, messages for Foxglove."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from safeloc.errors import InputError
from safeloc.report.run_files import mcap, tables, vcd
from safeloc.report.run_files.columns import RunColumns

Write = Callable[[Path, RunColumns], None]
FORMATS: Mapping[str, Write] = {
    ".csv": tables.write_csv,
    ".parquet": tables.write_parquet_table,
    ".vcd": vcd.write_vcd,
    ".mcap": mcap.write_mcap,
}
"""Ending of a file -> what writes it."""


def format_of(path: Path) -> Write:
    """Return what writes a file of this ending. InputError for another one."""
    if path.suffix not in FORMATS:
        raise InputError(f"{path}: a run is written as {', '.join(FORMATS)}; give the file one of these endings.")
    return FORMATS[path.suffix]
