"""Python that is generated once per run of the tests and compiled once per process for equal declarations, for tests that do not test the generator."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

from safeloc.codegen import compiled
from safeloc.language.digest import full_digest
from safeloc.language.system import TransitionSystem

_GENERATE = compiled.to_python

compiled_once = lru_cache(maxsize=32)(compiled._code)  # pyright: ignore[reportPrivateUsage]
"""The code of a text; equal texts are compiled once."""


class GeneratedOnce:
    """Texts by the digest of the declaration.

    folder  where the processes of this run leave them for each other; None if there is one process
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._texts: dict[str, str] = {}

    def __call__(self, system: TransitionSystem) -> str:
        """Return the text for a system of the same declaration, if there is one."""
        digest = full_digest(system)
        if digest not in self._texts:
            self._texts[digest] = _GENERATE(system) if self._folder is None else _left(self._folder / digest, system)
        return self._texts[digest]


def _left(path: Path, system: TransitionSystem) -> str:
    """Return the text that another process left; else generate it, and leave it whole or not at all."""
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        begun = path.with_name(f"{path.name}.{os.getpid()}")
        begun.write_text(_GENERATE(system), encoding="utf-8")
        begun.replace(path)
    return path.read_text(encoding="utf-8")
