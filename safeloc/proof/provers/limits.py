"""How far a prover may go."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from safeloc.errors import InputError, declared_at


@dataclass(frozen=True)
class Limits:
    """Bounds on one property: steps for bounded search, k for induction, seconds of time, and the solver's seed.

    InputError for a negative depth, a k below 1, and a time that is no positive finite number.
    """

    depth: int = 25
    induction: int = 3
    seconds: float = 30.0
    seed: int = 0

    def __post_init__(self) -> None:
        if self.depth < 0 or self.induction < 1:
            raise InputError(
                f"{declared_at()}: limits of depth {self.depth} and induction {self.induction}; depth must be 0 or "
                "more, induction 1 or more."
            )
        if not (math.isfinite(self.seconds) and self.seconds > 0):
            raise InputError(f"{declared_at()}: a time limit of {self.seconds} s; it must be positive and finite.")

    @property
    def milliseconds(self) -> int:
        """The time limit in ms."""
        return milliseconds(self.seconds)


@dataclass(frozen=True)
class Deadline:
    """A moment of the monotonic clock."""

    at: float

    @property
    def left(self) -> float:
        """Seconds until then; 0 once it has passed."""
        return max(0.0, self.at - time.monotonic())

    @property
    def passed(self) -> bool:
        """Whether no time is left."""
        return self.left == 0.0


def deadline(seconds: float) -> Deadline:
    """The moment `seconds` from now."""
    return Deadline(time.monotonic() + seconds)


def milliseconds(seconds: float) -> int:
    """Seconds as a solver's time limit: at least 1 ms, since 0 means `no limit` to solvers."""
    return max(1, int(seconds * 1000))
