"""docs/telegrams.md says what is so: its programs run as written and print what their remarks say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.railway.telegrams.packets import BODIES

TEXT = (Path(__file__).resolve().parents[3] / "docs" / "telegrams.md").read_text(encoding="utf-8")


def test_the_programs_print_what_they_say(capsys: pytest.CaptureFixture[str]) -> None:
    """One after the other, as a reader would run them."""
    names: dict[str, object] = {}
    for program in re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL):
        exec(program, names)  # the page's own programs
        told = re.search(r"# ([\d ]+)$", program.strip(), re.MULTILINE)
        assert told is not None
        assert told.group(1) == capsys.readouterr().out.strip()


def test_the_table_names_every_packet() -> None:
    """By sender and number."""
    rows = re.findall(r"^\| (track|train) \| ([\d, ]+) \|", TEXT, re.MULTILINE)
    named = {(sender, int(number)) for sender, numbers in rows for number in numbers.split(",")}
    assert {*BODIES, ("track", 0), ("track", 255)} == named
