"""What was seen, a line a window: counts, memory, processor time, latencies; kept in a file that a later start goes on from."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

BUCKETS_PER_E = 50
"""Latencies are counted in buckets that are 2 % wide."""


@dataclass
class Window:
    """A stretch of the fleet's time.

    life          how often the process had been started
    late_s        by so much the fleet's clock was held up: the machine was too slow, or the process was started
    waited        share of the time in which the process, or the sender if it was more, was ready and had no core
    driving       vehicles that spoke
    cycles        that were sent; `reports` that came, `located` of them with a place, `refused` lines
    wrong         reports that missed the truth, or were of no vehicle of the fleet; `first_wrong` says which
    latency       from the cycle sent to its report read: bucket -> reports
    """

    number: int
    from_ms: int
    to_ms: int
    life: int = 0
    wall_s: float = 0.0
    late_s: float = 0.0
    processor_s: float = 0.0
    waited: float = 0.0
    load: float = 0.0
    resident_kib: int = 0
    driving: int = 0
    cycles: int = 0
    reports: int = 0
    located: int = 0
    refused: int = 0
    wrong: int = 0
    first_wrong: str = ""
    ended: str = ""
    failures: list[str] = field(default_factory=list)
    mishaps: dict[str, int] = field(default_factory=dict)
    latency: dict[str, int] = field(default_factory=dict)
    worst_ms: float = 0.0

    def befell(self, name: str) -> None:
        """Count a mishap."""
        self.mishaps[name] = self.mishaps.get(name, 0) + 1

    def answered(self, latency_s: float) -> None:
        """Count the latency of a report."""
        bucket = str(round(BUCKETS_PER_E * math.log(max(latency_s, 1e-6) * 1_000)))
        self.latency[bucket] = self.latency.get(bucket, 0) + 1
        self.worst_ms = max(self.worst_ms, round(latency_s * 1_000, 3))

    def missed(self, told: str) -> None:
        """Count a wrong report."""
        self.wrong += 1
        self.first_wrong = self.first_wrong or told[:1_000]


def at_share(latencies: Iterable[Mapping[str, int]], share: float) -> float:
    """The latency in ms that this share of the reports keeps within; 0 without any."""
    counted: Counter[int] = Counter()
    for one in latencies:
        counted.update({int(bucket): count for bucket, count in one.items()})
    left = share * counted.total()
    for bucket in sorted(counted):
        left -= counted[bucket]
        if left <= 0:
            return math.exp(bucket / BUCKETS_PER_E)
    return 0.0


def as_line(window: Window) -> dict[str, Any]:
    """A window as plain data, with the percentiles that people look for."""
    shown = {f"p{share}_ms": round(at_share([window.latency], share / 100), 3) for share in (50, 99)}
    return {**asdict(window), **shown}


def as_window(line: Mapping[str, Any]) -> Window:
    """And back."""
    return Window(**{one.name: line[one.name] for one in fields(Window)})
