"""Work in several processes, of which each result is kept: what an earlier run kept of the same content is not done again."""

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
    """Pieces of work that one process does: the task returns the plain data of each, in the order of the names."""

    names: tuple[str, ...]
    task: Task


@dataclass(frozen=True)
class Keeping:
    """A place for results: their kind, and the digest of everything they depend on beside their name.

    look_in  where an earlier run kept what it found; None looks at nothing
    keep_in  where each result is kept as soon as it is there, so that an interrupted run goes on from there
    """

    kind: str
    key: str
    look_in: Store | None = None
    keep_in: Store | None = None

    def kept(self, name: str) -> Any:
        """Return what was kept under this name, as plain data; None where nothing was."""
        entry = None if self.look_in is None else self.look_in.get(self.kind, self._place(name))
        return None if entry is None else json.loads(entry.data)

    def keep(self, name: str, data: Any) -> None:
        """Keep plain data, if the engine's files are still those that made it."""
        if self.keep_in is not None and undisturbed():
            self.keep_in.put(self.kind, self._place(name), json.dumps(data).encode())

    def _place(self, name: str) -> str:
        return f"{self.key}-{name}"


def kept_or_done(
    names: Sequence[str], batches: Callable[[Sequence[str]], Sequence[Batch]], keeping: Keeping, jobs: int
) -> Iterator[tuple[str, Any | Lost]]:
    """Return the result of each piece of work by name: those that are kept first, the others as they come.

    batches  makes the work of those that are not kept; it is not called where all are
    Data that is new and data that was kept are alike: both have come through JSON. What a process lost is not kept.
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
