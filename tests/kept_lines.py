"""The file of a long run: one line a case, appended when it is done, and read again by a later start that goes on from it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def kept_lines(file: Path) -> list[dict[str, Any]]:
    """What stands in the file; a last line that a kill has cut off is left out, and cut off."""
    if not file.exists():
        return []
    text = file.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        file.write_text(whole, encoding="utf-8")
    return [json.loads(line) for line in whole.splitlines()]


def keep(file: Path, line: dict[str, Any]) -> None:
    """Append a case."""
    with file.open("a", encoding="utf-8") as opened:
        opened.write(json.dumps(line) + "\n")
