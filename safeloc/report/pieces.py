"""Pieces of a report that are made independently of each other, in several processes at once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any, TypeVar

from safeloc.proof.provers.workers import Lost, Task, in_processes

_MOST_S = 600.0
Key = TypeVar("Key", bound=Hashable)


def made_pieces(pieces: Mapping[Key, Callable[[], Any]], jobs: int) -> dict[Key, Any]:
    """Return each piece, by its key: made here with one job, else in so many processes.

    A piece whose process was ended, by the system or after ten minutes, is made here. EngineError if making one raised an exception in a process.
    """
    if jobs < 2:
        return {key: make() for key, make in pieces.items()}
    keys, found = list(pieces), dict[Key, Any]()
    tasks = [Task(f"report: {key}", make, _MOST_S, follows=True) for key, make in pieces.items()]
    for number, answer, _ in in_processes(tasks, jobs):
        key = keys[number]
        found[key] = pieces[key]() if isinstance(answer, Lost) else answer
    return {key: found[key] for key in keys}
