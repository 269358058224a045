"""Simulated samples of a counting head while wheels roll over it: damped channels, and the true place of the wheel.

A wheel damps channel A over one stretch and channel B over the next; where the two stretches overlap it damps both.

`python -m safeloc.models.axle_head.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from random import Random

from safeloc.language.units import UM_PER_MM, US_PER_S
from safeloc.models.axle_head import AxleHeadConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_CLEARANCE_MM = 40  # a run begins and ends with both channels free
_BOGIE_MM = 2_500
ALIVE: Mapping[str, Cell] = {"channel_a_alive": True, "channel_b_alive": True}


@dataclass(frozen=True)
class Roll:
    """Wheels one behind the other, and their motion.

    behind_mm    every wheel's distance behind the first one
    speeds       (mm/s, ms) one after the other; negative: downwards
    """

    behind_mm: tuple[int, ...]
    speeds: tuple[tuple[int, int], ...]


def through(config: AxleHeadConfig, behind_mm: tuple[int, ...], speed_mm_s: int) -> Roll:
    """Return all wheels rolling over the head at one speed."""
    way = _length_mm(config) + behind_mm[-1] + 2 * _clearance_mm(config, speed_mm_s)
    return Roll(behind_mm, ((speed_mm_s, way * 1_000 // abs(speed_mm_s) + 1),))


def samples(config: AxleHeadConfig, rolls: Sequence[Roll]) -> Steps:
    """Return the rolls one after the other as steps: both channels, and the ghost input."""
    return [_sample(config, place) for roll in rolls for place in _places(config, roll)]


def simulate(config: AxleHeadConfig, *, seed: int) -> Steps:
    """Return eight vehicles of two or four wheels, in either direction, each at its own speed; for a while a channel is not alive."""
    return cut_somewhere(samples(config, drawn(config, seed=seed)), seed=seed)


def drawn(config: AxleHeadConfig, *, seed: int) -> list[Roll]:
    """Return the rolls of eight vehicles of two or four wheels, in either direction, each at its own speed."""
    rng = Random(seed)
    rolls = []
    for _ in range(8):
        wheels = (0, _BOGIE_MM) if rng.random() < 0.5 else (0, rng.randint(4_000, 9_000))
        rolls.append(through(config, wheels, rng.choice((1, -1)) * rng.randint(5_000, config.max_speed_mm_s)))
    return rolls


def _length_mm(config: AxleHeadConfig) -> int:
    """Return the distance from the beginning of A to the end of B."""
    return 2 * config.spacing_mm + config.overlap_mm


def _clearance_mm(config: AxleHeadConfig, speed_mm_s: int) -> int:
    """Return the free rail on either side of the head: at least the run between two samples."""
    return max(_CLEARANCE_MM, abs(speed_mm_s) * config.sample_us // US_PER_S + 1)


def _places(config: AxleHeadConfig, roll: Roll) -> list[int]:
    """Return the place of the wheel nearest to the head, um above its low end, sample by sample."""
    ahead, middle = (1 if roll.speeds[0][0] > 0 else -1), _length_mm(config) * UM_PER_MM // 2
    clearance = _clearance_mm(config, roll.speeds[0][0])
    first = -clearance if ahead > 0 else _length_mm(config) + clearance
    at_um, places = first * UM_PER_MM, list[int]()
    for speed, lasts_ms in roll.speeds:
        for _ in range(lasts_ms * 1_000 // config.sample_us):
            at_um += speed * config.sample_us * UM_PER_MM // US_PER_S
            here = [at_um - ahead * behind * UM_PER_MM for behind in roll.behind_mm]
            places.append(min(here, key=lambda place: abs(place - middle)))
    return places


def _over(config: AxleHeadConfig, at_um: int) -> tuple[bool, bool]:
    """Return the channels that a wheel damps: A, B."""
    at_mm, alone, both = at_um // UM_PER_MM, config.spacing_mm, config.overlap_mm
    return 0 <= at_mm < alone + both, alone <= at_mm < 2 * alone + both


def _sample(config: AxleHeadConfig, at_um: int) -> dict[str, Cell]:
    a, b = _over(config, at_um)
    return {**ALIVE, "channel_a_damped": a, "channel_b_damped": b, "next_wheel_um": at_um}


def cut(steps: Steps, begin: int, lasts: int, channels: str = "ab", prefix: str = "") -> Steps:
    """Return the steps with channels whose cable is cut in some samples: not alive, and silent."""
    silent: dict[str, Cell] = {
        f"{prefix}channel_{channel}_{told}": False for channel in channels for told in ("alive", "damped")
    }
    return [{**step, **silent} if begin <= number < begin + lasts else step for number, step in enumerate(steps)]


def on_both(steps: Steps) -> list[int]:
    """Return the samples in which a wheel has come on both channels, wheel by wheel."""
    both = [step["channel_a_damped"] and step["channel_b_damped"] for step in steps]
    return [number for number, (was, now) in enumerate(pairwise([False, *both])) if now and not was]


def cut_somewhere(steps: Steps, *, seed: int, prefix: str = "") -> Steps:
    """Return the steps with one channel or both cut for up to 200 samples."""
    rng = Random(seed)
    return cut(steps, rng.randrange(len(steps)), rng.randint(1, 200), rng.choice(("a", "b", "ab")), prefix)


# ------------------------------------------------------------------ named runs


def _both_ways(config: AxleHeadConfig) -> Steps:
    up, down = through(config, (0, _BOGIE_MM), 20_000), through(config, (0, _BOGIE_MM), -36_000)
    return samples(config, [up, down])


def _turned_back(config: AxleHeadConfig) -> Steps:
    onto_both = (_CLEARANCE_MM + config.spacing_mm + config.overlap_mm // 2) * 1_000 // 2_000
    back = Roll((0,), ((2_000, onto_both), (-2_000, onto_both + 20)))
    return samples(config, [back, through(config, (0,), 5_000)])


def _metal_over_both(config: AxleHeadConfig) -> Steps:
    """Damp both channels in the same sample, as a magnetic rail brake does; then let a vehicle pass."""
    brake = {**ALIVE, "channel_a_damped": True, "channel_b_damped": True}
    free = {**ALIVE, "channel_a_damped": False, "channel_b_damped": False}
    after = samples(config, [through(config, (0, _BOGIE_MM), 25_000)])
    return without_truth([*[free] * 10, *[brake] * 30, *[free] * 10, *after])


def _sample_lost(config: AxleHeadConfig) -> Steps:
    """Let a wheel pass whose time on both channels was not sampled; then another one."""
    steps = samples(config, [through(config, (0, _BOGIE_MM), 20_000)])
    both = [number for number, step in enumerate(steps) if step["channel_a_damped"] and step["channel_b_damped"]]
    first = [number for number in both if number < both[0] + len(steps) // 4]
    return without_truth([step for number, step in enumerate(steps) if number not in first])


def _cable_cut(config: AxleHeadConfig) -> Steps:
    """Cut the cable of both channels while the second of three wheels is on both, and mend it when that one has gone."""
    steps = samples(config, [through(config, (0, _BOGIE_MM, 3 * _BOGIE_MM), 20_000)])
    return cut(steps, on_both(steps)[1], 100)


def without_truth(steps: Steps) -> Steps:
    """Return the steps without the ghost: no wheel makes these samples, so the recording claims no truth."""
    return [{name: value for name, value in step.items() if name != "next_wheel_um"} for step in steps]


RUNS: Mapping[str, WorkedRun[AxleHeadConfig]] = {
    "axle_head-both-ways": WorkedRun("Two axles upwards, two downwards; never disturbed.", _both_ways),
    "axle_head-turned-back": WorkedRun(
        "A wheel turns back on the head and counts nothing; the next one counts upwards.", _turned_back
    ),
    "axle_head-direction-unknown": WorkedRun(
        "Both channels are damped at once: disturbed, nothing is counted, until both are free; then two axles upwards.",
        _metal_over_both,
    ),
    "axle_head-no-overlap": WorkedRun(
        "A wheel that was never sampled on both channels disturbs and is not counted; the next one is.", _sample_lost
    ),
    "axle_head-cable-cut": WorkedRun(
        "The cable of both channels is cut under the second of three wheels: disturbed, this one is not counted; the third one is.",
        _cable_cut,
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, AxleHeadConfig())
