"""report.json as a test changes it: with all fields of each result, and its words in place of numbers of earlier results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

SAID = ("statement", "method", "assumption", "requirements")
EMPTY: dict[str, Any] = {"assumption": "", "rechecked": [], "certificates": [], "requirements": [], "trace": None}


def with_words(folder: Path) -> dict[str, Any]:
    """Return the content of report.json; a result may hold its own words, so it is still a report when it is written back."""
    data: dict[str, Any] = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    rows = [{**EMPTY, **row} for row in data["results"]]
    data["results"] = [
        {**row, **{field: rows[row[field]][field] if type(row[field]) is int else row[field] for field in SAID}}
        for row in rows
    ]
    return data
