"""What a radar that is wrong makes of the precise interval: the table of docs/decisions/reflectors.md.

python -m benchmarks.radar_self_test

Source fig. 1 at 20 m/s, 400 cycles: a balise known to 1 m, its reflector 80 m behind it, another one 420 m farther. The
radar is right, or has a constant systematic error, one that drifts from the middle of the odometry zone on, or a wrong
scale. A cycle is wrong where the position is called precise and its interval does not hold the truth.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.language.nodes import Value
from safeloc.models.reflector.simulate import Scene, outputs_along, simulate
from safeloc.models.reflector.variables import ERROR, ReflectorConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg

CYCLES, SPEED_MM_S, DRIFTS_FROM = 400, 20_000, 160
MM_PER_M = 1_000


@dataclass(frozen=True)
class Radar:
    """What is wrong with a radar, and what the supplier says of it at most.

    lawful  the supplier's figures cover it
    """

    name: str
    wrong: tuple[Fault, ...] = ()
    config: ReflectorConfig = ReflectorConfig()
    lawful: bool = True


def biased(by_mm: int) -> Radar:
    """Every range is so much too long."""
    return Radar(f"constant, {by_mm / MM_PER_M:+.1f} m", (Fault("shift", figures={"by_mm": by_mm}),))


def drifting(by_mm: int, *, said_mm_s: int | None = None) -> Radar:
    """So much more in every cycle, from the odometry zone on; as fast as the supplier says, or faster."""
    config = ReflectorConfig() if said_mm_s is None else ReflectorConfig(radar_drift_mm_s=said_mm_s)
    lawful = by_mm * MM_PER_M <= config.radar_drift_mm_s * config.period_ms
    name = f"drift, {by_mm / MM_PER_M:.2f} m a cycle; at most {config.radar_drift_mm_s / MM_PER_M:g} m/s said"
    return Radar(name, (Fault("drift", begin=DRIFTS_FROM, figures={"by_mm": by_mm}),), config, lawful)


def scaled(by_ppm: int, *, said_ppm: int | None = None) -> Radar:
    """So much of every range too long; within what the supplier says, or more."""
    config = ReflectorConfig() if said_ppm is None else ReflectorConfig(radar_scale_ppm=said_ppm)
    name = f"scale, {by_ppm / 10_000:g} %; at most {config.radar_scale_ppm / 10_000:g} % said"
    return Radar(name, (Fault("scale", figures={"by_ppm": by_ppm}),), config, by_ppm <= config.radar_scale_ppm)


RADARS = (
    Radar("right"),
    *(biased(by_mm) for by_mm in (500, 1_000, 1_400, 2_000, -500, -1_000, -1_400, -2_000)),
    drifting(50, said_mm_s=500),
    drifting(400, said_mm_s=4_000),
    scaled(100),
    scaled(10_000, said_ppm=11_000),
    scaled(20_000, said_ppm=22_000),
    drifting(50),
    drifting(400),
    scaled(10_000),
    scaled(20_000),
)


@dataclass(frozen=True)
class Outcome:
    """Cycles with a precise position, those of them whose interval misses the truth, by how much, and how wide it is; mm."""

    precise: int
    wrong: int
    worst_mm: int
    margin_mm: int
    errors: frozenset[str]


def driven(radar: Radar, *, seed: int = 1) -> Outcome:
    """One run."""
    scene = Scene(clutter=0.0, pauses=0.0, dropout=0.0, disturbances=radar.wrong)
    stream = simulate(radar.config, seed=seed, scene=scene, legs=[Leg(SPEED_MM_S, CYCLES // 10)])
    reports = outputs_along(radar.config, stream)
    missed = [_missed_mm(one, step) for one, step in zip(reports, stream, strict=True) if one["precise"]]
    margins = [max(one["margin_above_mm"], one["margin_below_mm"]) for one in reports if one["precise"]]
    errors = frozenset(str(ERROR[int(one["error"])].label) for one in reports)
    return Outcome(len(missed), sum(by > 0 for by in missed), max(missed, default=0), max(margins, default=0), errors)


def _missed_mm(report: Mapping[str, Value], step: Mapping[str, Cell]) -> int:
    """By how much the interval misses the truth, which is rounded down."""
    low = report["position_mm"] - report["margin_below_mm"]
    high, truth = report["position_mm"] + report["margin_above_mm"], int(step["truth_mm"])
    return max(low - 1 - truth, truth - high, 0)


def table(radars: Sequence[Radar] = RADARS) -> Iterator[str]:
    """The table as text."""
    yield "| radar | within the law | precise cycles | wrong | worst | widest side | a mismatch |"
    yield "|---|---|---|---|---|---|---|"
    for radar in radars:
        one = driven(radar)
        found = "said" if "MISMATCH" in one.errors else ""
        yield (
            f"| {radar.name} | {'yes' if radar.lawful else 'no'} | {one.precise} | {one.wrong} | "
            f"{one.worst_mm / MM_PER_M:.2f} m | {one.margin_mm / MM_PER_M:.1f} m | {found} |"
        )


if __name__ == "__main__":
    for line in table():
        print(line)
