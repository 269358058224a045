"""Margins that were found, kept for reports: a report takes them from here, and never waits for them.

They belong to the content of a target and to the code that makes it: of a target that has changed since there are none.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from typing import Any

from safeloc.assurance.kept_work import Keeping
from safeloc.assurance.margins.makers import maker_digest
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.target import Target

_KIND, _LATEST = "margins for reports", "latest"


def keep_margins(store: Store, target: Target, part: str, data: Any) -> None:
    """Keep a part of a target's margins: the limits of all figures in `world` or `design`, or the fronts of its `pairs`."""
    had = kept_margins(store, target) or {}
    if had.get(part) == data:
        return
    _keeping(store, target).keep("all", {**had, part: data})
    before = stamp(store) + json.dumps(data)
    store.put(_KIND, _LATEST, hashlib.sha256(before.encode()).hexdigest().encode())


def kept_margins(store: Store, target: Target) -> dict[str, Any] | None:
    """Return the margins kept for this target, by part; None if they were never found, or it has changed since."""
    found: dict[str, Any] | None = _keeping(store, target).kept("all")
    return found


def margins_of(store: Store, targets: Iterable[Target]) -> Mapping[str, Any]:
    """Return the margins kept for each of these targets that has some, by its name."""
    found = {target.name: kept_margins(store, target) for target in targets}
    return {name: data for name, data in found.items() if data is not None}


def stamp(store: Store) -> str:
    """Return a value that changes whenever margins are kept, so that a cached report without them is not used."""
    entry = store.get(_KIND, _LATEST)
    return "" if entry is None else entry.data.decode()


def _keeping(store: Store, target: Target) -> Keeping:
    return Keeping(_KIND, asked(target, _KIND, maker_digest(target)).key, store, store)
