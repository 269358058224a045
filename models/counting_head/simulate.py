"""Simulated samples of a counting head through cycles of the axle counter: the head's own runs, and channels that fail.

`python -m safeloc.models.counting_head.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.language.units import UM_PER_MM
from safeloc.models.axle_head import simulate as head
from safeloc.models.counting_head import CountingHeadConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_BOGIE_MM = 2_500


def named(steps: Steps) -> Steps:
    """Return steps of the head as steps of the composition."""
    return [{f"axle_head.{name}": value for name, value in step.items()} for step in steps]


def rolled(config: CountingHeadConfig, rolls: Sequence[head.Roll]) -> Steps:
    """Return rolls at one speed each as steps of the composition, with the wheels' speed."""

    def steps(roll: head.Roll) -> Steps:
        [(speed_mm_s, _)] = roll.speeds
        speed: dict[str, Cell] = {"head_cycle.next_speed_um_s": speed_mm_s * UM_PER_MM}
        return [step | speed for step in named(head.samples(config.head, [roll]))]

    return [step for roll in rolls for step in steps(roll)]


def _whole(config: CountingHeadConfig, steps: Steps) -> Steps:
    """Return the steps with as many more like the last one as end its cycle."""
    return [*steps, *[steps[-1]] * (-len(steps) % config.samples)]


def simulate(config: CountingHeadConfig, *, seed: int) -> Steps:
    """Return eight vehicles of two or four wheels, in either direction, each at its own speed; for a while a channel is not alive."""
    return head.cut_somewhere(rolled(config, head.drawn(config.head, seed=seed)), seed=seed, prefix="axle_head.")


def failing(steps: Steps, channel: str, *, damped: bool, begin: int) -> Steps:
    """Return the steps with a channel that is silent, or stays damped, from a sample on; without the truth, since no wheel makes them."""
    name = f"channel_{channel}_damped"
    return [
        {**step, name: damped} if number >= begin else step for number, step in enumerate(head.without_truth(steps))
    ]


# ------------------------------------------------------------------ named runs


def _service(config: CountingHeadConfig) -> Steps:
    """Two bogies up, the third wheel of them on the head as a cycle ends; two axles down."""
    rolls = [
        head.through(config.head, (0, _BOGIE_MM, 8_800, 11_300), 30_000),
        head.through(config.head, (0, _BOGIE_MM), -36_000),
    ]
    return _whole(config, rolled(config, rolls))


def _both_ways(config: CountingHeadConfig) -> Steps:
    """One axle up and, within the same cycle of the counter, another one down."""
    rolls = [head.through(config.head, (0,), 36_000), head.through(config.head, (0,), -36_000)]
    return _whole(config, rolled(config, rolls))


def _silent(config: CountingHeadConfig) -> Steps:
    """Channel A is silent from the second of four wheels on."""
    steps = head.samples(config.head, [head.through(config.head, (0, _BOGIE_MM, 9_000, 11_500), 30_000)])
    return named(failing(_whole(config, steps), "a", damped=False, begin=len(steps) // 5))


def _stays_damped(config: CountingHeadConfig) -> Steps:
    """Channel B stays damped from the second of four wheels on."""
    steps = head.samples(config.head, [head.through(config.head, (0, _BOGIE_MM, 9_000, 11_500), 30_000)])
    return named(failing(_whole(config, steps), "b", damped=True, begin=len(steps) // 5))


def _cable_cut(config: CountingHeadConfig) -> Steps:
    """Cut the cable of both channels from under the second of four wheels on."""
    roll = head.through(config.head, (0, _BOGIE_MM, 9_000, 11_500), 30_000)
    _, second, *_ = head.on_both(head.samples(config.head, [roll]))
    steps = _whole(config, rolled(config, [roll]))
    return head.cut(steps, second, len(steps), prefix="axle_head.")


def _comes_free_late(config: CountingHeadConfig) -> Steps:
    """Channel B stays damped under the last of two wheels for another 200 ms."""
    steps = head.samples(config.head, [head.through(config.head, (0, _BOGIE_MM), 30_000)])
    longer = [*steps, *[steps[-1]] * 450]
    begin = max(number for number, step in enumerate(steps) if step["channel_b_damped"])
    damped, sound = (failing(longer, "b", damped=True, begin=one) for one in (begin, len(longer)))
    return named(_whole(config, [*damped[: begin + 400], *sound[begin + 400 :]]))


def _slow(config: CountingHeadConfig) -> Steps:
    """A wheel that is so slow that it could stop on the head."""
    return _whole(config, rolled(config, [head.through(config.head, (0,), 1_000)]))


RUNS: Mapping[str, WorkedRun[CountingHeadConfig]] = {
    "counting_head-service": WorkedRun("Four axles upwards, then two downwards: each cycle reports its own.", _service),
    "counting_head-both-ways": WorkedRun(
        "An axle upwards and one downwards in one cycle: at fault, since the counter hears one direction.", _both_ways
    ),
    "counting_head-silent-channel": WorkedRun(
        "A channel falls silent: each wheel after that leaves uncounted, and its cycle is at fault.", _silent
    ),
    "counting_head-cable-cut": WorkedRun(
        "The cable of both channels is cut: neither is alive, and each cycle after that is at fault, whether a wheel passes or not.",
        _cable_cut,
    ),
    "counting_head-damped-channel": WorkedRun(
        "A channel stays damped: each wheel after that goes back on the head, and its cycle is at fault.", _stays_damped
    ),
    "counting_head-late-channel": WorkedRun(
        "A channel stays damped under the last wheel, and comes free by itself after 200 ms: the wheel is counted late, and its cycle is at fault.",
        _comes_free_late,
    ),
    "counting_head-slow": WorkedRun(
        "A wheel at walking pace: its cycle is at fault, since it could have stopped on the head.", _slow
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, CountingHeadConfig())
