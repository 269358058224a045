"""The house: arrows between rooms point one way, heavy packages stay in their own rooms, the language needs none.

The engine (language, codegen, runtime, proof) knows no railway, no sensor and no machine that ships; what stands above it
knows the engine. Files stay short.
"""

from __future__ import annotations

import ast
import re
import sys
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest

import safeloc
from tests.rooms import imported, parsed, read

ROOT = Path(safeloc.__file__).resolve().parent
MODULES = sorted(
    [path for path in ROOT.rglob("*.py") if "models" not in path.parts and "properties" not in path.parts]
    + [*(ROOT.parent / "models").rglob("*.py"), *(ROOT.parent / "properties").rglob("*.py")]
)
HEAVY = {
    "z3": ("safeloc/codegen/smt.py", "safeloc/proof/provers/", "safeloc/proof/cores/", "safeloc/checker/solve.py"),
    "cvc5": (
        "safeloc/proof/provers/recheck.py",
        "safeloc/checker/solve.py",
        "safeloc/checker/proofs/solver.py",
    ),
    "numpy": (
        "safeloc/codegen/batch",
        "safeloc/codegen/numpy_code.py",
        "safeloc/sensing/",
        "safeloc/simulation/",
        "safeloc/campaign/",
        "models/*/simulate.py",
        "models/*/many.py",
        "models/*/simulation/",
        "models/fibre/scenes/",
        "safeloc/railway/design/least_cost.py",
    ),
    "scipy": (
        "safeloc/sensing/",
        "safeloc/campaign/statistics.py",
        "safeloc/railway/design/least_cost.py",
    ),
    "dask": ("safeloc/campaign/schedule.py",),
    "distributed": ("safeloc/campaign/schedule.py",),
    "duckdb": ("safeloc/campaign/aggregate.py",),
    "dascore": ("safeloc/sensing/fibre/recordings.py",),
    "h5py": ("safeloc/sensing/fibre/hdf5_contents.py",),
    "hypothesis": ("safeloc/proof/testing.py",),
    "transitions": ("safeloc/runtime/embedding/follower.py",),
    "typer": ("safeloc/cli/",),
    "rich": ("safeloc/cli/",),
    "textual": ("safeloc/cli/step_window.py",),
    "jinja2": ("safeloc/report/",),
    "pyarrow": ("safeloc/runtime/streams/", "safeloc/campaign/counted.py"),
    "paho": ("safeloc/runtime/service/broker/connection.py",),
    "pandas": ("safeloc/report/run_files/frame.py",),
    "prometheus_client": ("safeloc/runtime/service/metrics.py",),
    "vcd": ("safeloc/report/run_files/",),
    "mcap": ("safeloc/report/run_files/",),
    "networkx": ("safeloc/railway/map/", "safeloc/railway/audit/"),
    "tomli_w": ("safeloc/railway/map/toml_files.py",),
    "lxml": ("safeloc/railway/map/imports/railml_xml.py",),
    "openpyxl": ("safeloc/railway/map/imports/spreadsheet.py",),
    "pyproj": (
        "safeloc/railway/map/imports/geojson.py",
        "safeloc/railway/map/imports/railml_coordinates.py",
        "safeloc/railway/map/projection.py",
        "safeloc/sensing/satellite/line_track.py",
    ),
    "shapely": ("safeloc/railway/map/projection.py",),
    "pynmeagps": ("safeloc/railway/guard/nmea.py",),
}
"""Package -> the places that import it: what their paths begin with, `*` for any name."""
TARGET = re.compile(r"^safeloc\.models\.(\w+)\.target\b")
LANGUAGE = sorted((ROOT / "language").rglob("*.py"))
ENGINE = ("language", "codegen", "runtime", "proof")
ABOVE_THE_ENGINE = (
    "railway",
    "sensing",
    "simulation",
    "report",
    "checker",
    "cli",
    "models",
    "properties",
    "targets",
    "shipped_machines",
    "templates",
)
KNOWS = {
    "language": (),
    "codegen": ("language",),
    "yices": (),
    "simulated": ("language",),
    "reported": ("language",),
    "runtime": ("language", "codegen", "reported", "target", "config"),
    "proof": ("language", "codegen", "runtime", "target", "simulated", "yices"),
    "assurance": ("language", "codegen", "runtime", "proof", "target", "reported", "catalogue", "config", "own_module"),
    "railway.pictures": ("language", "reported"),
    "railway.map": ("language", "runtime", "railway.pictures", "config"),
    "railway.audit": ("language", "runtime", "models", "railway.map"),
    "railway.design": (
        "language", "codegen", "proof", "models", "railway.map", "railway.audit", "config",
    ),
    "railway.telegrams": ("language",),
    "railway.trackside": ("runtime", "models", "config"),
    "railway.guard": ("language", "codegen", "runtime", "models", "railway.map", "railway.audit", "simulation"),
    "sensing": ("language", "runtime", "railway.map", "config"),
    "simulation": ("language", "runtime", "sensing", "config"),
    "models": (
        "language", "codegen", "runtime", "reported", "proof.drawn_runs", "railway.map", "railway.pictures",
        "railway.telegrams", "sensing", "simulation", "simulated", "config",
    ),
    "properties": ("language", "models"),
    "target": ("language", "reported", "railway.pictures", "config", "simulated"),
    "targets": ("language", "runtime", "reported", "models", "properties", "target"),
    "shipped_machines": ("language", "reported", "models", "properties", "target", "targets"),
    "own_module": ("language", "reported", "railway.pictures", "simulated", "target"),
    "catalogue": ("language", "runtime", "own_module", "shipped_machines", "target"),
    "explain": ("language", "codegen", "runtime", "proof", "target"),
    "checker": ("language", "runtime", "report", "catalogue", "target", "yices"),
    "report": (*ENGINE, "explain", "reported", "assurance", "railway", "models", "target", "catalogue", "config", "yices"),
    "templates": ("language", "proof", "models", "catalogue"),
    "pytest_plugin": ("language", "proof", "target", "catalogue"),
    "campaign": (
        *ENGINE, "railway.map", "railway.audit", "simulation", "simulated", "models", "report", "catalogue", "target", "reported", "config",
    ),
    "cli": (
        *ENGINE, "assurance", "campaign", "checker", "explain", "railway", "simulation", "models", "report", "catalogue", "target", "config", "simulated", "templates",
    ),
}  # fmt: skip
"""Each room, or module at the root, and what it may import beside itself and the errors. The railway's have a row each.

`targets` are the files `models/<machine>/target.py`, which tie a machine to its properties: the machines know none of them.
"""
EXCEPTIONS = {
    ("safeloc/runtime/embedding/localizer.py", "models"): "`Localizer` is the localizer that ships, ready for a host",
    ("safeloc/runtime/embedding/localizer.py", "targets"): "`Localizer` is the localizer that ships, ready for a host",
}
"""Files that know another room against the arrows, and why."""
WALLS = {
    "safeloc/checker/": ("safeloc.proof", "safeloc.codegen"),
    "safeloc/checker/proofs/": ("safeloc.report", "safeloc.catalogue", "safeloc.target"),
    "safeloc/proof/cache/": ("safeloc.proof.provers",),
    "safeloc/runtime/embedding/": ("safeloc.runtime.service",),
}
"""Walls beside the arrows: what the files of a place do not import either."""


