"""The tests stand where the source stands: who knows a module's folder knows the folder of its tests."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
ROOT = TESTS.parent
SOURCE = ROOT / "safeloc"

TESTED_ELSEWHERE = {
    "shipped_machines": "by the tests of all machines, tests/test_shipped_machines.py",
    "railway": "one file of declarations, tested where they are drawn, in tests/report",
    "templates/machine": "a project, tested as a whole in tests/templates",
    "templates/machine/tests": "the tests of a project",
    "templates/composition": "a project, tested as a whole in tests/templates",
    "templates/composition/tests": "the tests of a project",
    "templates/source": "a project, tested as a whole in tests/templates",
    "templates/source/tests": "the tests of a project",
}
"""Folders of the source without a folder of tests, and why."""

ONLY_TESTS = {
    "benchmarks": "tests of benchmarks/",
    "data": "files that tests read",
    "edits": "verdicts after edits, kept and new: every folder",
    "fuzz": "random machines against every back end: every folder",
    "fuzz_readers": "random files against every reader",
    "models/fibre_scenes": "scenes of sensing and machines together",
    "soak": "long runs of the service",
    "theorems": "machines and enumerations that prove what a machine that ships uses",
}
"""Folders of tests without a folder of the source, and what they are about."""


def folders(of: Path) -> set[str]:
    """The folders with modules of their own, by their path."""
    linked = ("models", "properties")
    found = {path.parent.relative_to(of) for path in of.rglob("*.py") if path.name != "__init__.py"}
    return {folder.as_posix() for folder in found if folder.parts and folder.parts[0] not in linked}


@pytest.mark.parametrize("folder", sorted(folders(SOURCE)))
def test_a_folder_of_the_source_has_tests_in_its_place(folder: str) -> None:
    """Or a reason stands here, and then there are none."""
    has_tests = any((TESTS / folder).glob("test_*.py"))
    assert has_tests != (folder in TESTED_ELSEWHERE)


def test_a_folder_of_tests_is_one_of_the_source() -> None:
    """Or a reason stands here."""
    below = [path for path in TESTS.rglob("test_*.py")]
    known = {path.parent.relative_to(TESTS) for path in below}
    named = [Path(name) for name in ONLY_TESTS]
    alone = {one for one in known if not any(one == name or name in one.parents for name in named)}
    assert {one.as_posix() for one in alone if not (SOURCE / one).is_dir()} == set()
    assert {name for name in ONLY_TESTS if (SOURCE / name).is_dir() or not (TESTS / name).is_dir()} == set()


def test_each_machine_is_spoken_of_by_tests_of_machines() -> None:
    """The tests of a machine import its folder, or load it by its name; they stand in tests/models, beside each other."""
    texts = [path.read_text(encoding="utf-8") for path in (TESTS / "models").glob("test_*.py")]
    machines = {path.parent.name for path in (ROOT / "models").glob("*/target.py")}
    assert machines
    assert {
        one for one in machines if not any(re.search(rf'\bmodels\.{one}\b|"{one}"', text) for text in texts)
    } == set()
