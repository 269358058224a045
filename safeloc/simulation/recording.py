"""Converts a simulated run to records, as a vehicle's recorder would write them, with the true positions."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.runtime.streams.records import DistanceRecord, End, MarkerRecord, Record, TruthRecord
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import Distances, Reading

_ENDS: tuple[End, End] = ("front", "rear")


def records(motion: Motion, units: Sequence[Distances], readings: Sequence[Reading]) -> list[Record]:
    """Return the records in order of time; cycle n (from 0) ends at (n + 1) periods. Unit names begin with `front_` or `rear_`."""
    by_cycle: dict[int, list[Reading]] = {}
    for reading in readings:
        by_cycle.setdefault(reading.cycle, []).append(reading)
    made: list[Record] = []
    for cycle, position in enumerate(motion.position_nm):
        time_ms = (cycle + 1) * motion.period_ms
        made += [_distance(unit, cycle, time_ms) for unit in units if unit.present[cycle]]
        made += [_marker(reading, time_ms) for reading in by_cycle.get(cycle, ())]
        made.append(TruthRecord(time_ms=time_ms, position_nm=int(position)))
    return made


def _distance(unit: Distances, cycle: int, time_ms: int) -> DistanceRecord:
    end, _, kind = unit.name.partition("_")
    return DistanceRecord(
        time_ms=time_ms, end="front" if end == "front" else "rear", unit=kind, distance_mm=int(unit.distance_mm[cycle])
    )


def _marker(reading: Reading, time_ms: int) -> MarkerRecord:
    if reading.place_mm is None:
        return MarkerRecord(time_ms=time_ms, end=_ENDS[reading.end], marker=reading.marker)
    return MarkerRecord(
        time_ms=time_ms,
        end=_ENDS[reading.end],
        marker=reading.marker,
        position_mm=reading.place_mm,
        accuracy_mm=reading.accuracy_mm,
        since_mm=reading.since_mm,
    )
