"""Memory use of a run with all its processes, sampled from Linux's process table."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from pathlib import Path
from types import TracebackType

LOOKS_EVERY_S = 1.0
PROC = Path("/proc")


class Memory:
    """Samples the memory of this process and all its child processes; `most_bytes` is the maximum.

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
        while True:
            self.most_bytes = max(self.most_bytes, taken_bytes(os.getpid()))
            if self._over.wait(LOOKS_EVERY_S):
                return


def taken_bytes(process: int) -> int:
    """Return the memory of a process and of all that come of it, now."""
    return sum(map(_own_bytes, (process, *descendants(process))))


def _own_bytes(process: int) -> int:
    """Return the memory of a process, with its part of shared memory (Pss); 0 if it has ended."""
    with suppress(OSError, ValueError, StopIteration):
        told = (PROC / str(process) / "smaps_rollup").read_text().splitlines()
        return 1024 * int(next(line for line in told if line.startswith("Pss:")).split()[1])
    return 0


def descendants(process: int) -> list[int]:
    """Return the processes that come of a process, and of these."""
    children: dict[int, list[int]] = {}
    for path in PROC.glob("[0-9]*/stat"):
        with suppress(OSError, ValueError):
            after_name = path.read_text().rpartition(")")[2].split()
            children.setdefault(int(after_name[1]), []).append(int(path.parent.name))
    found, open_ = list[int](), list(children.get(process, ()))
    while open_:
        found.append(open_.pop())
        open_ += children.get(found[-1], ())
    return found
