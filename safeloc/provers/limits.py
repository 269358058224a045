"""How far a prover may go."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Bounds on one property: steps for bounded search, k for induction, seconds of time, and the solver's seed."""

    depth: int = 25
    induction: int = 3
    seconds: float = 30.0
    seed: int = 0

    @property
    def milliseconds(self) -> int:
        """The time limit in ms."""
        return max(1, int(self.seconds * 1000))
