"""Python that is generated from a declaration once per process, for tests that do not test the generator."""

from __future__ import annotations

from safeloc.codegen import compiled
from safeloc.language.digest import full_digest
from safeloc.language.system import TransitionSystem

_TEXTS: dict[str, str] = {}
_GENERATE = compiled.to_python


def generated_once(system: TransitionSystem) -> str:
    """Return the text for a system of the same declaration, if there is one."""
    digest = full_digest(system)
    if digest not in _TEXTS:
        _TEXTS[digest] = _GENERATE(system)
    return _TEXTS[digest]
