"""The code that makes a machine that ships: every module of declarations that its `target.py` leads to, without words for readers.

Comments and docstrings are left out, and so are simulations and pictures: no term of a machine comes from them. What the modules
use of the engine is not followed; the engine has a digest of its own (safeloc.proof.cache.engine).
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping
from functools import cache
from pathlib import Path

from safeloc.assurance.margins.read_modules import ReadModule, read_module
from safeloc.proof.cache.engine import DECLARING, PACKAGE, SHOWING

_FOLLOWED = tuple(name.replace("/", ".") for name in (*DECLARING, *SHOWING))
_LEFT_OUT = frozenset({"simulate", "simulation", "picture", "pictures", "line_runs", "coupled_runs"})


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
            waiting += _read(path).imports
    return dict(sorted(found.items()))


@cache
def making_code_digest(folder: str) -> str:
    """Return the SHA-256 over the code of these modules."""
    total = hashlib.sha256()
    for name, path in making_modules(folder).items():
        total.update(f"{name}\0".encode() + bytes.fromhex(_read(path).code))
    return total.hexdigest()


@cache
def _read(path: Path) -> ReadModule:
    """Return what was read of a file; most modules make several machines."""
    return read_module(path.read_text(encoding="utf-8"))


def _is_followed(name: str, left_out: Collection[str]) -> bool:
    inside = name.removeprefix("safeloc.")
    followed = any(inside == one or inside.startswith(f"{one}.") for one in _FOLLOWED)
    return followed and not any(part in left_out for part in name.split("."))


def _file(name: str) -> Path | None:
    """Return the file of a module; None if there is none, as for a name that is taken from one."""
    path = PACKAGE.joinpath(*name.split(".")[1:])
    return next((one for one in (path.with_suffix(".py"), path / "__init__.py") if one.is_file()), None)
