"""Work in several processes with cached results: a result of an earlier run with the same content is used again."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from safeloc.proof.cache.engine import undisturbed
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.workers import Lost, Task, in_processes


@dataclass(frozen=True)
class Batch:
    """Pieces of work for one process: the task returns the plain data of each, in the order of the names."""

    names: tuple[str, ...]
    task: Task


def _always(_: Any) -> bool:
    return True


@dataclass(frozen=True)
class Keeping:
    """The cache for results: their kind, and the digest of everything besides their name that they depend on.

    look_in  store with results of earlier runs; None: none is used
    keep_in  store for new results; each is stored at once, so that the next run continues after an interruption
    decided  whether a result is one that every run would find: one that the limits left open is not stored
    """

    kind: str
    key: str
    look_in: Store | None = None
    keep_in: Store | None = None
    decided: Callable[[Any], bool] = _always

    def kept(self, name: str) -> Any:
        """Return the stored result of this name as plain data; None if there is none."""
        entry = None if self.look_in is None else self.look_in.get(self.kind, self._place(name))
        return None if entry is None else json.loads(entry.data)

    def keep(self, name: str, data: Any) -> None:
        """Store plain data, unless files of the engine have changed since it was loaded."""
        if self.keep_in is not None and self.decided(data) and undisturbed():
            self.keep_in.put(self.kind, self._place(name), json.dumps(data).encode())

    def _place(self, name: str) -> str:
        return f"{self.key}-{name}"


def kept_or_done(
    names: Sequence[str], batches: Callable[[Sequence[str]], Sequence[Batch]], keeping: Keeping, jobs: int
) -> Iterator[tuple[str, Any | Lost]]:
    """Yield the result of each piece of work with its name: stored ones first, then new ones as soon as they are complete.

    batches  returns the work for names without a stored result; not called if there are none

    New data are converted to JSON and back, so they equal stored data. A lost result is not stored.
    """
    left = list[str]()
    for name in names:
        data = keeping.kept(name)
        if data is None:
            left.append(name)
        else:
            yield name, data
    made = batches(left) if left else ()
    for number, found, _ in in_processes([one.task for one in made], jobs):
        for name, data in _by_name(made[number], found):
            if not isinstance(data, Lost):
                keeping.keep(name, data)
            yield name, data


def _by_name(batch: Batch, found: Any | Lost) -> Iterator[tuple[str, Any | Lost]]:
    if isinstance(found, Lost):
        yield from ((name, found) for name in batch.names)
        return
    yield from zip(batch.names, (json.loads(json.dumps(one)) for one in found), strict=True)
