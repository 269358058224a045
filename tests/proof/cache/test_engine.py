"""The engine's digest covers all code that a finding comes through: followed from import to import."""

from __future__ import annotations

import ast
import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from safeloc.proof.cache import engine
from safeloc.proof.cache.engine import DECLARING, PACKAGE, SHOWING, engine_digest, source_digest

BEGINS = ("safeloc/proof/verification/many.py", "safeloc/proof/verification/one.py", "safeloc/catalogue.py")
LOADED_BY_NAME = ("safeloc/catalogue.py",)
"""What it imports beside the engine are the machines that it hands out, which a target's own digest covers."""


def imported(path: Path) -> Iterator[Path]:
    """The package's files that a file imports, wherever in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [one.name for one in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names = [node.module, *(f"{node.module}.{one.name}" for one in node.names)]
        for name in names:
            parts = name.split(".")
            for file in (
                PACKAGE.parent.joinpath(*parts).with_suffix(".py"),
                PACKAGE.parent.joinpath(*parts, "__init__.py"),
            ):
                if parts[0] == "safeloc" and file.is_file():
                    yield file


def reached() -> set[str]:
    """All files that verification comes to by imports, except through what is loaded by name."""
    found, open_ = set[str](), [PACKAGE.parent / name for name in BEGINS]
    while open_:
        path = open_.pop()
        name = path.relative_to(PACKAGE.parent).as_posix()
        if name not in found:
            found.add(name)
            declares = name in LOADED_BY_NAME
            open_ += [one for one in imported(path) if not (declares and folder(one) in DECLARING)]
    return found


def folder(path: Path) -> str:
    """The folder of the package that a file stands in."""
    return path.relative_to(PACKAGE).parts[0]


def test_what_verification_imports_is_in_the_digest() -> None:
    """None of it stands in a folder that is left out."""
    left_out = {f"safeloc/{name}/" for name in (*DECLARING, *SHOWING)}
    found = reached()
    assert len(found) > 80
    assert [] == [name for name in sorted(found) if any(name.startswith(each) for each in left_out)]
    files = {path.relative_to(PACKAGE.parent).as_posix() for path in engine._engine_files()}
    assert found <= files


def test_what_is_left_out_exists() -> None:
    """A folder that is renamed is not silently taken in, or left out under its old name."""
    assert all((PACKAGE / name).is_dir() for name in (*DECLARING, *SHOWING))


def digest_after(monkeypatch: pytest.MonkeyPatch, root: Path) -> tuple[str, str]:
    """Engine's and source's digest of another copy of the package."""
    monkeypatch.setattr(engine, "PACKAGE", root)
    engine_digest.cache_clear()
    source_digest.cache_clear()
    return engine_digest(), source_digest()


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A package of a few files."""
    for name in (
        "language/spec.py",
        "proof/provers/proved_base.py",
        "models/odometry/__init__.py",
        "report/page.jinja",
        "proof/provers/__pycache__/proved_base.pyc",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name)
    yield tmp_path
    monkeypatch.undo()
    engine_digest.cache_clear()
    source_digest.cache_clear()


@pytest.mark.parametrize(
    ("file", "engine_changes", "source_changes"),
    [
        ("language/spec.py", True, True),
        ("proof/provers/proved_base.py", True, True),
        ("models/odometry/__init__.py", False, True),
        ("report/page.jinja", False, True),
        ("proof/provers/__pycache__/proved_base.pyc", False, False),
        ("proof/provers/new.py", True, True),
    ],
)
def test_a_file_that_changes(
    file: str, engine_changes: bool, source_changes: bool, copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Counts for the engine where it decides, for the source wherever it stands; what Python makes of it never."""
    before = digest_after(monkeypatch, copy)
    (copy / file).write_text("changed")
    after = digest_after(monkeypatch, copy)
    assert (engine_changes, source_changes) == (before[0] != after[0], before[1] != after[1])


def test_the_versions_of_solvers_count(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another z3 answers for itself."""
    before = digest_after(monkeypatch, copy)
    monkeypatch.setattr(engine.metadata, "version", lambda name: "9.9" if name == "z3-solver" else "1.0")
    assert before[0] != digest_after(monkeypatch, copy)[0]


def test_a_file_that_was_written_since_the_process_began(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was loaded may be another file than what is digested; whatever time the file itself claims."""
    monkeypatch.setattr(engine, "PACKAGE", copy)
    assert not engine.undisturbed()
    for path in copy.rglob("*.py"):
        os.utime(path, (0, 0))
    assert not engine.undisturbed()
    monkeypatch.setattr(engine, "_BEGAN", time.time() + 1)
    assert engine.undisturbed()


def test_the_process_began_before_this_test() -> None:
    """And after the system; where it does not say, some time before now."""
    assert 0 < time.time() - engine._BEGAN < time.clock_gettime(time.CLOCK_BOOTTIME)


def test_a_file_that_goes_meanwhile(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What cannot be looked at is not known to be undisturbed."""
    monkeypatch.setattr(engine, "PACKAGE", copy)
    monkeypatch.setattr(engine, "_BEGAN", time.time() + 1)
    assert engine.undisturbed()
    (copy / "gone.py").symlink_to(copy / "was_here.py")
    assert not engine.undisturbed()
