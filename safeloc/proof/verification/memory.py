"""Memory use of a run with all its processes, sampled from Linux's process table."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

LOOKS_EVERY_S = 5.0
PROC = Path("/proc")


class Memory:
    """Samples the memory of this process and of all its descendants; `most_bytes` is the maximum.

    Shared memory counts once. 0 if the system does not provide the figures.
    """

    def __init__(self) -> None:
        self.most_bytes = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)

    def __enter__(self) -> Memory:
        self._thread.start()
        return self

    def __exit__(self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None) -> None:
        self._over.set()
        self._thread.join()

    def _look(self) -> None:
        known: dict[int, Taken] = {}
        while True:
            known = taken(os.getpid(), known)
            self.most_bytes = max(self.most_bytes, sum(one.size_bytes for one in known.values()))
            if self._over.wait(LOOKS_EVERY_S):
                return


@dataclass(frozen=True)
class Taken:
    """The memory of a process, and the processor time that it had used when this was measured."""

    size_bytes: int
    ticks: int


@dataclass(frozen=True)
class _Process:
    parent: int
    ticks: int


def taken(process: int, known: Mapping[int, Taken]) -> dict[int, Taken]:
    """Return the memory of a process and of each of its descendants.

    The system needs milliseconds to add up the pages of a large process. A process that has not run since `known` was
    measured keeps that figure.
    """
    every, found = _processes(), dict[int, Taken]()
    for one in (process, *_descendants(process, every)):
        ticks = every[one].ticks if one in every else -1
        before = known.get(one)
        found[one] = before if before and before.ticks == ticks else Taken(_own_bytes(one), ticks)
    return found


def _own_bytes(process: int) -> int:
    """Return the memory of a process in bytes, with its part of shared memory (Pss); 0 if it has ended."""
    with suppress(OSError, ValueError, StopIteration):
        lines = (PROC / str(process) / "smaps_rollup").read_text().splitlines()
        return 1024 * int(next(line for line in lines if line.startswith("Pss:")).split()[1])
    return 0


def _processes() -> dict[int, _Process]:
    """Return all processes of the system by id."""
    found: dict[int, _Process] = {}
    for path in PROC.glob("[0-9]*/stat"):
        with suppress(OSError, ValueError):
            after_name = path.read_text().rpartition(")")[2].split()
            found[int(path.parent.name)] = _Process(int(after_name[1]), int(after_name[11]) + int(after_name[12]))
    return found


def descendants(process: int) -> list[int]:
    """Return the ids of all descendants of a process."""
    return _descendants(process, _processes())


def _descendants(process: int, every: Mapping[int, _Process]) -> list[int]:
    children: dict[int, list[int]] = {}
    for one, about in every.items():
        children.setdefault(about.parent, []).append(one)
    found, open_ = list[int](), list(children.get(process, ()))
    while open_:
        found.append(open_.pop())
        open_ += children.get(found[-1], ())
    return found
