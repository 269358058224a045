"""A new machine touches its own folder, its properties and the requirements, and no list: tried in a copy of the repository.

The machine is `standstill` of tests/data/new_machine.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES
from safeloc.target import Family

ROOT = Path(__file__).parents[1]
NEW = Path(__file__).parent / "data" / "new_machine"
REQUIREMENTS = "safeloc/assurance/requirements.toml"
LEFT_OUT = shutil.ignore_patterns(".*", "__pycache__", "*.egg-info", "build", "dist", "safeloc-*", "long")
OF_ALL_MACHINES = (
    "tests/test_architecture.py",
    "tests/test_architecture_picture.py",
    "tests/test_catalogue.py",
    "tests/test_glossary.py",
    "tests/test_packaging.py",
    "tests/test_reported.py",
    "tests/assurance/test_independence.py",
    "tests/assurance/test_requirements.py",
    "tests/assurance/splits/test_splits.py",
    "tests/cli/test_commands.py",
    "tests/models/test_absent_positions.py",
    "tests/models/test_laws.py",
    "tests/models/test_recordings.py",
    "tests/proof/provers/test_certificate_names.py",
    "tests/runtime/embedding/test_silence.py",
)
"""Tests that look at every machine, or at the house."""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the machine in it: files that are new, and requirements at the end of their file."""
    root = tmp_path_factory.mktemp("copy") / "safeloc"
    shutil.copytree(ROOT, root, symlinks=True, ignore=LEFT_OUT)
    for tree in ("models", "properties"):
        shutil.copytree(NEW / tree, root / tree, dirs_exist_ok=True, ignore=LEFT_OUT)
    with (root / REQUIREMENTS).open("a", encoding="utf-8") as catalogue:
        catalogue.write((NEW / "requirements.toml").read_text(encoding="utf-8"))
    return root


def said(copy: Path, *arguments: str) -> str:
    """What Python prints with the copy as its safeloc; the exit code is 0."""
    own = {**os.environ, "PYTHONPATH": str(copy)}
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False, cwd=copy, env=own)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_it_is_listed_in_its_family(copy: Path) -> None:
    """It states no place, so it stands last in its family; no other machine moves."""
    names = [one["name"] for one in json.loads(said(copy, "-m", "safeloc", "list", "--json"))]
    assert names.index("standstill") == 1 + names.index("marker_device")
    assert list(ENTRIES) == [name for name in names if name != "standstill"]


def test_it_is_proved(copy: Path) -> None:
    """By its name, with all that is proved of every machine."""
    told = said(copy, "-m", "safeloc", "prove", "standstill")
    assert "standstill/property/standing" in told
    assert "standstill/property/may stand" in told


def test_its_requirement_is_traced(copy: Path) -> None:
    """To its transitions and its properties; nothing is missing."""
    code = (
        "from safeloc.assurance.requirements import traceability; from safeloc.catalogue import load_target;"
        "found = traceability([load_target('standstill')]);"
        "[link] = [one for one in found.links if one.requirement.id == 'OWN-1'];"
        "print(len(link.transitions), len(link.properties), [gap for gap in found.gaps if 'OWN' in gap])"
    )
    assert "5 2 []" == said(copy, "-c", code).strip()


def test_its_folder_is_packaged(copy: Path) -> None:
    """setup.py finds it."""
    code = "import setup; print([name for name in setup.packages() if 'standstill' in name])"
    assert "['safeloc.models.standstill']" == said(copy, "-c", code).strip()


def test_the_readme_has_a_row_for_each_family_and_none_for_a_machine() -> None:
    """In the order of `safeloc list`."""
    table = (ROOT / "README.md").read_text(encoding="utf-8").partition("| family | locates by |\n|---|---|\n")[2]
    rows = [line.split("|")[1].strip() for line in table.partition("\n\n")[0].splitlines()]
    assert [family.value for family in Family] == rows


@pytest.mark.slow
def test_the_tests_of_all_machines_accept_it(copy: Path) -> None:
    """In the copy, with nothing else touched."""
    assert "passed" in said(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow", *OF_ALL_MACHINES)