def name_of(path: Path) -> str:
    """The path from the repository's root."""
    return path.relative_to(ROOT.parent).as_posix()


@cache
def imports(path: Path) -> tuple[str, ...]:
    """Everything a file imports, wherever in it; a target under the name of its room."""
    return tuple(map(as_room, imported(path.read_text(encoding="utf-8"))))


def as_room(name: str) -> str:
    """An imported name, a target's under the name of its room."""
    return TARGET.sub(r"safeloc.targets.\1", name)


@pytest.mark.parametrize("package", HEAVY)
def test_heavy_packages_stay_in_their_rooms(package: str) -> None:
    """Only the named places import the package, and at least one of them does."""
    users = [name_of(path) for path in MODULES if any(one.split(".")[0] == package for one in imports(path))]
    assert users
    assert [user for user in users if not any(fnmatch(user, f"{place}*") for place in HEAVY[package])] == []


def test_every_place_of_a_heavy_package_is_used() -> None:
    """A rule for many files, such as the simulation of every machine, is for some that are there."""
    for package, places in HEAVY.items():
        users = [name_of(path) for path in MODULES if any(one.split(".")[0] == package for one in imports(path))]
        assert [place for place in places if not any(fnmatch(user, f"{place}*") for user in users)] == []


def room_of(path: Path) -> str:
    """The room that a file stands in, or its own name where it stands at the root."""
    parts = Path(name_of(path)).with_suffix("").parts
    if parts[0] == "models" and parts[2:] == ("target",):
        return "targets"
    inside = parts[1:] if parts[0] == "safeloc" else parts
    return ".".join(inside[:2]) if inside[0] == "railway" and inside[1] != "__init__" else inside[0]


