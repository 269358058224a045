"""The code that makes a machine that ships: every module of declarations that its `target.py` leads to, without words for readers.

Comments and docstrings are left out, and so are simulations and pictures: no term of a machine comes from them. What the modules
use of the engine is not followed; the engine has a digest of its own (safeloc.proof.cache.engine).
"""

from __future__ import annotations

import ast
import hashlib
import io
import tokenize
from collections.abc import Collection, Iterator, Mapping
from functools import cache
from pathlib import Path

from safeloc.proof.cache.engine import DECLARING, PACKAGE, SHOWING

_FOLLOWED = tuple(name.replace("/", ".") for name in (*DECLARING, *SHOWING))
_LEFT_OUT = frozenset({"simulate", "simulation", "picture", "pictures", "line_runs", "coupled_runs"})
_BODIES = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def making_modules(folder: str, left_out: Collection[str] = _LEFT_OUT) -> Mapping[str, Path]:
    """Return the modules from which the machines of a folder of `models/` are made, by name, each with its file.

    left_out  names of modules that are not followed
    """
    found: dict[str, Path] = {}
    waiting = [f"safeloc.models.{folder}.target"]
    while waiting:
        name = waiting.pop()
        path = None if name in found or not _is_followed(name, left_out) else _file(name)
        if path is not None:
            found[name] = path
            waiting += _imported(path)
    return dict(sorted(found.items()))


@cache
def making_code_digest(folder: str) -> str:
    """Return the SHA-256 over the code of these modules."""
    total = hashlib.sha256()
    for name, path in making_modules(folder).items():
        total.update(f"{name}\0".encode() + _digest_without_words(path.read_text(encoding="utf-8")))
    return total.hexdigest()


@cache
def _digest_without_words(text: str) -> bytes:
    """Return the SHA-256 over a module's code; most modules make several machines."""
    return hashlib.sha256(without_words(text).encode()).digest()


def _is_followed(name: str, left_out: Collection[str]) -> bool:
    inside = name.removeprefix("safeloc.")
    followed = any(inside == one or inside.startswith(f"{one}.") for one in _FOLLOWED)
    return followed and not any(part in left_out for part in name.split("."))


def _file(name: str) -> Path | None:
    """Return the file of a module; None if there is none, as for a name that is taken from one."""
    path = PACKAGE.joinpath(*name.split(".")[1:])
    return next((one for one in (path.with_suffix(".py"), path / "__init__.py") if one.is_file()), None)


@cache
def _imported(path: Path) -> tuple[str, ...]:
    """Return the names that a file imports, wherever it does: modules, what is taken from them, and the packages above."""
    return tuple(dict.fromkeys(_with_packages(ast.parse(path.read_text(encoding="utf-8")))))


def _with_packages(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import | ast.ImportFrom) else []
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            names = [f"{node.module}.{name}" for name in names]
        for name in names:
            parts = name.split(".")
            yield from (".".join(parts[:length]) for length in range(1, len(parts) + 1))


def without_words(text: str) -> str:
    """Return the text of a file of Python without comments, docstrings, empty lines and spaces at the end of a line."""
    lines = text.splitlines()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    for first, last in _docstrings(ast.parse(text)):
        lines[first - 1 : last] = [""] * (last - first + 1)
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _docstrings(tree: ast.Module) -> Iterator[tuple[int, int]]:
    """Yield the first and the last line of each string that stands alone: docstrings, and those below a name."""
    for node in ast.walk(tree):
        if isinstance(node, _BODIES):
            for one in node.body:
                alone = isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant)
                if alone and isinstance(one.value.value, str) and one.end_lineno is not None:  # type: ignore[attr-defined] # it is one
                    yield one.lineno, one.end_lineno
