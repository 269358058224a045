"""A digest of the engine: the verification code, Python and the packages it uses. Another engine ignores all cached results."""

from __future__ import annotations

import hashlib
import os
import platform
import time
from collections.abc import Iterator
from functools import cache
from importlib import metadata
from pathlib import Path

from safeloc import yices

PACKAGE = Path(__file__).parents[2]
DECLARING = ("models", "properties", "shipped")
"""Folders with declarations: the digest of a target covers the objects that they declare."""
SHOWING = (
    "cli",
    "checker",
    "railway/audit",
    "railway/guard",
    "railway/map",
    "report",
    "runtime/service",
    "simulation",
)
"""Folders that only display, check, host or simulate: no finding of `verify` depends on them."""
_LONGEST_START_S = 10.0  # assumed age of the process where the system does not tell it
_DECIDE_WITH = ("cvc5", "hypothesis", "networkx", "numpy", "pydantic", "transitions", "z3-solver")


@cache
def engine_digest() -> str:
    """Return the SHA-256 over the files of the engine, and the versions of Python and of the packages in _DECIDE_WITH."""
    total = hashlib.sha256(f"{platform.python_implementation()} {platform.python_version()}\0".encode())
    total.update("".join(f"{name} {metadata.version(name)}\0" for name in _DECIDE_WITH).encode())
    total.update(f"yices {yices.version()}\0".encode())
    return _over(total.hexdigest(), _engine_files())


@cache
def source_digest() -> str:
    """Return the SHA-256 over all files of the package: reports with equal digests were made by the same safeloc."""
    return _over("", _files(PACKAGE, ()))


def undisturbed() -> bool:
    """Return whether no file of the package was written since this process started.

    Otherwise the loaded code may differ from the digested files, and no result may enter the cache.
    """
    try:
        return all(changed_s <= _BEGAN for changed_s in _changed_s(str(PACKAGE)))
    except FileNotFoundError:  # a file was deleted during the check
        return False


def _changed_s(folder: str) -> Iterator[float]:
    """Yield when each file of `_files` was last written; without Path objects, as this is asked often."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if not entry.is_dir():
                if not entry.name.endswith(".pyc"):
                    yield entry.stat().st_ctime
            elif entry.name != "__pycache__":
                yield from _changed_s(entry.path)


def _began() -> float:
    """Return the start time of this process, on the file system's clock; if unknown, a time shortly before now."""
    try:
        ticks = int(Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19])
        age_s = time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf("SC_CLK_TCK")
    except (OSError, AttributeError, ValueError):
        age_s = _LONGEST_START_S
    return time.time() - age_s


_BEGAN = _began()


def _over(start: str, paths: list[Path]) -> str:
    total = hashlib.sha256(start.encode())
    for path in paths:
        total.update(path.relative_to(PACKAGE).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return total.hexdigest()


def _engine_files() -> list[Path]:
    return _files(PACKAGE, (*DECLARING, *SHOWING))


def _files(folder: Path, without: tuple[str, ...]) -> list[Path]:
    found: list[Path] = []
    for at, folders, names in os.walk(folder, followlinks=True):
        here = Path(at).relative_to(folder)
        folders[:] = [name for name in folders if name != "__pycache__" and (here / name).as_posix() not in without]
        found += [Path(at, name) for name in names if not name.endswith(".pyc")]
    return sorted(found)
