"""A function or constant that nothing but its own module uses has a name that begins with an underscore, and is used there."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from tests.rooms import ROOT, parsed

OWN = ("safeloc", "models", "properties")
USERS = (*OWN, "tests", "benchmarks", "packaging")
HOOKS = {"pytest_addoption", "pytest_collect_file", "dask_setup"}
"""Functions that pytest finds in the plugin by their names, and Dask in what its workers load."""
WORD = re.compile(r"[A-Za-z_]\w*")
TYPE = re.compile(r"[A-Z]\w*[a-z]\w*")
"""Types are named by the signatures of public functions, which return them."""


@cache
def written(folders: tuple[str, ...]) -> dict[Path, str]:
    """The text of every Python file in these folders; packages that are links to a folder count once."""
    return {
        path: path.read_text(encoding="utf-8")
        for folder in folders
        for path in (ROOT / folder).rglob("*.py")
        if path.resolve() == path and "templates" not in path.parts
    }


def top(text: str) -> list[ast.stmt]:
    """The statements of a module."""
    return parsed(text).body


def public(text: str) -> Iterator[str]:
    """The public functions and constants of a module."""
    for node in top(text):
        match node:
            case ast.FunctionDef(name=name) | ast.AnnAssign(target=ast.Name(id=name)):
                names = [name]
            case ast.Assign(targets=targets):
                names = [one.id for one in targets if isinstance(one, ast.Name)]
            case _:
                names = []
        yield from (name for name in names if not name.startswith("_") and not TYPE.fullmatch(name))


def only_at_home(texts: Mapping[Path, str], pages: str) -> Iterator[tuple[Path, str]]:
    """Each public name with its file, if no other file and no page has the word."""
    users: dict[str, set[Path]] = defaultdict(set)
    for path, text in texts.items():
        for word in WORD.findall(text):
            users[word].add(path)
    told = set(WORD.findall(pages))
    for path, text in texts.items():
        if path.relative_to(ROOT).parts[0] in OWN:
            yield from ((path, name) for name in public(text) if users[name] == {path} and name not in told)


def test_what_nobody_else_uses_is_private() -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    told = " ".join(page.read_text(encoding="utf-8") for page in pages)
    found = {f"{path.relative_to(ROOT)}: {name}" for path, name in only_at_home(written(USERS), told)}
    assert not {one for one in found if one.rpartition(" ")[2] not in HOOKS}


def test_a_name_that_only_its_module_has_is_found() -> None:
    here = ROOT / "safeloc" / "here.py"
    text = "USED = 1\nLONELY = 2\nTOLD = 3\n_OWN = 4\nType = int\ndef lonely(): ...\n"
    texts = {here: text, ROOT / "tests" / "there.py": "from safeloc.here import USED\n"}
    assert [(here, "LONELY"), (here, "lonely")] == list(only_at_home(texts, "what TOLD means"))


# ------------------------------------------------------------------ private names without a use


def unused(text: str) -> Iterator[str]:
    """The private functions, classes and constants at the top of a module that nothing in it uses; decorators use what they mark."""
    for node in top(text):
        match node:
            case ast.FunctionDef(name=name, decorator_list=[]) | ast.ClassDef(name=name, decorator_list=[]):
                names = [name]
            case ast.AnnAssign(target=ast.Name(id=name)):
                names = [name]
            case ast.Assign(targets=targets):
                names = [one.id for one in targets if isinstance(one, ast.Name)]
            case _:
                names = []
        yield from (one for one in names if re.match("_(?!_)", one) and len(re.findall(rf"\b{one}\b", text)) == 1)


def test_what_is_private_is_used_in_its_module() -> None:
    """What nothing uses any more is removed: nobody else may use it."""
    found = {path: list(unused(text)) for path, text in written(OWN).items()}
    assert {} == {path.relative_to(ROOT).as_posix(): names for path, names in found.items() if names}


def test_a_private_name_without_a_use_is_found() -> None:
    text = (
        "_USED = 1\n_LEFT: int = _USED\ndef _left(): ...\n@mark\ndef _marked(): ...\n__all__ = []\nclass _Left: ...\n"
    )
    assert ["_LEFT", "_left", "_Left"] == list(unused(text))
