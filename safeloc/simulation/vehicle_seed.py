"""Random numbers of many vehicles: each sensor of each vehicle has a stream of its own, independent of all others.

    VehicleSeed(21, (12, 7)).rng("wheel")      vehicle 7 of shard 12 of a campaign with seed 21: the errors of its wheel

A stream is `numpy.random.SeedSequence(entropy, spawn_key=(*key, *number of the sensor))`, from which PCG64 is seeded. The number of a
sensor is made from its name, so a stream changes neither with the other sensors, nor with their order, nor with the vehicles beside it.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache

import numpy as np


@dataclass(frozen=True)
class VehicleSeed:
    """The seed of one vehicle: `entropy` of all vehicles together, and `key`, which tells them apart."""

    entropy: int
    key: tuple[int, ...] = ()

    def rng(self, sensor: str) -> np.random.Generator:
        """Return a new generator at the beginning of a sensor's stream."""
        key = (*self.key, *_number_of(sensor))
        return np.random.default_rng(np.random.SeedSequence(self.entropy, spawn_key=key))


@lru_cache(maxsize=256)
def _number_of(sensor: str) -> tuple[int, int]:
    """Return two words of 32 bits: SeedSequence takes such ones apart from each other."""
    digest = hashlib.sha256(sensor.encode()).digest()
    return int.from_bytes(digest[:4], "big"), int.from_bytes(digest[4:8], "big")
