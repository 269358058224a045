"""Simulated samples of a counting head through cycles of the axle counter: the head's own runs, and channels that fail.

`python -m safeloc.models.counting_head.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.models.axle_head import simulate as head
from safeloc.models.counting_head import CountingHeadConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_BOGIE_MM = 2_500


def named(steps: Steps) -> Steps:
    """Return steps of the head as steps of the composition."""
    return [{f"axle_head.{name}": value for name, value in step.items()} for step in steps]


def _whole(config: CountingHeadConfig, steps: Steps) -> Steps:
    """Return the steps with as many more like the last one as end its cycle."""
    return [*steps, *[steps[-1]] * (-len(steps) % config.samples)]


def simulate(config: CountingHeadConfig, *, seed: int) -> Steps:
    """Return eight vehicles of two or four wheels, in either direction, each at its own speed."""
    return named(head.simulate(config.head, seed=seed))


def failing(steps: Steps, channel: str, *, damped: bool, begin: int) -> Steps:
    """Return the steps with a channel that is silent, or stays damped, from a sample on; without the truth, since no wheel makes them."""
    name = f"channel_{channel}_damped"

    def failed(number: int, step: Mapping[str, Cell]) -> dict[str, Cell]:
        kept = {key: value for key, value in step.items() if key != "next_wheel_um"}
        return {**kept, name: damped} if number >= begin else kept

    return [failed(number, step) for number, step in enumerate(steps)]


# ------------------------------------------------------------------ named runs


def _service(config: CountingHeadConfig) -> Steps:
    """Two bogies up, the third wheel of them on the head as a cycle ends; two axles down."""
    rolls = [
        head.through(config.head, (0, _BOGIE_MM, 8_800, 11_300), 30_000),
        head.through(config.head, (0, _BOGIE_MM), -36_000),
    ]
    return named(_whole(config, head.samples(config.head, rolls)))


def _both_ways(config: CountingHeadConfig) -> Steps:
    """One axle up and, within the same cycle of the counter, another one down."""
    rolls = [head.through(config.head, (0,), 36_000), head.through(config.head, (0,), -36_000)]
    return named(_whole(config, head.samples(config.head, rolls)))


def _silent(config: CountingHeadConfig) -> Steps:
    """Channel A is silent from the second of four wheels on."""
    steps = head.samples(config.head, [head.through(config.head, (0, _BOGIE_MM, 9_000, 11_500), 30_000)])
    return named(failing(_whole(config, steps), "a", damped=False, begin=len(steps) // 5))


def _stays_damped(config: CountingHeadConfig) -> Steps:
    """Channel B stays damped from the second of four wheels on."""
    steps = head.samples(config.head, [head.through(config.head, (0, _BOGIE_MM, 9_000, 11_500), 30_000)])
    return named(failing(_whole(config, steps), "b", damped=True, begin=len(steps) // 5))


RUNS: Mapping[str, WorkedRun[CountingHeadConfig]] = {
    "counting_head-service": WorkedRun("Four axles upwards, then two downwards: each cycle reports its own.", _service),
    "counting_head-both-ways": WorkedRun(
        "An axle upwards and one downwards in one cycle: at fault, since the counter hears one direction.", _both_ways
    ),
    "counting_head-silent-channel": WorkedRun(
        "A channel falls silent: each wheel after that leaves uncounted, and its cycle is at fault.", _silent
    ),
    "counting_head-damped-channel": WorkedRun(
        "A channel stays damped: each wheel after that goes back on the head, and its cycle is at fault.", _stays_damped
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, CountingHeadConfig())
