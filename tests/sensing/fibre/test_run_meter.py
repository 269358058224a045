"""The run of a train from block to block."""

from __future__ import annotations

from dataclasses import replace

from safeloc.sensing.fibre.features import Bounds, End, TrainSeen
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.sensing.fibre.run_meter import RunMeter

CONFIG = FibreConfig()
BLOCK_MS = 500


def seen(low_mm: int, speed_mm_s: int, track: int = 1) -> TrainSeen:
    """A train of 200 m."""
    ends = [End(Bounds(place, place), Bounds(place, place), Bounds(0, 0), ()) for place in (low_mm, low_mm + 200_000)]
    return TrainSeen(
        track, (), ends[0], ends[1], Bounds(speed_mm_s, speed_mm_s), Bounds(200_000, 200_000), None, ()
    )  # fmt: skip


def runs(trains: list[TrainSeen | None]) -> list[int | None]:
    """What the meter tells of each block."""
    meter = RunMeter(CONFIG)
    return [meter.follow(train, number * BLOCK_MS) for number, train in enumerate(trains)]


def test_a_steady_train_runs_at_its_speed() -> None:
    """Ten seconds of settling, then 20 m a block at 40 m/s."""
    made = runs([seen(20_000 * number, 40_000) for number in range(40)])
    assert [None] * 20 == made[:20]
    assert {20_000} == set(made[20:])


def test_a_jump_of_a_place_hardly_moves_the_run() -> None:
    """A middle seen 10 m ahead for one block adds 5 % of it, and is taken back slowly."""
    trains = [seen(20_000 * number + (10_000 if number == 30 else 0), 40_000) for number in range(40)]
    made = runs([*trains])
    assert 20_500 == made[30]
    assert 19_975 == made[31]


def test_a_wrong_speed_does_not_drift_away() -> None:
    """A speed that is 5 % too high adds 20 blocks' worth of its error in the end, not more."""
    made = [run for run in runs([seen(20_000 * number, 42_000) for number in range(300)]) if run is not None]
    assert abs(made[-1] - 20_000) <= 1
    assert sum(made) - 20_000 * len(made) < 20_000


def test_what_is_not_seen_has_no_run() -> None:
    """Nothing seen, an end beyond the fibre, another track: it settles anew."""
    steady: list[TrainSeen | None] = [seen(20_000 * number, 40_000) for number in range(60)]
    last = seen(20_000 * 30, 40_000)
    for broken in (None, replace(last, low=None), replace(last, track=2)):
        made = runs([*steady[:30], broken, *steady[31:]])
        assert made[29] == 20_000
        assert [None] * 20 == made[30:50]
        assert made[55] == 20_000
