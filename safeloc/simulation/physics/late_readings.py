"""Readings of markers with the latency and the mounting of their reader: in the cycle of the time stamp, with the run since then."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from safeloc.language.units import NM_PER_MM
from safeloc.simulation.physics.reader_timing import ReaderTiming, Way
from safeloc.simulation.sensors import Reading


def late_readings(
    readings: Sequence[Reading], way: Way, offset_mm: int, timing: ReaderTiming, rng: np.random.Generator
) -> list[Reading]:
    """Return the readings of a reader `offset_mm` behind end A, each with the true place of its marker; foreign ones as they are.

    way  of end A. Of several readings in one cycle the reader tells the last one
    """
    if timing.plain:
        return list(readings)
    drawn = timing.latencies(rng, len(readings))
    found: dict[int, Reading] = {}
    for number, one in enumerate(readings):
        if one.place_mm is None:
            found[one.cycle] = one
            continue
        spot_nm = int(way.position_nm[one.cycle]) - (offset_mm + one.since_mm) * NM_PER_MM
        met_ms = way.time_ms(spot_nm + (offset_mm - timing.mounting_mm) * NM_PER_MM)
        if met_ms is None or not drawn.heard(number, way.speed_mm_s(met_ms)):
            continue
        stamped_ms = met_ms + float(drawn.late_ms[number])
        cycle = way.cycle_of(stamped_ms)
        if 0 <= cycle < len(way.position_nm):
            since_mm = round((int(way.position_nm[cycle]) - way.at_nm(stamped_ms)) / NM_PER_MM)
            found[cycle] = replace(one, cycle=cycle, since_mm=since_mm, spot_nm=spot_nm)
    return [found[cycle] for cycle in sorted(found)]
