"""Simulates test emitters beside the track: a tone switched on and off by the bits of a pattern (FVA-8)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.errors import InputError
from safeloc.sensing.array_types import Floats
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.simulation.fibre.cable import Cable


@dataclass(frozen=True)
class Sounding:
    """A pattern sent once, from `begin_s` on, at a place of the fibre, with `strain` in 1e-9 there."""

    bits: str
    fibre_m: float
    begin_s: float
    strain: float = 3.0
    spread_m: float = 6.0

    def __post_init__(self) -> None:
        if not self.bits or set(self.bits) - {"0", "1"}:
            raise InputError(f"a pattern consists of 0 and 1, not {self.bits!r}.")


def emitted(
    config: FibreConfig, soundings: Sequence[Sounding], seconds: Floats, cable: Cable
) -> Iterator[tuple[slice, Floats]]:
    """Yield pieces (cells, strain [frames, cells]) of all patterns that are on at these times."""
    bit_s = config.emission.bit_windows * config.window_ms / 1_000
    for one in soundings:
        bit = np.floor((seconds - one.begin_s) / bit_s).astype(np.int64)
        sounding = np.array([0 <= number < len(one.bits) and one.bits[number] == "1" for number in bit])
        if sounding.any():
            tone = np.sqrt(2) * one.strain * sounding * np.sin(2 * np.pi * config.emission.tone_hz * seconds)
            places = cable.places_m
            first, last = np.searchsorted(places, [one.fibre_m - 10 * one.spread_m, one.fibre_m + 10 * one.spread_m])
            away = (places[first:last] - one.fibre_m) / one.spread_m
            yield slice(int(first), int(last)), tone[:, None] / (1 + away * away)
