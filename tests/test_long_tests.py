"""What takes hours is said in one place, and is there."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
TOPICS = dict(re.findall(r"^long-(\w+) = -m (\S+) ", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))


def test_each_topic_is_in_the_table() -> None:
    """With what it shows and its time."""
    page = (ROOT / "docs" / "long_tests.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    assert sorted(TOPICS) == sorted(row.split("`")[1] for row in rows)
    assert {6} == {len(row.split("|")) for row in rows}


def test_each_topic_is_a_module_with_a_file() -> None:
    """So that `make test-long` finds it, and an ended run goes on."""
    for name, module in TOPICS.items():
        found = importlib.util.find_spec(f"{module}.__main__" if (ROOT / module.replace(".", "/")).is_dir() else module)
        assert found is not None, name
    commands = re.findall(
        r"^long-(\w+) = .* --out long/(\w+)\.jsonl$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert [(name, name) for name in TOPICS] == commands
