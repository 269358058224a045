"""Every sensor of every vehicle draws from a stream of its own, and from the same one wherever it is asked."""

from __future__ import annotations

import hashlib
from itertools import combinations, product

import numpy as np

from safeloc.simulation.vehicle_seed import VehicleSeed

SENSORS = ("wheel", "check", "antenna", "radar", "satellite signals", "fibre")


def test_a_stream_depends_on_seed_vehicle_and_sensor_alone() -> None:
    """The same numbers again, whatever else was asked before."""
    one = VehicleSeed(21, (12, 7))
    expected = one.rng("wheel").random(5)
    one.rng("check").random(100)
    assert np.array_equal(expected, VehicleSeed(21, (12, 7)).rng("wheel").random(5))
    key = (12, 7, *_words("wheel"))
    documented = np.random.default_rng(np.random.SeedSequence(21, spawn_key=key))
    assert np.array_equal(expected, documented.random(5))


def _words(sensor: str) -> tuple[int, int]:
    digest = hashlib.sha256(sensor.encode()).hexdigest()
    return int(digest[:8], 16), int(digest[8:16], 16)


def test_no_two_streams_are_alike() -> None:
    """Neither of two vehicles, nor of two sensors of one, nor of two shards or campaigns: all correlations are those of chance."""
    keys = [
        (seed, (shard, vehicle), sensor) for seed, shard, vehicle, sensor in product((1, 2), (0, 1), (0, 1), SENSORS)
    ]
    number = 4_000
    streams = {key: VehicleSeed(key[0], key[1]).rng(key[2]).standard_normal(number) for key in keys}
    worst = max(abs(float(np.corrcoef(streams[one], streams[other])[0, 1])) for one, other in combinations(keys, 2))
    assert worst < 6 / number**0.5
    assert len({round(float(values[0]), 12) for values in streams.values()}) == len(keys)
