"""Slots at the processors, shared by all processes of a run: they limit how many processes compute at the same time.

As in make's job server, a slot is a byte in a pipe: a process takes one to compute, and gives it back while it waits for
others.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import wait


class Slots:
    """A number of slots, for this process and those that are forked from it."""

    def __init__(self, slots: int) -> None:
        self.free, self._put = os.pipe()
        os.set_blocking(self.free, False)
        os.write(self._put, b"." * slots)

    def try_take(self) -> bool:
        """Take a slot if one is free."""
        with suppress(BlockingIOError):
            return bool(os.read(self.free, 1))
        return False

    def take(self) -> None:
        """Wait for a slot and take it."""
        while not self.try_take():
            wait([self.free])

    def give(self) -> None:
        """Give a slot back."""
        os.write(self._put, b".")

    def close(self) -> None:
        """Close the pipe; nobody may use it afterwards."""
        os.close(self.free)
        os.close(self._put)


_SHARED: list[Slots] = []


def shared() -> Slots | None:
    """Return the slots that this process shares with others; None if it shares none."""
    return _SHARED[-1] if _SHARED else None


@contextmanager
def sharing(slots: Slots) -> Iterator[None]:
    """Start processes inside the block only as slots become free."""
    _SHARED.append(slots)
    try:
        yield
    finally:
        _SHARED.pop()


@contextmanager
def resting() -> Iterator[None]:
    """Let other processes use this one's slot inside the block; take a slot again afterwards.

    A process that is told to end while it waits takes no slot again.
    """
    slots = shared()
    if slots is not None:
        slots.give()
    yield
    if slots is not None:
        slots.take()
