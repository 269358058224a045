"""Pieces of a report that are made independently of each other, in several processes at once, unless they are kept."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from safeloc.proof.provers.workers import Lost, Task, in_processes
from safeloc.report.kept_pieces import NOTHING_KEPT, KeptPieces

_MOST_S = 600.0
Name = TypeVar("Name", bound=Hashable)


@dataclass(frozen=True)
class Piece:
    """A piece: the function that makes it, and the key under which it is kept; "" for one that is not."""

    make: Callable[[], Any]
    key: str = ""


def made_pieces(pieces: Mapping[Name, Piece], jobs: int, kept: KeptPieces = NOTHING_KEPT) -> dict[Name, Any]:
    """Return each piece, by its name: as it is kept, or made here with one job, else in so many processes.

    A piece whose process was ended, by the system or after ten minutes, is made here. EngineError if making one raised an exception in a process.
    """
    found = {name: had for name, one in pieces.items() if (had := kept.found(one.key)) is not None}
    left = {name: one for name, one in pieces.items() if name not in found}
    for name, made in _made(left, jobs):
        found[name] = made
        kept.keep(left[name].key, made)
    return {name: found[name] for name in pieces}


def _made(pieces: Mapping[Name, Piece], jobs: int) -> Iterator[tuple[Name, Any]]:
    if jobs < 2:
        yield from ((name, one.make()) for name, one in pieces.items())
        return
    names = list(pieces)
    tasks = [Task(f"report: {name}", one.make, _MOST_S, follows=True) for name, one in pieces.items()]
    for number, answer, _ in in_processes(tasks, jobs):
        yield names[number], pieces[names[number]].make() if isinstance(answer, Lost) else answer
