"""A report says how it was made: command, limits, seed, and the commit of the folder."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import jsonschema
import pytest

from safeloc.report.data import schema
from safeloc.report.made_by import commit, made_by
from tests.cli.calling import DOOR, QUICK_VERIFY, caller


def test_the_command_can_be_typed_again() -> None:
    """With blanks and quotes as a shell needs them."""
    made = made_by(["prove", "own door.py:machine", "--seconds", "3"], {"depth": 25, "seed": 7})
    assert made["command"] == "safeloc prove 'own door.py:machine' --seconds 3"
    assert made["limits"] == {"depth": 25, "seed": 7}


def test_a_commit_is_told_and_whether_files_differ(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a repository its name; outside of one, why there is none."""
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert commit() == "none: the working folder is in no git repository, or git cannot be asked"
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
    (tmp_path / "own.py").write_text("x = 1\n", encoding="utf-8")
    for command in (["init", "-q"], ["add", "own.py"], ["commit", "-qm", "first"]):
        subprocess.run([*git, *command], check=True)
    clean = commit()
    assert len(clean) == 40
    (tmp_path / "own.py").write_text("x = 2\n", encoding="utf-8")
    assert commit() == f"{clean}, with changed files"


def test_without_git_the_report_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No git on this computer: no failure, no empty field."""
    monkeypatch.setenv("PATH", str(tmp_path))
    assert commit().startswith("none: ")


@pytest.mark.thorough
def test_verify_and_replay_say_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """In report.json, which keeps to its schema, and on the page."""
    call = caller(monkeypatch, capsys)
    folder = tmp_path / "report"
    call("verify", DOOR, *QUICK_VERIFY, "--seed", "3", "--out", str(folder))
    made = json.loads((folder / "report.json").read_text(encoding="utf-8"))["made_by"]
    assert made["command"].startswith("safeloc verify ")
    assert made["limits"] == {"depth": 25, "seconds": 10.0, "examples": 5, "steps": 15, "seed": 3}
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "depth 25, seconds 10.0, examples 5, steps 15, seed 3" in page
    jsonschema.validate(json.loads((folder / "report.json").read_text(encoding="utf-8")), schema())
