"""How much faster than real time the fibre front end is: 40 km, 10 m channels, 1 kHz, one core.

python -m benchmarks.fibre_speed [blocks measured, 20 unless told]

Blocks carry noise and eight trains spread along the fibre, made beforehand and used in turn; only the front end is
timed, in processor time, with linear algebra kept to one thread.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.sensing.fibre.blocks import FibreBlock
from safeloc.sensing.fibre.features import FibreFrame
from safeloc.sensing.fibre.figures import Emission, Emitter, FibreConfig, Interrogator
from safeloc.sensing.fibre.front_end import FrontEnd

TARGET = 20
TRAINS = 8
LENGTH_MM, SPEED_MM_S = 250_000, 30_000
NOISE_RAD, TRAIN_RAD = 0.03, 0.6
EMITTER = Emitter(id="E1", fibre_mm=20_000_000, bits="1100101011110001")


@dataclass(frozen=True)
class Speed:
    """Seconds of fibre, seconds of processor, the slowest block's share of its own time, trains told in the last block."""

    fibre_s: float
    processor_s: float
    slowest: float
    trains: int

    @property
    def times_real(self) -> float:
        """How much faster than real time."""
        return self.fibre_s / self.processor_s


def configured(fibre_mm: int = 40_000_000) -> FibreConfig:
    """The issue's fibre, with an emitter to listen for."""
    place = EMITTER.model_copy(update={"fibre_mm": fibre_mm // 2})
    return FibreConfig(interrogator=Interrogator(fibre_mm=fibre_mm), emission=Emission(emitters=(place,)))


def blocks(config: FibreConfig, count: int, trains: int, rng: np.random.Generator) -> Iterator[FibreBlock]:
    """Noise, and from the learning time on trains as louder channels that move: what matters to speed."""
    inter, frames = config.interrogator, config.band.block_frames
    noise = [_noise(frames, inter.channels, rng) for _ in range(2)]
    intensity = rng.exponential(1.0, inter.light_channels).astype(np.float32)
    for number in range(count):
        rate = noise[number % 2].copy()
        for train in range(trains):
            front = (train + 0.5) * inter.fibre_mm / trains + SPEED_MM_S * number * frames / inter.frame_hz
            first, last = (int(place // inter.channel_mm) for place in (front - LENGTH_MM, front))
            rate[:, max(first, 0) : last] *= np.float32(TRAIN_RAD / NOISE_RAD)
        rate[number % frames] *= np.float32(1.001)
        yield FibreBlock(rate, intensity, round((number + 1) * frames * 1_000 / inter.frame_hz), number)


def _noise(frames: int, channels: int, rng: np.random.Generator) -> NDArray[np.float32]:
    return np.float32(NOISE_RAD) * rng.standard_normal((frames, channels), dtype=np.float32)


def measured(config: FibreConfig, count: int, trains: int = TRAINS) -> Speed:
    """Of `count` blocks after the time in which quiet is learnt and trains are confirmed."""
    front = FrontEnd(config, max_age_ms=1_000)
    rng = np.random.default_rng(0)
    block_s = config.band.block_frames / config.interrogator.frame_hz
    first = round(config.detection.floor_s / block_s)
    settled = first + round(2 * config.detection.confirm_ms / 1_000 / block_s) + 2
    spent: list[float] = []
    told = 0
    for number, block in enumerate(_in_time(config, first, settled + count, trains, rng)):
        began = time.process_time()
        outcome = front.receive(block, block.time_ms)
        if number >= settled:
            spent.append(time.process_time() - began)
            told = len(outcome.trains) if isinstance(outcome, FibreFrame) else 0
    return Speed(count * block_s, sum(spent), max(spent) / block_s, told)


def _in_time(
    config: FibreConfig, first: int, count: int, trains: int, rng: np.random.Generator
) -> Iterator[FibreBlock]:
    """Trains come when quiet is learnt."""
    yield from blocks(config, first, 0, rng)
    duration = round(config.band.block_frames * 1_000 / config.interrogator.frame_hz)
    for block in blocks(config, count - first, trains, rng):
        yield FibreBlock(block.phase_rate, block.intensity, block.time_ms + first * duration, block.sequence + first)


def main(count: int) -> None:
    """Print what was measured."""
    config = configured()
    speed = measured(config, count)
    channels, rate = config.interrogator.channels, config.interrogator.frame_hz
    print(
        f"{channels} channels, {rate} Hz, {speed.trains} trains told: {speed.times_real:.0f} times real time (target {TARGET}),"
    )
    print(
        f"{channels * rate * speed.times_real / 1e6:.0f} M samples/s; slowest block took {100 * speed.slowest:.1f} % of its time"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
