"""docs/balises.md says what is so: its programs run as written, and it names the outputs that there are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.catalogue import load_target

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "balises.md").read_text(encoding="utf-8")
TOLD, BESIDE = TEXT.split("## The last unlinked group")


def program_of(part: str) -> str:
    """The one program of a part of the page."""
    [program] = re.findall(r"```python\n(.*?)```", part, re.DOTALL)
    return str(program)


def test_the_groups_of_a_line_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    """An announcement and a telegram for each group of the line."""
    exec(program_of(TOLD), {})  # the page's own program
    lines = capsys.readouterr().out.splitlines()
    assert lines
    assert all("'linking_group'" in line and "'telegram_group'" in line for line in lines)


def test_the_way_left_is_what_the_remark_says(capsys: pytest.CaptureFixture[str]) -> None:
    """Of the program beside an unlinked group."""
    program = program_of(BESIDE)
    exec(program, {})  # the page's own program
    remark = re.search(r"# (\(.*\))$", program.strip(), re.MULTILINE)
    assert remark is not None
    assert remark.group(1) == capsys.readouterr().out.strip()


@pytest.mark.parametrize(("machine", "part"), [("balise", TOLD), ("unlinked_group", BESIDE)])
def test_the_tables_name_outputs_that_there_are(machine: str, part: str) -> None:
    """Of the unlinked group, every one."""
    table = part.partition("| output | meaning |")[2].partition("```")[0]
    names = {
        name for row in re.findall(r"^\| (`[^|]*) \|", table, re.MULTILINE) for name in re.findall(r"`(\w+)`", row)
    }
    outputs = set(load_target(machine).system.outputs)
    assert names <= outputs
    assert machine == "balise" or names == outputs
