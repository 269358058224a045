"""Recorded data that nobody here made: read where they are, never copied; tests skip visibly without them."""

from __future__ import annotations

import csv
import math
from datetime import datetime
from itertools import pairwise
from pathlib import Path

import pytest

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


def data_file(name: str) -> Path:
    """A recorded file; skips the test where the recordings are not at hand."""
    path = DATA / name
    if not path.is_file():
        pytest.skip(f"recorded data {name} is not at hand")
    return path


def rows(name: str) -> list[dict[str, str]]:
    """All rows of a CSV file."""
    with data_file(name).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def log_steps_mm(name: str, period_ms: int = 400) -> list[int | None]:
    """Distances between successive fixes of a train log, in mm; None where a fix is missing in between."""
    fixes = [
        (datetime.fromisoformat(row["timestamp"]), float(row["lambert72_x"]), float(row["lambert72_y"]))
        for row in rows(name)
    ]
    steps: list[int | None] = []
    for (before, x0, y0), (after, x1, y1) in pairwise(fixes):
        elapsed_ms = round((after - before).total_seconds() * 1000)
        steps.append(round(math.hypot(x1 - x0, y1 - y0) * 1000) if elapsed_ms == period_ms else None)
    return steps
