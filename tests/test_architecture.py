"""The house: imports go one way, heavy packages stay in their own rooms, public names are a tested list."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import safeloc

ROOT = Path(safeloc.__file__).resolve().parent
MODULES = sorted(
    [path for path in ROOT.rglob("*.py") if "models" not in path.parts and "properties" not in path.parts]
    + [*(ROOT.parent / "models").rglob("*.py"), *(ROOT.parent / "properties").rglob("*.py")]
)
ROOMS = {
    "z3": ("safeloc/backends/smt.py", "safeloc/provers/"),
    "cvc5": ("safeloc/provers/recheck.py",),
    "numpy": ("safeloc/backends/", "safeloc/simulation/", "models/odometry_streams.py"),
    "hypothesis": ("safeloc/testing.py",),
    "transitions": ("safeloc/backends/runtime.py",),
    "typer": ("safeloc/cli/",),
    "rich": ("safeloc/cli/",),
    "jinja2": ("safeloc/report/",),
    "pyarrow": ("safeloc/streams/",),
}
ABOVE = {
    "models/": ("safeloc.properties", "safeloc.provers", "safeloc.cli", "safeloc.report", "safeloc.catalogue"),
    "properties/": ("safeloc.provers", "safeloc.cli", "safeloc.report", "safeloc.catalogue"),
    "safeloc/backends/": ("safeloc.models", "safeloc.properties", "safeloc.provers", "safeloc.cli", "safeloc.report"),
    "safeloc/provers/": ("safeloc.models", "safeloc.properties", "safeloc.cli", "safeloc.report", "safeloc.catalogue"),
    "safeloc/report/": ("safeloc.cli",),
}


def name_of(path: Path) -> str:
    """The path from the repository's root."""
    return path.relative_to(ROOT.parent).as_posix()


def imports(path: Path) -> Iterator[str]:
    """Everything a file imports, wherever in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


@pytest.mark.parametrize("package", ROOMS)
def test_heavy_packages_stay_in_their_rooms(package: str) -> None:
    """Only the named places import the package, and at least one of them does."""
    users = [name_of(path) for path in MODULES if any(one.split(".")[0] == package for one in imports(path))]
    assert users
    assert [user for user in users if not user.startswith(ROOMS[package])] == []


@pytest.mark.parametrize("place", ABOVE)
def test_imports_go_one_way(place: str) -> None:
    """Nothing imports what stands above it."""
    for path in MODULES:
        if name_of(path).startswith(place):
            wrong = [one for one in imports(path) if one.startswith(ABOVE[place])]
            assert wrong == [], name_of(path)


def test_the_package_is_light() -> None:
    """`import safeloc` loads none of the heavy packages."""
    code = "import sys, safeloc; print([name for name in ('z3', 'numpy', 'hypothesis', 'transitions') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT.parent)
    assert done.stdout.strip() == "[]"


def test_public_names_exist_and_are_listed() -> None:
    """Every listed name is there, and every name that is there is listed."""
    here = {
        name for name, value in vars(safeloc).items() if not name.startswith("_") and not hasattr(value, "__path__")
    }
    modules = {name for name in here if type(getattr(safeloc, name)).__name__ == "module"}
    assert here - modules == set(safeloc.__all__)


def test_files_stay_readable() -> None:
    """No file over 450 lines but the language itself, which is one closed set."""
    long = {name_of(path) for path in MODULES if len(path.read_text(encoding="utf-8").splitlines()) > 450}
    assert long <= {"safeloc/expr.py"}
