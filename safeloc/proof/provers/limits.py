"""Limits of provers, in units that solvers count, so that results are the same on a busy computer as on an idle one.

One second of effort is the work of a solver in about one second on an idle machine, by the solver's own resource count.
The clock ends work only after several times the limit.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from safeloc.errors import InputError, declared_at

CLOCK = 20.0
"""Multiple of a limit after which the clock ends the work, whatever effort was counted."""


@dataclass(frozen=True)
class Limits:
    """Bounds on one property: steps for bounded search, k for induction, seconds of effort, and the solver's seed.

    confirming  seconds of effort for the re-check of a proof, if an engine gets only a share of the time; None: `seconds`
    InputError for a negative depth, a k below 1, and a time that is no positive finite number.
    """

    depth: int = 25
    induction: int = 3
    seconds: float = 30.0
    seed: int = 0
    confirming: float | None = None

    @property
    def recheck_seconds(self) -> float:
        """Return seconds of effort for the re-check of a proof."""
        return self.seconds if self.confirming is None else self.confirming

    def __post_init__(self) -> None:
        if self.depth < 0 or self.induction < 1:
            raise InputError(
                f"{declared_at()}: limits of depth {self.depth} and induction {self.induction}; depth must be 0 or "
                "more, induction 1 or more."
            )
        if not (math.isfinite(self.seconds) and self.seconds > 0):
            raise InputError(f"{declared_at()}: a time limit of {self.seconds} s; it must be positive and finite.")


@dataclass(frozen=True)
class Deadline:
    """A limit on the effort of this process, and a latest time on the clock as the last resort against a hung solver."""

    at: float
    latest: float

    @property
    def left(self) -> float:
        """Seconds of effort until the deadline; 0 once it has passed."""
        return 0.0 if self.overdue else max(0.0, self.at - effort())

    @property
    def overdue(self) -> bool:
        """True if the clock ends it, whatever effort is left."""
        return _clock() >= self.latest

    @property
    def passed(self) -> bool:
        """True if no effort is left."""
        return self.left == 0.0


def deadline(seconds: float) -> Deadline:
    """Make a deadline of the given seconds of effort from now."""
    return Deadline(effort() + seconds, _clock() + clock_multiple() * seconds)


_multiple = [CLOCK]


def clock_multiple() -> float:
    """Return the multiple of a limit after which the clock ends work in this process."""
    return _multiple[0]


@contextmanager
def clock_after(multiple: float) -> Iterator[None]:
    """Let the clock end work inside the block after another multiple of the limit than CLOCK.

    A smaller one suits a search of many questions, of which some take a solver long for little counted effort, and of which none that is
    left open is kept: on a busy computer more of them may be left open.
    """
    before, _multiple[0] = _multiple[0], multiple
    try:
        yield
    finally:
        _multiple[0] = before


def spend(seconds: float) -> None:
    """Add to the effort of this process: resources that a solver counted, or steps that were drawn."""
    _spent[0] += seconds


def effort() -> float:
    """Return seconds of effort that this process has counted so far."""
    return _spent[0]


_spent = [0.0]


@contextmanager
def clock_stopped() -> Iterator[None]:
    """Stop the clock of deadlines inside the block: this process waits for the work of another one."""
    began = time.monotonic()
    try:
        yield
    finally:
        _waited[0] += time.monotonic() - began


def _clock() -> float:
    """Return the clock's seconds, without those in which it was stopped."""
    return time.monotonic() - _waited[0]


_waited = [0.0]


def milliseconds(seconds: float) -> int:
    """Return seconds as a solver's time limit: at least 1 ms, since 0 means `no limit` to solvers."""
    return max(1, int(seconds * 1000))
