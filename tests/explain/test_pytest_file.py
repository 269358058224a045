"""A saved test leads to its machine from every folder."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.explain.pytest_file import pytest_file, run_file
from safeloc.language.interpret import run
from tests.cli.calling import DOOR_FILE


def test_the_address_does_not_depend_on_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a machine in a file its whole path is written, of a shipped one its name."""
    shutil.copy(DOOR_FILE, tmp_path / "lamp.py")
    monkeypatch.chdir(tmp_path)
    target = load_target("lamp.py:machine")
    still = run(target.system, [])
    address = f'load_target("{(tmp_path / "lamp.py").as_posix()}:machine"'
    assert address in run_file(target, still, None)
    assert address in pytest_file(target, target.properties[0], still, None)
    configured = run_file(target, still, Path("lamp.toml"))
    assert str(tmp_path / "lamp.toml") in configured
    shipped = load_target("axle_head")
    assert 'load_target("axle_head")' in run_file(shipped, run(shipped.system, []), None)
