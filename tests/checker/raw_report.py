"""report.json as a test changes it: with the words of each result in place of numbers of earlier results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

SAID = ("statement", "method", "assumption")


def with_words(folder: Path) -> dict[str, Any]:
    """Return the content of report.json; a result may hold its own words, so it is still a report when it is written back."""
    data: dict[str, Any] = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    rows = data["results"]
    data["results"] = [
        {**row, **{field: row[field] if isinstance(row[field], str) else rows[row[field]][field] for field in SAID}}
        for row in rows
    ]
    return data
