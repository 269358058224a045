"""Places at the processors, shared by all processes of a run: so many compute at once, however many there are.

As in make's job server, a place is a byte in a pipe: who computes has taken one, who waits for others has put it back.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import wait


class Slots:
    """So many places, for this process and those that are forked from it."""

    def __init__(self, places: int) -> None:
        self.free, self._put = os.pipe()
        os.set_blocking(self.free, False)
        os.write(self._put, b"." * places)

    def try_take(self) -> bool:
        """Take a place if one is free."""
        with suppress(BlockingIOError):
            return bool(os.read(self.free, 1))
        return False

    def take(self) -> None:
        """Wait for a place and take it."""
        while not self.try_take():
            wait([self.free])

    def give(self) -> None:
        """Put a place back."""
        os.write(self._put, b".")

    def close(self) -> None:
        """Close the pipe; nobody may use it afterwards."""
        os.close(self.free)
        os.close(self._put)


_SHARED: list[Slots] = []


def shared() -> Slots | None:
    """Return the places that this process shares with others; None where it has the machine for itself."""
    return _SHARED[-1] if _SHARED else None


@contextmanager
def sharing(slots: Slots) -> Iterator[None]:
    """Within, processes are started only as places become free."""
    _SHARED.append(slots)
    try:
        yield
    finally:
        _SHARED.pop()


@contextmanager
def resting() -> Iterator[None]:
    """Within, this process waits and others may compute in its place; afterwards it has one again.

    A process that is told to end while it waits does not wait for a place any more.
    """
    places = shared()
    if places is not None:
        places.give()
    yield
    if places is not None:
        places.take()
