"""The last running time of each target, by name, as an estimate for the next run; no result depends on it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

from safeloc.proof.cache.store import Store

_KIND = "times"


def keep_seconds(store: Store, target: str, question: object, seconds: float) -> None:
    """Store the seconds that a request took for this target."""
    store.put(_KIND, _key(target, question), f"{seconds:.1f}".encode())


def seconds_before(store: Store, targets: Iterable[str], question: object) -> dict[str, float]:
    """Return the seconds that a request took for each target, for those with a stored time."""
    found = {name: store.get(_KIND, _key(name, question)) for name in targets}
    return {name: float(entry.data) for name, entry in found.items() if entry is not None}


def _key(target: str, question: object) -> str:
    return hashlib.sha256(f"{target}\0{question!r}".encode()).hexdigest()
