"""The machines of docs/language.md are proved as they stand there."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.cli.calling import QUICK, Call

TEXT = (Path(__file__).parents[2] / "docs" / "language.md").read_text(encoding="utf-8")
BLOCKS = [block for block in re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL) if "from safeloc import" in block]


@dataclass(frozen=True)
class Shown:
    """A machine of the page: the name that holds it, a line that its proof prints, and a law that its proof needs, if any."""

    name: str
    proved: str
    law: str = ""


SHOWN = (
    Shown("counter", "counter/property/by the step at most"),
    Shown("barrier", "barrier/lemma/lowered as long as counted", "stroke >= 100"),
    Shown("vehicle", "vehicle/lemma/contract of door holds", "minimum(measured, 40_000)"),
)


def test_every_block_is_tried() -> None:
    """In the order of the page."""
    assert len(BLOCKS) == len(SHOWN)
    assert all(f"\n{shown.name} = " in block for shown, block in zip(SHOWN, BLOCKS, strict=True))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("shown", "block"), [*zip(SHOWN, BLOCKS, strict=True)], ids=[one.name for one in SHOWN])
def test_it_is_proved(call: Call, tmp_path: Path, shown: Shown, block: str) -> None:
    """As printed, by the command line; what the page says of it is among the findings."""
    path = tmp_path / f"{shown.name}_of_the_page.py"
    path.write_text(block, encoding="utf-8")
    called = call("prove", f"{path}:{shown.name}", *QUICK)
    assert (called.code, called.out.splitlines()[-1][:9]) == (0, "all holds"), called.out
    assert f"proved    {shown.proved}" in called.out


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("shown", "block"), list(zip(SHOWN, BLOCKS, strict=True))[1:], ids=["barrier", "vehicle"])
def test_its_law_is_needed(call: Call, tmp_path: Path, shown: Shown, block: str) -> None:
    """A weaker law, or a weaker neighbour, and the proof is gone: the examples show what they say."""
    weaker = {"stroke >= 100": "stroke >= 99", "minimum(measured, 40_000)": "minimum(measured, 40_001)"}[shown.law]
    assert block.count(shown.law) == 1
    path = tmp_path / f"{shown.name}_made_weaker.py"
    path.write_text(block.replace(shown.law, weaker), encoding="utf-8")
    assert call("prove", f"{path}:{shown.name}", *QUICK).code != 0


def test_only_one_clause_is_discharged(call: Call, tmp_path: Path) -> None:
    """The other one stays an assumption, as the page says."""
    path = tmp_path / "discharged.py"
    path.write_text(BLOCKS[2], encoding="utf-8")
    listed = call("list", "assumptions", f"{path}:vehicle").out
    assert "vehicle/door/A1  speed is limited  (guaranteed by another machine)\n" in listed
    assert "vehicle/door/A2  contacts are dry\n" in listed
