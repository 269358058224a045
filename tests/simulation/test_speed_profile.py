"""Driving from halt to halt: places met exactly, limits kept over the whole train, and nothing beyond what it can do."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.simulation.motion import VehicleConfig
from safeloc.simulation.speed_profile import Halt, Limit, drive

TRAIN = VehicleConfig(length_mm=40_000)


def test_halts_are_met_to_the_nanometre() -> None:
    """Forwards, backwards and forwards again; standing as long as asked."""
    halts = [Halt(442_123, 3.0, 20_000), Halt(441_000, 2.0, 600), Halt(700_000, 1.0, 40_000)]
    motion = drive(TRAIN, halts, [], 100)
    stood = motion.position_nm[motion.speed_mm_s == 0]
    assert [442_123_000_000] * 30 + [441_000_000_000] * 20 + [700_000_000_000] * 10 == stood.tolist()
    assert -600 <= motion.speed_mm_s.min() < -590


def test_a_limit_holds_until_the_rear_has_left_it() -> None:
    """From its first place to the train's length beyond its last one."""
    motion = drive(TRAIN, [Halt(500_000, 1.0, 30_000)], [Limit(100_000, 200_000, 5_000)], 100)
    place = motion.position_nm / 1_000_000
    inside = (place >= 100_000) & (place <= 240_000)
    assert motion.speed_mm_s[inside].max() <= 5_000
    assert motion.speed_mm_s[place > 300_000].max() > 9_000


@settings(max_examples=25, deadline=None, derandomize=True, database=None)
@given(
    distance_mm=st.integers(1, 2_000_000),
    top_mm_s=st.integers(100, 40_000),
    limit=st.tuples(st.integers(0, 1_000_000), st.integers(0, 1_000_000), st.integers(50, 40_000)),
)
def test_nothing_beyond_what_the_vehicle_can_do(distance_mm: int, top_mm_s: int, limit: tuple[int, int, int]) -> None:
    """Whatever the way: forwards only, within speed, acceleration and brake, and there in the end."""
    low, high = sorted(limit[:2])
    motion = drive(TRAIN, [Halt(distance_mm, 0.5, top_mm_s)], [Limit(low, high, limit[2])], 100)
    assert distance_mm * 1_000_000 == motion.position_nm[-1]
    assert motion.distance_nm.min() >= 0
    assert motion.speed_mm_s.max() <= top_mm_s + 1e-6
    change = np.diff(motion.speed_mm_s, prepend=0.0) / 0.1
    assert change.max() <= TRAIN.acceleration_mm_s2 + 1e-6
    assert change.min() >= -TRAIN.brake_mm_s2 - 1e-6
    assert np.abs(motion.distance_nm / 1e5 - motion.speed_mm_s).max() <= 101


def test_a_speed_of_nothing_is_refused() -> None:
    """A limit of 0 would never be passed."""
    with pytest.raises(InputError, match="a speed limit of 0 on the way to it makes it unreachable"):
        drive(TRAIN, [Halt(1_000, 1.0, 100)], [Limit(0, 500, 0)], 100)
