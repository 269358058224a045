"""docs/requirements_read_again.md judges every entry of the publications once, and names claims, tests and files that are there."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from safeloc.assurance.requirements import requirements
from safeloc.catalogue import ENTRIES
from tests.shipped import shipped

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "requirements_read_again.md").read_text(encoding="utf-8")
JUDGEMENTS = ("shown", "weak", "missing")
PUBLISHED = ("MRK", "RFL", "FWG", "FVA", "SAT")
FILE = re.compile(r"`((?:[\w-]+/)*[\w-]+\.(?:py|json))`")
QUOTED = re.compile(r'"([^"]+)"')


@dataclass(frozen=True)
class Row:
    """One entry of the page, cell by cell."""

    id: str
    shown: str
    claims: str
    rests_on: str
    wrong: str
    judgement: str

    @property
    def word(self) -> str:
        """The judgement in one word, or nothing."""
        found = re.match(r"\*\*(\w+)\*\*", self.judgement)
        return found[1] if found else ""

    @property
    def reason(self) -> str:
        """What follows the word."""
        return self.judgement.removeprefix(f"**{self.word}**").strip(" :.;,")


def rows(text: str) -> list[Row]:
    """The rows of all tables whose first cell is an id."""
    cells = [
        [cell.strip() for cell in line.strip("|").split(" | ")] for line in text.splitlines() if line.startswith("|")
    ]
    return [Row(*row) for row in cells if re.fullmatch(r"[A-Z]+-D?\d+", row[0])]


def named(cell: str) -> Iterator[tuple[str, str]]:
    """Each name in quotes with the file before it; no file where none stands before it in its part of the cell."""
    for part in cell.split(";"):
        file = FILE.search(part)
        for name in QUOTED.findall(part):
            yield file[1] if file else "", name


@cache
def claims() -> frozenset[tuple[str, str]]:
    """Every claim of every shipped machine: the file that makes it below `properties/`, and its name."""
    return frozenset(
        (prop.src.rpartition(":")[0].partition("/properties/")[2], prop.name)
        for name in ENTRIES
        for prop in shipped(name).properties
    )


@cache
def content(path: Path) -> str:
    """The file as text; empty if there is none."""
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def unknown_claims(row: Row) -> list[str]:
    """What the row names as a claim or test and is none."""
    return [
        f"{row.id}: {file} {name}"
        for file, name in named(row.claims)
        if not (name in content(ROOT / file) if file.startswith("tests/") else (file, name) in claims())
    ]


def unknown_machines(row: Row) -> list[str]:
    """What the row names as a wrong machine, and that stands in no test, or, tried by hand, is refused by nothing that the row names."""
    own = {name for _, name in named(row.claims)}
    tests = "".join(content(ROOT / one) for one in FILE.findall(row.claims) if one.startswith("tests/"))
    return [
        f"{row.id}: {file} {name}"
        for file, name in named(row.wrong)
        if not (name in content(ROOT / "tests" / file) if file else name in own or f"def {name}(" in tests)
    ]


def missing_files(row: Row) -> list[str]:
    """Files that the row names and that do not exist."""
    of_claims = [
        ROOT / one if one.startswith("tests/") else ROOT / "properties" / one for one in FILE.findall(row.claims)
    ]
    of_wrong = [ROOT / "tests" / one for one in FILE.findall(row.wrong)]
    return [f"{row.id}: {path.relative_to(ROOT)}" for path in (*of_claims, *of_wrong) if not path.is_file()]


def unfounded(row: Row) -> list[str]:
    """A judgement of no word of the three, one without what it has to say, or a row with nothing in a cell."""
    found = [] if row.word in JUDGEMENTS else ["no judgement"]
    if row.word in ("weak", "missing") and not re.search(r"\w.*\b[Mm]end", row.reason):
        found.append("no reason with what would mend it")
    if row.word == "shown" and not FILE.search(row.claims):
        found.append("shown by nothing")
    if not re.search(r"tried|`", row.wrong):
        found.append("no wrong machine, and not said that none was tried")
    return [f"{row.id}: {what}" for what in found] + [
        f"{row.id}: an empty cell" for cell in vars(row).values() if not cell
    ]


CHECKS = (unknown_claims, unknown_machines, missing_files, unfounded)


def faults(text: str) -> list[str]:
    """Everything that is wrong with a page."""
    found = rows(text)
    entries = [one.id for one in requirements() if one.id.partition("-")[0] in PUBLISHED]
    times = Counter(row.id for row in found)
    wrong = [f"{name}: {times[name]} times" for name in {*entries, *times} if times[name] != 1 or name not in entries]
    words = Counter(row.word for row in found)
    counts = "**{} are shown, {} are weak, {} are missing.**".format(*(words[word] for word in JUDGEMENTS))
    return [
        *wrong,
        *([] if counts in text else [f"the counts are {counts}"]),
        *(one for row in found for check in CHECKS for one in check(row)),
    ]


def test_the_page_is_in_step() -> None:
    """Every entry once, judged by one of three words, with a reason; what it names is there."""
    assert faults(TEXT) == []


@pytest.mark.parametrize(
    ("right", "wrong", "told"),
    [
        ("| MRK-2 |", "| MRK-99 |", "MRK-2: 0 times"),
        ("| MRK-2 |", "| MRK-1 |", "MRK-1: 2 times"),
        ('"M1 after the leading reading"', '"M1 after a reading"', "MRK-1: odometry/__init__.py M1 after a reading"),
        ("`turn_off.py`", "`turn_of.py`", "RFL-12: properties/turn_of.py"),
        ('"readers swapped"', '"readers mixed"', "MRK-1: models/test_odometry_wrong_edits.py readers mixed"),
        ('refused by "test_a_lost_corner_leaves_no_model"', 'refused by "test_it"', "RFL-10:  test_it"),
        ("**shown**: by the shape of", "**weak**: by the shape of", "RFL-10: no reason with what would mend it"),
        ("**shown** from the giving", "**good** from the giving", "FVA-D1: no judgement"),
    ],
)
def test_a_page_out_of_step_is_noticed(right: str, wrong: str, told: str) -> None:
    """An entry left out or twice, a claim, a file or an edit that is not there, a judgement without its reason."""
    assert TEXT.count(right) >= 1
    assert told in faults(TEXT.replace(right, wrong, 1))
