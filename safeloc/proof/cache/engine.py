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
DECLARING = ("models", "properties", "shipped_machines")
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
    "templates",
)
"""Folders that only display, check, host, simulate or begin a project: no finding of `verify` depends on them."""
READ = ("docs",)
"""Folders for readers only; in a checkout they lie beside the package, and the digests are the same."""
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
    """Return the SHA-256 over all files of the package but its documentation: reports with equal digests were made by the same safeloc."""
    return _over("", _files(PACKAGE, READ))


@cache
def tools_digest() -> str:
    """Return the SHA-256 over the engine and all that displays, checks or hosts: over everything but declarations and documentation."""
    return _over(engine_digest(), _files(PACKAGE, (*DECLARING, *READ)))


def undisturbed() -> bool:
    """Return whether no file of the package was written since this process started.

    Otherwise the loaded code may differ from the digested files, and no result may enter the cache.
    """
    try:
        still = all(entry.stat().st_ctime <= _BEGAN for entry in _entries(str(PACKAGE), frozenset()))
    except FileNotFoundError:  # a file was deleted during the check
        still = False
    if not still:
        _disturbed[0] = True
    return still


_disturbed = [False]


def was_disturbed() -> bool:
    """Return whether `undisturbed` was ever False: a result of this process did not enter the cache."""
    return _disturbed[0]


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
    return _files(PACKAGE, (*DECLARING, *SHOWING, *READ))


def _files(folder: Path, without: tuple[str, ...]) -> list[Path]:
    left_out = frozenset(str(folder / name) for name in without)
    return sorted(Path(entry.path) for entry in _entries(str(folder), left_out))


def _entries(folder: str, without: frozenset[str]) -> Iterator[os.DirEntry[str]]:
    """Yield all files below a folder, through links, except compiled Python and the folders `without`, given by their paths."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if not entry.is_dir():
                if not entry.name.endswith(".pyc"):
                    yield entry
            elif entry.name != "__pycache__" and entry.path not in without:
                yield from _entries(entry.path, without)
