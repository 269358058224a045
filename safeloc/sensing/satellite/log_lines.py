"""Reads the lines of a receiver's log, up to a limit, and the numbers in their cells."""

from __future__ import annotations

from pathlib import Path

from safeloc.runtime.outside import read_bytes, refuse_beyond

LARGEST_LOG = 500_000_000
MOST_LINES = 10_000_000
"""Bytes and lines of one log: some days of one epoch a second."""


def log_lines(path: Path, encoding: str = "ascii") -> list[str]:
    """Return all lines. Bytes outside the encoding become a character that no number has. InputError for too large a log."""
    data = read_bytes(path, LARGEST_LOG)
    refuse_beyond(path, data.count(b"\n") + data.count(b"\r"), MOST_LINES, "lines")
    return data.decode(encoding, errors="replace").splitlines()


def decimal(text: str) -> float:
    """Read a cell as a decimal number. ValueError for other text; Python alone would take `2_1` for 21."""
    return float(_plain(text))


def integer(text: str) -> int:
    """Read a cell as a whole number; ValueError as `decimal`."""
    return int(_plain(text))


def _plain(text: str) -> str:
    if "_" in text:
        raise ValueError(f"{text!r} is no number")
    return text
