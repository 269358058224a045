"""Latency of a reader: telegrams until enough are whole, and processing; and the way of a vehicle past a marker."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safeloc.simulation.physics.reader_timing import FIGURES, ReaderTiming, Way, mounting, timing_of

PLAIN = ReaderTiming(0, 0, 0, 1.8, 0, 0, 0)
READINGS = 20_000


def drawn(*, processing: float = 0, jitter: float = 0, telegrams: int = 0, failed: float = 0) -> np.ndarray:
    """Latencies of so many readings, ms."""
    timing = ReaderTiming(processing, jitter, telegrams, 2.0, failed, 0, 0)
    return timing.latencies(np.random.default_rng(5), READINGS).late_ms


def test_by_default_a_reader_stamps_in_time() -> None:
    """Every default together is plain; latency, telegrams and mounting each are not."""
    figures = {name: np.array([one.default]) for name, one in {**FIGURES, **mounting("front")}.items()}
    timing = timing_of(figures, 0, "front")
    assert timing.plain and timing == PLAIN
    for name in ("reader_processing_ms", "reader_jitter_ms", "reader_telegrams", "front_mounting_mm"):
        assert not timing_of({**figures, name: np.array([3.0])}, 0, "front").plain


def test_processing_scatters_as_declared() -> None:
    """Mean and deviation as declared; where it would be below 0 it is 0."""
    found = drawn(processing=30, jitter=4)
    assert 30 == pytest.approx(found.mean(), abs=6 * 4 / math.sqrt(READINGS))
    assert 4 == pytest.approx(found.std(), rel=6 / math.sqrt(2 * READINGS))
    cut = drawn(jitter=4)
    assert 0 == cut.min()
    assert 0.5 == pytest.approx(float((cut == 0).mean()), abs=3 / math.sqrt(READINGS))


def test_telegrams_are_read_until_enough_are_whole() -> None:
    """Three whole ones of 2 ms of which every fourth fails: as many tries as the negative binomial distribution has it."""
    found = drawn(telegrams=3, failed=0.25)
    assert 6 == found.min()
    assert 3 / 0.75 * 2 == pytest.approx(found.mean(), rel=0.02)
    assert 2 * math.sqrt(3 * 0.25) / 0.75 == pytest.approx(found.std(), rel=0.05)
    assert 0.75**3 == pytest.approx(float((found == 6).mean()), abs=3 / math.sqrt(READINGS))
    assert {6.0} == set(drawn(telegrams=3).tolist())


def test_a_fast_vehicle_misses_a_marker() -> None:
    """1 m of contact is 5 telegrams of 2 ms at 100 m/s, and not one more."""
    latencies = ReaderTiming(0, 0, 5, 2.0, 0, 1_000, 0).latencies(np.random.default_rng(1), 1)
    assert latencies.heard(0, 100_000) and not latencies.heard(0, 100_001)
    assert latencies.heard(0, -100_000) and not latencies.heard(0, -100_001)
    assert ReaderTiming(0, 0, 5, 2.0, 0, 0, 0).latencies(np.random.default_rng(1), 1).heard(0, 1e9)


def test_the_way_past_a_place() -> None:
    """A vehicle runs 10 m, 20 m, stands, and rolls back: times are in between, and a place counts the first time."""
    way = Way(0, np.array([10, 30, 30, 25], dtype=np.int64) * 10**9, 100)
    assert [50, 100, 150, None, None] == [way.time_ms(place * 1e9) for place in (5, 10, 20, 31, -1)]
    assert [0, 10e9, 20e9, 30e9, 25e9, 25e9] == [way.at_nm(time) for time in (0, 100, 150, 300, 400, 900)]
    assert [0, 0, 1, 3] == [way.cycle_of(time) for time in (0.1, 100, 100.1, 400)]
    assert [100_000, 200_000, 0, -50_000] == [way.speed_mm_s(time) for time in (50, 150, 250, 350)]
