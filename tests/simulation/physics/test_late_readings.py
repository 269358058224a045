"""Readings of a late reader: the run since the time stamp is shorter, by speed x latency, and the place of the marker is the true one."""

from __future__ import annotations

import numpy as np

from safeloc.simulation.physics.late_readings import late_readings
from safeloc.simulation.physics.reader_timing import ReaderTiming, Way
from safeloc.simulation.sensors import Reading

WAY = Way(0, np.arange(1, 101, dtype=np.int64) * 2_000_000_000, 100)
"""20 m/s in cycles of 100 ms."""
SPOT = Reading(10, 0, 7, 20_300, 1_000, 1_500)
"""Read at 20.5 m, in the eleventh cycle, which ends at 22 m; the map has the marker 0.2 m too near."""


def told(timing: ReaderTiming, *readings: Reading, offset_mm: int = 0) -> list[Reading]:
    """What the reader tells."""
    return late_readings(readings, WAY, offset_mm, timing, np.random.default_rng(0))


def late(processing: float = 0, mounting: float = 0, telegrams: int = 0, contact: float = 0) -> ReaderTiming:
    """A reader without scatter."""
    return ReaderTiming(processing, 0, telegrams, 2.0, 0, contact, mounting)


def test_a_reader_in_time_tells_what_was_read() -> None:
    """Nothing is changed, and nothing said of where the marker truly is."""
    assert [SPOT] == told(late(), SPOT)


def test_the_place_moves_by_speed_times_latency() -> None:
    """30 ms at 20 m/s are 0.6 m, in the same cycle; 100 ms are 2 m, and the stamp is in the next cycle."""
    (one,) = told(late(30), SPOT)
    assert (10, 900, 20_500_000_000) == (one.cycle, one.since_mm, one.spot_nm)
    (one,) = told(late(100), SPOT)
    assert (11, 1_500, 20_500_000_000) == (one.cycle, one.since_mm, one.spot_nm)
    assert [] == told(late(9_000), SPOT)


def test_a_reader_that_is_mounted_ahead_reads_sooner() -> None:
    """By what it is ahead; also at the other end, and back into the cycle before."""
    assert [(10, 1_800)] == [(one.cycle, one.since_mm) for one in told(late(mounting=300), SPOT)]
    assert [(10, 1_200)] == [(one.cycle, one.since_mm) for one in told(late(mounting=-300), SPOT)]
    assert [(9, 0)] == [(one.cycle, one.since_mm) for one in told(late(mounting=500), SPOT)]
    rear = Reading(60, 1, 7, 20_300, 1_000, 1_500)
    (one,) = told(late(30), rear, offset_mm=100_000)
    assert (60, 900, 20_500_000_000) == (one.cycle, one.since_mm, one.spot_nm)


def test_of_two_in_a_cycle_the_later_one_is_told_and_foreign_ones_stay() -> None:
    """And a marker that is passed too fast to read enough telegrams is missed."""
    foreign = Reading(40, 0, 900_001, None, 0, 0)
    other = Reading(11, 0, 8, 22_100, 1_000, 1_900)
    assert [8, 900_001] == [one.marker for one in told(late(80), SPOT, other, foreign)]
    assert [900_001] == [one.marker for one in told(late(telegrams=5, contact=199), SPOT, foreign)]
    assert [7, 900_001] == [one.marker for one in told(late(telegrams=5, contact=200), SPOT, foreign)]
