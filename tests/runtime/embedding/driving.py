"""A short drive that locates the odometry machine: records of every cycle, and the same as inputs."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from safeloc.catalogue import load_target
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Program
from safeloc.runtime.streams.records import DistanceRecord, End, MarkerRecord, Record
from safeloc.shipped_machines import ENTRIES

PERIOD_MS = 100
STEP_MM = 1_200
ENDS: tuple[End, End] = ("front", "rear")


@cache
def trusting() -> Program:
    """Odometry that believes its first marker."""
    return Program(ENTRIES["odometry"].make(OdometryConfig(trust_first_marker=True)))


@cache
def shipped(name: str) -> Program:
    """A shipped machine with its defaults."""
    return Program(load_target(name))


def distances(end_ms: int, distance_mm: int = STEP_MM) -> list[Record]:
    """What four units say in the cycle that ends then."""
    return [
        DistanceRecord(time_ms=end_ms, end=end, unit=unit, distance_mm=distance_mm)
        for end in ENDS
        for unit in ("wheel", "radar")
    ]


def marker(end_ms: int, identity: int = 7, position_mm: int = 250_000) -> MarkerRecord:
    """A marker read at the front."""
    return MarkerRecord(
        time_ms=end_ms, end="front", marker=identity, position_mm=position_mm, accuracy_mm=500, since_mm=310
    )


def drive(cycles: int, first: int = 1) -> Iterator[list[Record]]:
    """Records of each cycle: a marker in the second one and every 50 cycles after."""
    for cycle in range(first, first + cycles):
        end_ms = cycle * PERIOD_MS
        read = [marker(end_ms, 7 + cycle // 50, 250_000 + (cycle - 2) * STEP_MM)] if cycle % 50 == 2 else []
        yield [*distances(end_ms), *read]
