"""A digest of the code that makes a target: its own digest says nothing of what that code makes of other figures."""

from __future__ import annotations

import hashlib
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path

from safeloc.assurance.margins.making_code import making_code_digest
from safeloc.catalogue import ENTRIES
from safeloc.proof.cache.contents import content_digest
from safeloc.proof.cache.engine import engine_digest, source_digest
from safeloc.target import Target

_INSTALLED = tuple({sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")})


def maker_digest(target: Target) -> str:
    """Return the SHA-256 over the code that makes a target.

    Of a machine that ships: the modules of declarations that its `target.py` leads to. Of a user's own: all files of safeloc,
    and the user's modules that are loaded.
    """
    if _ships(target):
        return making_code_digest(ENTRIES[target.spec].folder)
    total = hashlib.sha256(source_digest().encode())
    for path in sorted(_own_files(target)):
        total.update(f"{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def machine_digest(target: Target) -> str:
    """Return the SHA-256 over a target as it is and the code that makes it: all that a margin depends on but the engine."""
    return _digest(content_digest(target), maker_digest(target))


def as_it_is_key(target: Target, *question: object) -> str:
    """Return the digest of all that an answer about a target as it is depends on: the engine, the target, and the question."""
    return _digest(engine_digest(), content_digest(target), *map(repr, question))


def margins_key(target: Target, *question: object) -> str:
    """Return the digest of all that an answer about other figures of a target depends on: also the code that makes it."""
    return _digest(engine_digest(), machine_digest(target), *map(repr, question))


def _digest(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _ships(target: Target) -> bool:
    """Return whether a target is a machine that ships; one with a user's sources is not."""
    return target.spec.isidentifier() and target.spec in ENTRIES


def _own_files(target: Target) -> set[Path]:
    """Return the file of the machine, and every module that is neither installed nor a part of safeloc."""
    named = Path(target.spec.rpartition(":")[0])
    return {path for path in (named.absolute(), *_loaded()) if path.is_file()}


def _loaded() -> Iterator[Path]:
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if file and name.partition(".")[0] != "safeloc" and not file.startswith(_INSTALLED):
            yield Path(file).absolute()