def strange_rooms(path: Path) -> set[str]:
    """Rooms that a file imports against the arrows; `from safeloc import machine` names what is taken as well."""
    room = room_of(path)
    known = tuple(f"safeloc.{one}." for one in (room, "errors", *KNOWS[room]))
    above = [one for one in imports(path) if one.startswith("safeloc.") and not f"{one}.".startswith(known)]
    return {one.split(".")[1] for one in above if not any(full.startswith(f"{one}.") for full in known)}


def test_every_file_stands_in_a_room() -> None:
    """A new room, or a module at the root, says what it knows; the root holds few."""
    at_the_root = {"__init__", "__main__", "config", "errors", "moved", "railway"}
    assert set(KNOWS) | at_the_root == {room_of(path) for path in MODULES}


@pytest.mark.parametrize("room", KNOWS)
def test_arrows_point_one_way(room: str) -> None:
    """A room imports what it may know; each exception has its name and its reason."""
    strange = {(name_of(path), other) for path in MODULES if room_of(path) == room for other in strange_rooms(path)}
    assert strange == {one for one in EXCEPTIONS if room_of(ROOT.parent / one[0]) == room}


@pytest.mark.parametrize("room", ENGINE)
def test_the_engine_knows_no_railway(room: str) -> None:
    """No arrow leads from the engine to what stands above it."""
    assert not {one.split(".")[0] for one in KNOWS[room]} & set(ABOVE_THE_ENGINE)


@pytest.mark.parametrize("room", KNOWS)
def test_every_arrow_is_used(room: str) -> None:
    """What a room may know it does know, somewhere."""
    every = {f"{one}." for path in MODULES if room_of(path) == room for one in imports(path)}
    assert [] == [known for known in KNOWS[room] if not any(one.startswith(f"safeloc.{known}.") for one in every)]


def test_arrows_make_no_circle() -> None:
    """Rooms can be put in an order in which each knows only those before it."""
    left = {room: {to for to in KNOWS if leads(room, to)} for room in KNOWS}
    while left:
        free = {room for room, known in left.items() if not known & set(left)}
        assert free, sorted(left)
        left = {room: known for room, known in left.items() if room not in free}


def leads(room: str, to: str) -> bool:
    """Whether an arrow leads from a room to another, or into a part of it."""
    return any(f"{one}.".startswith(f"{to}.") or to.startswith(f"{one}.") for one in KNOWS[room])


@pytest.mark.parametrize("place", WALLS)
def test_walls(place: str) -> None:
    """What stands on one side of a wall imports nothing from the other; there is something on both."""
    here = [path for path in MODULES if name_of(path).startswith(place)]
    assert here
    for path in here:
        wrong = [one for one in imports(path) if f"{one}.".startswith(tuple(f"{above}." for above in WALLS[place]))]
        assert wrong == [], name_of(path)
    for wall in WALLS[place]:
        assert (ROOT.parent / wall.replace(".", "/")).is_dir() or (
            ROOT.parent / f"{wall.replace('.', '/')}.py"
        ).is_file()


@pytest.mark.parametrize("path", LANGUAGE, ids=name_of)
def test_the_language_needs_nothing_but_python(path: Path) -> None:
    """What a declaration means is settled by the standard library and the language itself, wherever it is imported."""
    strange = {one.split(".")[0] for one in imports(path)} - sys.stdlib_module_names - {"safeloc"}
    assert strange == set()
    own = {".".join(one.split(".")[:2]) for one in imports(path) if one.startswith("safeloc")}
    assert own <= {"safeloc.language", "safeloc.errors"}


