"""Results of one kind, one for each target, kept for reports: a report takes them from here, and never waits for them.

A result belongs to the content of its target and to the code that made it: of a target that has changed since there is none.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from safeloc.assurance.kept_work import Keeping
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.target import Target

_ALL, _LATEST = "all", "latest"


def _of_the_target(target: Target, kind: str) -> str:
    return asked(target, kind).key


@dataclass(frozen=True)
class KeptResults:
    """The results of one kind.

    kind     the kind, which names it in the store
    key      (target, kind) -> the digest of all that a result depends on; by default of engine and target
    """

    kind: str
    key: Callable[[Target, str], str] = _of_the_target

    def keep(self, store: Store, target: Target, data: Any) -> None:
        """Keep the result of a target, in place of an earlier one."""
        self._keeping(store, target).keep(_ALL, data)
        before = self.stamp(store) + json.dumps(data)
        store.put(self.kind, _LATEST, hashlib.sha256(before.encode()).hexdigest().encode())

    def kept(self, store: Store, target: Target) -> Any | None:
        """Return the result kept for this target; None if there was none, or the target has changed since."""
        return self._keeping(store, target).kept(_ALL)

    def of_targets(self, store: Store, targets: Iterable[Target]) -> Mapping[str, Any]:
        """Return the result kept for each of these targets that has one, by its name."""
        found = {target.name: self.kept(store, target) for target in targets}
        return {name: data for name, data in found.items() if data is not None}

    def stamp(self, store: Store) -> str:
        """Return a value that changes whenever a result is kept, so that a cached report without it is not used."""
        entry = store.get(self.kind, _LATEST)
        return "" if entry is None else entry.data.decode()

    def _keeping(self, store: Store, target: Target) -> Keeping:
        return Keeping(self.kind, self.key(target, self.kind), store, store)
