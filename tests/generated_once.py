"""Python that is generated and compiled once per process for equal declarations, for tests that do not test the generator."""

from __future__ import annotations

from functools import lru_cache

from safeloc.codegen import compiled
from safeloc.language.digest import full_digest
from safeloc.language.system import TransitionSystem

_TEXTS: dict[str, str] = {}
_GENERATE = compiled.to_python

compiled_once = lru_cache(maxsize=32)(compiled._code)  # pyright: ignore[reportPrivateUsage]
"""The code of a text; equal texts are compiled once."""


def generated_once(system: TransitionSystem) -> str:
    """Return the text for a system of the same declaration, if there is one."""
    digest = full_digest(system)
    if digest not in _TEXTS:
        _TEXTS[digest] = _GENERATE(system)
    return _TEXTS[digest]