def test_a_machine_has_one_folder() -> None:
    """At the top of models/ stands no machine, only what is of no single one: nothing today."""
    assert {"__init__.py"} == {path.name for path in (ROOT.parent / "models").glob("*.py")}


NO_ROW_SETS_IT = {
    "models/vocabulary/": "what a stored value is after a step, for several machines",
    "models/reflector/map_data.py": "what the stored reflector is after a step",
    "models/*/world.py": "moves of ghosts",
    "models/*_world.py": "moves of ghosts",
    "models/guard/law.py": "moves of ghosts",
    "models/verification/doubted.py": "moves of ghosts",
    "models/localizer/sources.py": "wires",
    "models/reflector_anchor/wires.py": "wires",
    "models/reflector_device/anchored.py": "wires",
    "models/reflector_device/branches.py": "wires",
    "models/fibre_device/__init__.py": "wires",
    "models/localizer_sections/__init__.py": "wires",
    "models/localizer_track/__init__.py": "wires",
}
"""Files without a transition table that map variables to terms, and what those are."""
OF_VARIABLES = re.compile(r"^(Updates\b|(dict|Mapping)\[(Var|NumVar|BoolVar)\b)")


def mappings(path: Path) -> list[str]:
    """Functions of a file that return terms by variable."""
    functions = [one for one in ast.walk(parsed(path.read_text(encoding="utf-8"))) if isinstance(one, ast.FunctionDef)]
    return [one.name for one in functions if one.returns is not None and OF_VARIABLES.match(ast.unparse(one.returns))]


def test_what_a_row_sets_stands_beside_it() -> None:
    """Groups of updates stand in the file of the table, so that one file tells what a transition sets."""
    files = {name_of(path): path for path in MODULES if name_of(path).startswith("models/")}
    made = {name: path for name, path in files.items() if mappings(path)}
    elsewhere = {
        name
        for name, path in made.items()
        if not re.search(r"\b(Transition|compose)\(", path.read_text(encoding="utf-8"))
    }
    assert [] == [name for name in elsewhere if not any(fnmatch(name, f"{place}*") for place in NO_ROW_SETS_IT)]
    assert [] == [place for place in NO_ROW_SETS_IT if not any(fnmatch(name, f"{place}*") for name in elsewhere)]


def test_imports_are_seen() -> None:
    """The reading of imports that these tests rely on sees every way of importing."""
    code = "import a.b as c\nfrom d import e\ndef f():\n    from g.h import i, j\n"
    assert ["a.b", "d", "d.e", "g.h", "g.h.i", "g.h.j"] == list(imported(code))
    assert ["safeloc.targets.odometry", "safeloc.targets.odometry.ENTRIES", "safeloc.models.odometry.targets"] == [
        *(as_room(f"safeloc.models.odometry.{name}") for name in ("target", "target.ENTRIES", "targets"))
    ]
    with pytest.raises(ValueError, match="relative import"):
        list(imported("from . import provers"))


def test_functions_stay_readable() -> None:
    """No function over 50 lines, its signature apart: the options of a command are a long one."""
    long = [
        f"{name_of(path)}: {name}"
        for path in MODULES
        for name, begins, ends in read(path.read_text(encoding="utf-8")).functions
        if ends - begins >= 50
    ]
    assert long == []


def test_claims_stay_short() -> None:
    """Nine of ten functions of the claims have at most 20 lines, docstrings apart: a claim is read at a glance."""
    lines = sorted(
        (node.end_lineno or 0) - node.body[min(len(node.body) - 1, ast.get_docstring(node) is not None)].lineno + 1
        for path in MODULES
        if name_of(path).startswith("properties/")
        for node in ast.walk(parsed(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef)
    )
    assert lines[len(lines) * 9 // 10] <= 20


def test_files_stay_readable() -> None:
    """No file over 450 lines but those with a reason."""
    long = {name_of(path) for path in MODULES if len(path.read_text(encoding="utf-8").splitlines()) > 450}
    assert not long
