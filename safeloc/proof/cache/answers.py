"""What solvers have answered before: that every goal of a query is proved, and never anything else.

The key is the text of the query (hypotheses and goals), who answered, and the engine; a machine that was edited asks anew
only what the edit is about.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

from safeloc.proof.cache.engine import engine_digest, undisturbed
from safeloc.proof.cache.store import Store

Solver = Literal["z3", "cvc5"]
KIND, PROVED = "answers", b"proved"
BEGINS = "(set-logic "
_STORES: list[Store] = []


@contextmanager
def kept_in(store: Store | None) -> Iterator[None]:
    """Within, answers are looked up and kept in this store; in processes that are forked meanwhile as well.

    Nowhere, if the engine's files were written since it was loaded.
    """
    if store is None or not undisturbed():
        yield
        return
    engine_digest()  # here, so that processes which begin later do not read what was written meanwhile
    _STORES.append(store)
    try:
        yield
    finally:
        _STORES.pop()


def keeping() -> bool:
    """Whether answers are kept at all."""
    return bool(_STORES)


def proved_before(solver: Solver, text: str) -> bool:
    """Whether this solver has proved every goal of this text."""
    entry = _STORES[-1].get(KIND, _key(solver, text)) if _STORES else None
    return entry is not None and entry.data == PROVED


def keep_proved(solver: Solver, text: str) -> None:
    """Keep that this solver has proved every goal of this text."""
    if _STORES:
        _STORES[-1].put(KIND, _key(solver, text), PROVED)


def _key(solver: Solver, text: str) -> str:
    """Of the text what is decided: its head names other certificates, and says nothing to a solver."""
    body = text[text.index(BEGINS) :]
    return hashlib.sha256("\0".join([engine_digest(), solver, body]).encode()).hexdigest()
