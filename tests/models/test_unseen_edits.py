"""Wrong edits that were written down before any claim was read, and some of readers of the requirements: each is refused, or loses the
claim, the lemma or the test named beside it.

`unseen_edits.json` has them as text: file under models/ (or below safeloc/), what stands there, what a tired engineer writes instead, and who
notices. Each is made in a copy of the package. An edit whose text is no longer there has to be written anew, or dropped with a reason.
One more of the set, standing believed by the radar alone, is in test_motion_wrong_edits.py.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
EDITS: list[dict[str, Any]] = json.loads(Path(__file__).with_name("unseen_edits.json").read_text(encoding="utf-8"))
ASK = """
import json, sys
from pathlib import Path
from safeloc.catalogue import load_target
from safeloc.errors import SafelocError
from tests.models.inductive import inductive_in
from tests.models.wrong_edits import lost_by
name, claim, figures, proving = json.loads(sys.argv[1])
try:
    target = load_target(name, Path(figures) if figures else None)
except SafelocError as refused:
    print(json.dumps("refused: " + str(refused)))
    sys.exit()
named = {one.name: one for one in target.properties}
prop = named.get(claim) or target.properties[0]
lost = claim in lost_by(target.system, target.properties, claim) if proving else not inductive_in(target.system, prop, claim)
print(json.dumps(lost))
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package that can be edited."""
    copy = tmp_path_factory.mktemp("package")
    for part in ("safeloc", "models", "properties", "tests"):
        shutil.copytree(ROOT / part, copy / part, symlinks=True, ignore=shutil.ignore_patterns("__pycache__", "*.gz"))
    shutil.copy(ROOT / "pyproject.toml", copy)
    return copy


def file_of(edit: dict[str, Any], root: Path) -> Path:
    """The file that an edit changes."""
    return root / edit["file"] if edit["file"].startswith("safeloc/") else root / "models" / edit["file"]


def noticed(package: Path, edit: dict[str, Any]) -> bool | str:
    """Whether the package as it stands loses the claim, the lemma or the test, or why it is refused."""
    environment = {**os.environ, "PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1"}
    if "target" not in edit:
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "--disable-plugin-autoload",
            "-p",
            "xdist",
            "-p",
            "hypothesispytest",
            edit["refused_by"],
        ]
        tested = subprocess.run(command, capture_output=True, text=True, check=False, cwd=package, env=environment)
        assert tested.returncode in (0, 1), tested.stdout
        return tested.returncode == 1
    figures = package / "figures.json"
    figures.write_text(json.dumps(edit.get("figures", {})), encoding="utf-8")
    asked = (
        edit["target"],
        edit["refused_by"],
        str(figures) if "figures" in edit else "",
        edit.get("by_the_prover", False),
    )
    ran = subprocess.run(
        [sys.executable, "-c", ASK, json.dumps(asked)], capture_output=True, text=True, check=True, cwd=package,
        env=environment,
    )  # fmt: skip
    answer: bool | str = json.loads(ran.stdout.splitlines()[-1])
    return answer


def test_every_edit_can_be_made() -> None:
    """What an edit replaces stands in its file exactly once."""
    there = {one["what"]: file_of(one, ROOT).read_text(encoding="utf-8").count(one["right"]) for one in EDITS}
    assert {what: count for what, count in there.items() if count != 1} == {}


@pytest.mark.slow
@pytest.mark.parametrize("edit", EDITS, ids=[one["what"] for one in EDITS])
def test_a_wrong_edit_is_noticed(edit: dict[str, Any], package: Path) -> None:
    """After the edit the machine is refused or the claim or lemma is lost; before it, it is kept."""
    path, claim = file_of(edit, package), edit["refused_by"]
    right = path.read_text(encoding="utf-8")
    path.write_text(right.replace(edit["right"], edit["wrong"]), encoding="utf-8")
    try:
        after = noticed(package, edit)
    finally:
        path.write_text(right, encoding="utf-8")
    if claim:
        assert (True, False) == (after, noticed(package, edit))
    else:
        assert str(after).startswith("refused: ")
