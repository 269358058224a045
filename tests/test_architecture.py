"""The house: imports go one way, heavy packages stay in their own rooms, the kernel needs none, files stay short."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import safeloc

ROOT = Path(safeloc.__file__).resolve().parent
MODULES = sorted(
    [path for path in ROOT.rglob("*.py") if "models" not in path.parts and "properties" not in path.parts]
    + [*(ROOT.parent / "models").rglob("*.py"), *(ROOT.parent / "properties").rglob("*.py")]
)
ROOMS = {
    "z3": ("safeloc/codegen/smt.py", "safeloc/proof/provers/", "safeloc/proof/checker/solve.py"),
    "cvc5": (
        "safeloc/proof/provers/recheck.py",
        "safeloc/proof/checker/solve.py",
        "safeloc/proof/checker/proofs/solver.py",
    ),
    "numpy": (
        "safeloc/codegen/batch",
        "safeloc/codegen/numpy_code.py",
        "safeloc/sensing/",
        "safeloc/simulation/",
        "models/motion_streams.py",
        "models/odometry_streams.py",
        "models/balise_streams.py",
        "models/fibre_scenes/",
        "models/fibre_streams.py",
        "models/localizer_sky.py",
        "models/localizer_streams.py",
        "models/reflector_streams.py",
        "models/route_streams.py",
        "models/satellite_streams.py",
        "models/sections_streams.py",
        "models/stop_point_streams.py",
    ),
    "scipy": ("safeloc/sensing/",),
    "dascore": ("safeloc/sensing/fibre/recordings.py",),
    "h5py": ("safeloc/sensing/fibre/hdf5_contents.py",),
    "hypothesis": ("safeloc/proof/testing.py",),
    "transitions": ("safeloc/codegen/runtime.py",),
    "typer": ("safeloc/cli/",),
    "rich": ("safeloc/cli/",),
    "jinja2": ("safeloc/report/",),
    "pyarrow": ("safeloc/runtime/streams/",),
    "networkx": ("safeloc/railway/map/", "safeloc/railway/audit/"),
    "tomli_w": ("safeloc/railway/map/toml_files.py",),
    "lxml": ("safeloc/railway/map/imports/railml_xml.py",),
    "openpyxl": ("safeloc/railway/map/imports/spreadsheet.py",),
    "pyproj": (
        "safeloc/railway/map/imports/geojson.py",
        "safeloc/railway/map/projection.py",
        "safeloc/sensing/satellite/line_track.py",
    ),
    "shapely": ("safeloc/railway/map/projection.py",),
    "pynmeagps": ("safeloc/railway/guard/nmea.py",),
}
LANGUAGE = sorted((ROOT / "language").rglob("*.py"))
ABOVE = {
    "models/": (
        "safeloc.properties",
        "safeloc.proof.provers",
        "safeloc.cli",
        "safeloc.report",
        "safeloc.catalogue",
        "safeloc.shipped",
    ),
    "properties/": ("safeloc.proof.provers", "safeloc.cli", "safeloc.report", "safeloc.catalogue", "safeloc.shipped"),
    "safeloc/codegen/": (
        "safeloc.models",
        "safeloc.properties",
        "safeloc.proof.provers",
        "safeloc.cli",
        "safeloc.report",
    ),
    "safeloc/proof/provers/": (
        "safeloc.models",
        "safeloc.properties",
        "safeloc.cli",
        "safeloc.report",
        "safeloc.catalogue",
        "safeloc.shipped",
    ),
    "safeloc/report/": ("safeloc.cli",),
    "safeloc/proof/checker/": ("safeloc.proof.provers", "safeloc.codegen", "safeloc.cli"),
    "safeloc/proof/cache/": (
        "safeloc.models",
        "safeloc.proof.provers",
        "safeloc.cli",
        "safeloc.report",
        "safeloc.shipped",
    ),
    "safeloc/proof/checker/proofs/": (
        "safeloc.codegen",
        "safeloc.proof.provers",
        "safeloc.models",
        "safeloc.properties",
        "safeloc.cli",
        "safeloc.report",
        "safeloc.catalogue",
        "safeloc.shipped",
    ),
    "safeloc/runtime/embedding/": ("safeloc.runtime.service", "safeloc.proof.provers", "safeloc.report", "safeloc.cli"),
    "safeloc/runtime/service/": ("safeloc.models", "safeloc.proof.provers", "safeloc.report", "safeloc.cli"),
    "safeloc/railway/map/": (
        "safeloc.models",
        "safeloc.railway.audit",
        "safeloc.cli",
        "safeloc.report",
        "safeloc.catalogue",
        "safeloc.shipped",
    ),
    "safeloc/railway/audit/": (
        "safeloc.properties",
        "safeloc.proof.provers",
        "safeloc.cli",
        "safeloc.report",
        "safeloc.catalogue",
        "safeloc.shipped",
    ),
}


def name_of(path: Path) -> str:
    """The path from the repository's root."""
    return path.relative_to(ROOT.parent).as_posix()


@cache
def imports(path: Path) -> tuple[str, ...]:
    """Everything a file imports, wherever in it."""
    return tuple(imported(path.read_text(encoding="utf-8")))


def imported(code: str) -> Iterator[str]:
    """Modules and what is taken from them, with their full names; ValueError for a relative import."""
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            if node.level or node.module is None:
                raise ValueError(f"relative import in line {node.lineno}; full names show which way it goes.")
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


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
            wrong = [one for one in imports(path) if f"{one}.".startswith(tuple(f"{above}." for above in ABOVE[place]))]
            assert wrong == [], name_of(path)


@pytest.mark.parametrize("path", LANGUAGE, ids=name_of)
def test_the_language_needs_nothing_but_python(path: Path) -> None:
    """What a declaration means is settled by the standard library and the language itself, wherever it is imported."""
    strange = {one.split(".")[0] for one in imports(path)} - sys.stdlib_module_names - {"safeloc"}
    assert strange == set()
    own = {".".join(one.split(".")[:2]) for one in imports(path) if one.startswith("safeloc")}
    assert own <= {"safeloc.language", "safeloc.errors"}


def test_imports_are_seen() -> None:
    """The reading of imports that these tests rely on sees every way of importing."""
    code = "import a.b as c\nfrom d import e\ndef f():\n    from g.h import i, j\n"
    assert ["a.b", "d", "d.e", "g.h", "g.h.i", "g.h.j"] == list(imported(code))
    with pytest.raises(ValueError, match="relative import"):
        list(imported("from . import provers"))


def test_files_stay_readable() -> None:
    """No file over 450 lines but those with a reason."""
    long = {name_of(path) for path in MODULES if len(path.read_text(encoding="utf-8").splitlines()) > 450}
    assert not long
