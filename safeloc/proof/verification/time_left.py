"""Estimate of the time left for several targets, from their earlier times or from the time per finding of others."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

USUAL_SECONDS = 0.2
"""Seconds for a finding until the time of some target is known."""


class TimeLeft:
    """Expected time of a run. For each target it is that of an earlier run, else the time per finding of the known
    targets.

    findings  expected number of findings of each target
    seconds   times of targets in earlier runs
    jobs      number of targets verified at a time
    """

    def __init__(
        self,
        findings: Mapping[str, int],
        seconds: Mapping[str, float],
        jobs: int,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._findings, self._jobs, self._clock = dict(findings), max(1, jobs), clock
        self._known = {name: took for name, took in seconds.items() if name in findings}
        self._left = set(findings)
        self._begun: dict[str, float] = {}

    def began(self, target: str) -> None:
        """Record the start of a target."""
        self._begun[target] = self._clock()

    def over(self, target: str, seconds: float) -> None:
        """Record that a target is done; 0 seconds if it came from the cache, which does not change the estimate."""
        self._left.discard(target)
        if seconds:
            self._known[target] = seconds

    @property
    def seconds(self) -> float:
        """Seconds until all targets are done, with `jobs` targets at a time; at least the time left of the longest one."""
        left = [self._of(target) for target in self._left]
        return max([sum(left) / self._jobs, *left], default=0.0)

    def _of(self, target: str) -> float:
        expected = self._known.get(target, self._findings[target] * self._each)
        return max(0.0, expected - (self._clock() - self._begun[target] if target in self._begun else 0.0))

    @property
    def _each(self) -> float:
        """Seconds per finding of the targets whose time is known."""
        findings = sum(self._findings[name] for name in self._known)
        return sum(self._known.values()) / findings if findings else USUAL_SECONDS
