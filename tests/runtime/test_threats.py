"""docs/threats.md names tests and claims that are there, and a defence for every threat of EN 50159 at every interface."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.catalogue import load_target

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs" / "threats.md").read_text(encoding="utf-8")
THREATS = ["repetition", "deletion", "insertion", "re-sequencing", "corruption", "delay", "masquerade"]
CLAIMED = {4: "transmission", 5: "fibre_handover", 6: "balise"}
"""Columns of interfaces that a machine defends."""


def rows() -> dict[str, list[str]]:
    """The table's cells by threat."""
    table = TEXT.split("## Transmission, after EN 50159")[1].split("###")[0]
    cells = [
        [cell.strip() for cell in line.strip("|").split(" | ")] for line in table.splitlines() if line.startswith("| ")
    ]
    return {row[0]: row for row in cells[1:]}


def test_every_test_that_is_named_is_there() -> None:
    """Somewhere among the tests, as a function or as the file of its name."""
    named = set(re.findall(r"`(test_\w+)`", TEXT))
    files = list((ROOT / "tests").rglob("*.py"))
    known = {
        name
        for path in files
        for name in re.findall(r"^ *(?:async )?def (test_\w+)", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert len(named) > 30
    assert set() == named - known - {path.stem for path in files}


def test_every_threat_has_a_cell_for_every_interface() -> None:
    """Seven threats, six interfaces, none empty."""
    assert THREATS == list(rows())
    assert {7} == {len(row) for row in rows().values()}
    assert all(cell for row in rows().values() for cell in row)


def test_the_program_prints_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    """As a reader would run it."""
    [program] = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    exec(program, {})  # the page's own program
    assert "1000000 150 None" == capsys.readouterr().out.strip() == program.strip().rpartition("# ")[2]


@pytest.mark.parametrize("column", CLAIMED)
def test_every_claim_that_is_named_is_the_machines(column: int) -> None:
    """By its name in the catalogue."""
    known = {prop.name for prop in load_target(CLAIMED[column]).properties}
    claims = [
        name
        for row in rows().values()
        for part in re.findall(r"claims? ((?:`[^`]+`(?:, )?)+)", row[column])
        for name in re.findall(r"`([^`]+)`", part)
    ]
    assert len(claims) >= 4
    assert set() == set(claims) - known
