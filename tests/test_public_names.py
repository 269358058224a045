"""The names that users write against: a fixed list, each one where it is said to be, and cheap to import."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import safeloc
from safeloc import errors, simulated
from safeloc.language import (
    absence,
    composition,
    declared,
    expr,
    interpret,
    machine,
    spec,
    system,
    units,
    verdict,
    world,
)

ROOT = Path(__file__).parents[1]
PUBLIC = {
    absence: ("shown_if",),
    declared: ("Declared",),
    machine: ("ANY", "Machine", "Transition", "current_mode", "modes"),
    world: ("Law", "World"),
    expr: (
        "abs_", "before", "between", "boolean", "ceil_div", "ceil_to", "choice", "enumeration", "exact_to", "floor_div", "floor_to",
        "ite", "maximum", "members", "minimum", "number", "optional", "product", "was", "with_unit",
    ),
    spec: ("always", "never", "once", "previous", "reachable", "since", "within"),
    system: ("lower", "without_ghosts"),
    composition: ("Clause", "compose"),
    interpret: ("run",),
    simulated: ("SimulatedRun",),
    verdict: ("Held", "Proved", "Unknown", "Violated", "require_proved"),
    errors: (
        "EngineError", "InputError", "ModelError", "NotProvedError", "PropertyError", "SafelocError", "SnapshotError",
        "StreamError", "TruthValueError", "UnforeseenError", "UnitError", "UnknownNameError",
    ),
}  # fmt: skip
PAGE = ROOT / "docs" / "public.md"
HEAVY = ("cvc5", "hypothesis", "jinja2", "numpy", "pyarrow", "pydantic", "pytest", "rich", "transitions", "typer", "z3")


def loaded(code: str) -> set[str]:
    """The top-level modules that a fresh interpreter has after running `code`."""
    told = f"{code}\nimport json, sys; print(json.dumps(sorted({{name.split('.')[0] for name in sys.modules}})))"
    done = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(json.loads(done.stdout))


def test_the_list_is_the_list() -> None:
    """A public name is neither lost nor added by accident; the list is in order."""
    assert sorted(name for names in PUBLIC.values() for name in names) == safeloc.__all__


def test_a_star_import_gives_the_list() -> None:
    """`from safeloc import *` gives exactly the public names."""
    space: dict[str, object] = {}
    exec("from safeloc import *", space)
    assert set(safeloc.__all__) == set(space) - {"__builtins__"}


def test_nothing_else_stands_there() -> None:
    """What is in the package and is no module is public, so that a host finds no name that may vanish."""
    here = {
        name for name, value in vars(safeloc).items() if not name.startswith("_") and not isinstance(value, type(re))
    }
    assert set(safeloc.__all__) == here


@pytest.mark.parametrize("module", PUBLIC, ids=lambda module: str(module.__name__))
def test_a_name_is_the_same_wherever_it_is_taken_from(module: object) -> None:
    """`safeloc.number` is `safeloc.language.expr.number`: types and identities agree."""
    for name in PUBLIC[module]:  # type: ignore[index]
        assert getattr(module, name) is getattr(safeloc, name)


def test_every_error_is_public() -> None:
    """A host can catch each error by its public name."""
    classes = {
        name
        for name, value in vars(errors).items()
        if isinstance(value, type) and issubclass(value, errors.SafelocError)
    }
    assert classes == set(PUBLIC[errors])


def test_public_functions_say_what_they_do() -> None:
    """Each public class and function has a docstring of its own."""
    named = [getattr(safeloc, name) for name in safeloc.__all__ if name != "ANY"]
    assert [] == [
        value.__name__ for value in named if not value.__doc__ or value.__doc__.startswith(f"{value.__name__}(")
    ]


def test_importing_is_light() -> None:
    """`import safeloc` loads no solver, no numpy and nothing else that was installed beside it."""
    assert "safeloc" in loaded("import safeloc")
    assert set() == loaded("import safeloc") & set(HEAVY)
    assert {"numpy"} == loaded("import safeloc, numpy") & {"numpy", "z3"}


def test_a_machine_is_written_and_run_with_public_names_alone() -> None:
    """Declared, run, and a property stated, with the public names and units; still nothing heavy is loaded."""
    code = """
from safeloc import Machine, Transition, always, boolean, lower, modes, number, run
from safeloc.language.units import MM
A, B = modes("A", "B")
go, way = boolean("go"), number("way", MM, 0, 9)
m = Machine("m", (A, B), [go], {way: 0}, {"way": way}, [Transition("go", A, B, go, {way: 5})])
always("short", way <= 5)
assert 5 == run(lower(m), [{"go": True}]).steps[0].outputs["way"]
"""
    assert set() == loaded(code) & set(HEAVY)


# ------------------------------------------------------------------ what README and docs use


def shown() -> dict[str, set[str]]:
    """Module -> names that README, docs and the examples of docs import from it, but for what `safeloc` itself has."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    blocks = [
        one for page in pages for one in re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    ]
    blocks += [path.read_text(encoding="utf-8") for path in sorted((ROOT / "docs" / "examples").glob("*.py"))]
    found: dict[str, set[str]] = {}
    for block in blocks:
        for line in re.findall(r"^ *from (safeloc\S*) import (?:\(([^)]*)\)|(.*))$", block, re.MULTILINE):
            names = {name.strip().split(" as ")[0] for name in re.sub("#.*", "", line[1] or line[2]).split(",")}
            found.setdefault(line[0], set()).update(names - {""})
    here = {name: getattr(safeloc, name) for name in safeloc.__all__}
    left = {
        name: {one for one in names if here.get(one) is not getattr(import_module(name), one)}
        for name, names in found.items()
        if name != "safeloc"
    }
    left[units.__name__] = {name for name, value in vars(units).items() if isinstance(value, units.Unit)}  # all of them
    return {name: names for name, names in left.items() if names}


def listed() -> dict[str, set[str]]:
    """Module -> names, as docs/public.md lists them."""
    rows = re.findall(r"^\| `(safeloc[\w.]*)` \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    return {module: set(re.findall(r"`(\w+)`", names)) for module, names in rows}


def test_the_page_lists_what_users_are_shown() -> None:
    """No more, or a name would be promised that nobody needs; no less, or README would use a name that may vanish."""
    assert listed() == {"safeloc": set(safeloc.__all__), **shown()}


def test_what_is_listed_is_there() -> None:
    """Each name stands in its module, and belongs to it or to the room behind it."""
    for module, names in listed().items():
        assert [] == [name for name in names if not hasattr(import_module(module), name)], module


def test_the_page_is_in_order() -> None:
    """Modules and their names are sorted, so that a change is one line."""
    rows = re.findall(r"^\| `(safeloc[\w.]*)` \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(module for module, _ in rows) == [module for module, _ in rows]
    for _, names in rows:
        found = re.findall(r"`(\w+)`", names)
        assert sorted(found) == found
