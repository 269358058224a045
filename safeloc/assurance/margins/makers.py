"""A digest of the code that makes a target: its own digest says nothing of what that code makes of other figures."""

from __future__ import annotations

import hashlib
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path

from safeloc.proof.cache.engine import source_digest
from safeloc.target import Target

_INSTALLED = tuple({sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")})


def maker_digest(target: Target) -> str:
    """Return the SHA-256 over all files of safeloc, and for a user's own machine over those of the user's modules that are loaded."""
    total = hashlib.sha256(source_digest().encode())
    if (
        not target.spec or ":" in target.spec
    ):  # a shipped machine has a plain name; the catalogue would load all of them
        for path in sorted(_own_files(target)):
            total.update(f"{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def _own_files(target: Target) -> set[Path]:
    """Return the file of the machine, and every module that is neither installed nor a part of safeloc."""
    named = Path(target.spec.rpartition(":")[0])
    return {path for path in (named.absolute(), *_loaded()) if path.is_file()}


def _loaded() -> Iterator[Path]:
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if file and name.partition(".")[0] != "safeloc" and not file.startswith(_INSTALLED):
            yield Path(file).absolute()
