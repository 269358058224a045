"""Records that the axle counter makes of a head whose channels fail: silent, damped for good, or damped until they come free by themselves (FVA-4)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.expr import FALSE
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.models import axle_counter
from safeloc.models.axle_head import AXLE, NO_AXLE
from safeloc.models.axle_head import simulate as head
from safeloc.models.counting_head import TOLD_TO_THE_COUNTER, CountingHeadConfig, compose_machines, cycle
from safeloc.models.counting_head.configuration import WheelTimes
from safeloc.models.counting_head.simulate import failing, named
from safeloc.proof.drawn_runs.worked import Steps
from safeloc.runtime.streams.steps import Cell
from tests.models.test_counting_head import CONFIG, WHEELS, Reported, passage, program, reported


def heard(steps: Steps, speed_mm_s: int) -> Iterator[dict[str, Cell]]:
    """What the counter hears of the samples, cycle by cycle, with bounds of the speed; then of a head that stays as it is."""
    one, cell = program(), dict[str, Cell]()
    state = one.first()
    still = [steps[-1]] * (CONFIG.samples - len(steps) % CONFIG.samples + CONFIG.samples)
    for step in [*steps, *still]:
        state, _ = one.step(state, one.read(step))
        told = one.named_outputs(state)
        if told["head_cycle.cycle_done"]:
            cell = _cycle(told, abs(speed_mm_s))
            yield cell
    yield from [cell] * 12


CLEAR: dict[str, Cell] = {
    "axle": "NONE", "axles_in_cycle": 1, "head_fault": False, "head_damped": False, "passage_over": True,
}  # fmt: skip


def _cycle(told: Mapping[str, Value], speed_mm_s: int) -> dict[str, Cell]:
    """What the counter is told, by the names of the hand-over, and the bounds of the speed."""
    names = {outer: f"head_cycle.{inner}" for inner, outer in TOLD_TO_THE_COUNTER.items()}
    way = AXLE[int(told[names["axle"]])]
    states: dict[str, Cell] = {name: bool(told[names[name]]) for name in ("head_fault", "head_damped")}
    axles: dict[str, Cell] = {
        "axle": way.label, "axles_in_cycle": int(told[names["axles_in_cycle"]]),
        "axle_speed_low_mm_s": speed_mm_s - 500, "axle_speed_high_mm_s": speed_mm_s + 500,
    }  # fmt: skip
    return CLEAR | {"passage_over": False} | states | ({} if way is NO_AXLE else axles)


def test_the_counter_is_told_by_name() -> None:
    """Each output of the hand-over is one of the head, and each input one of the counter: all but speeds and the end of a passage."""
    head_outputs, own = compose_machines(CONFIG).cycle.machine.outputs, axle_counter.machine(CONFIG.counter)
    assert TOLD_TO_THE_COUNTER.keys() == head_outputs.keys() - {"cycle_done"}
    inputs = {
        one.name
        for one in lower(own).inputs
        if not one.name.startswith(("axle_speed", "true_", "next_true", "axle_true"))
    }
    assert {*TOLD_TO_THE_COUNTER.values(), "passage_over"} == inputs - {one.name for one in lower(own).ghosts}


@cache
def counter() -> Compiled:
    """The axle counter on board, compiled."""
    return compile_system(without_ghosts(lower(axle_counter.machine(CONFIG.counter))))


def sound_records(cycles: Iterator[dict[str, Cell]], **otherwise: Cell) -> list[dict[str, Value]]:
    """Each sound record that the counter makes of these cycles, the first of which begins with a clear counter."""
    one, found = counter(), list[dict[str, Value]]()
    state = one.first()
    for told in [CLEAR, *cycles]:
        state, _ = one.step(state, one.read(told | otherwise))
        outputs = one.named_outputs(state)
        found += [outputs] if outputs["record_sound"] else []
    return found


def axles_of(steps: Steps, speed_mm_s: int, **otherwise: Cell) -> tuple[int, ...]:
    """The axles of each sound record of these samples."""
    return tuple(int(one["record_axles"]) for one in sound_records(heard(named(steps), speed_mm_s), **otherwise))


def records_of(channel: str, speed_mm_s: int, *, damped: bool, **otherwise: Cell) -> set[tuple[int, ...]]:
    """The records of runs in which a channel fails, from every fourth sample of a passage on, and of one in which it does not."""
    steps = passage(speed_mm_s)
    return {
        axles_of(failing(steps, channel, damped=damped, begin=begin), speed_mm_s, **otherwise)
        for begin in (*range(0, len(steps), 4), len(steps))
    }


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("speed_mm_s", [60_000, -60_000, 36_000])
@pytest.mark.parametrize("damped", [True, False])
@pytest.mark.parametrize("channel", ["b", "a"])
def test_a_channel_that_fails_leaves_no_wrong_record(channel: str, damped: bool, speed_mm_s: int) -> None:
    """Whenever it fails, also under the last wheel: the record has all axles, or there is none; sound channels give one."""
    assert {(), (len(WHEELS),)} == records_of(channel, speed_mm_s, damped=damped)


def of_a_cut(speed_mm_s: int, channels: str, lasts: int, *, alive: bool) -> set[tuple[int, ...]]:
    """The records of runs in which the cable of channels is cut, from every fifteenth sample of a passage on.

    alive  the current is not watched: each channel is told as alive
    """
    steps, longest = passage(speed_mm_s), 10_000
    told = head.ALIVE if alive else {}
    cuts = [head.cut(steps, begin, lasts or longest, channels) for begin in range(0, len(steps), 15)]
    return {axles_of(head.without_truth([{**step, **told} for step in one]), speed_mm_s) for one in cuts}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("lasts", [0, 150, 6])
@pytest.mark.parametrize(("channels", "speed_mm_s"), [("ab", 60_000), ("ab", -60_000), ("a", -60_000), ("b", 60_000)])
def test_a_cut_cable_leaves_no_wrong_record(channels: str, speed_mm_s: int, lasts: int) -> None:
    """One channel or both, for good or for a while, under a wheel or between two: all axles, or no record."""
    assert of_a_cut(speed_mm_s, channels, lasts, alive=False) <= {(), (len(WHEELS),)}


def test_a_head_that_did_not_watch_its_current_would_lack_axles() -> None:
    """The same runs, with both channels told as alive: a train of three axles has records of one and of two."""
    assert {(1,), (2,)} <= of_a_cut(60_000, "ab", 0, alive=True)


@pytest.mark.parametrize(("late", "short"), [(100, False), (1_000, True)])
def test_a_current_that_tells_too_late_would_lack_axles(late: int, short: bool) -> None:
    """Both channels fall silent, and tell so some samples later: within 50 ms no record lacks an axle; half a second later the record is out."""
    steps = passage(60_000)
    longer, found = [*steps, *[steps[-1]] * 1_200], set[tuple[int, ...]]()
    for begin in range(0, len(steps), 15):
        cut = head.cut(longer, begin, len(longer))
        told = [{**step, **head.ALIVE} if begin <= n < begin + late else step for n, step in enumerate(cut)]
        found.add(axles_of(head.without_truth(told), 60_000))
    assert short is bool(found - {(), (len(WHEELS),)})


def test_a_counter_that_did_not_hear_its_head_would_lack_an_axle() -> None:
    """The same runs, with the head told as free: where channel B stays damped under the last wheel, the record is one axle short."""
    assert (len(WHEELS) - 1,) in records_of("b", 60_000, damped=True, head_damped=False)


def comes_free(steps: Steps, channel: str, begin: int, late: int) -> Steps:
    """The steps in which a channel that is damped at a sample stays so, and comes free by itself so many samples later."""
    longer = [*steps, *[steps[-1]] * 1_200]
    damped, sound = (failing(longer, channel, damped=True, begin=one) for one in (begin, len(longer)))
    return [*damped[: begin + late], *sound[begin + late :]]


def last_damped(steps: Steps, channel: str) -> int:
    return max(n for n, step in enumerate(steps) if step[f"channel_{channel}_damped"])


@pytest.mark.parametrize(("channel", "speed_mm_s"), [("b", 60_000), ("a", -60_000), ("b", 20_000)])
def test_a_channel_that_comes_free_by_itself_leaves_no_wrong_length(channel: str, speed_mm_s: int) -> None:
    """It stays damped under the last wheel, and is free before the train has certainly passed. The wheel is counted late, and the length is
    true, or there is no record.
    """
    steps, sound = passage(speed_mm_s), 0
    begin = last_damped(steps, channel)
    for late in range(0, 600, 25):
        records = sound_records(heard(named(comes_free(steps, channel, begin, late)), abs(speed_mm_s)))
        for record in records:
            assert record["record_axles"] == len(WHEELS)
            low, high = (int(record[f"record_length_{end}_um"]) for end in ("low", "high"))
            assert low <= WHEELS[-1] * 1_000 <= high, late
        sound += len(records)
    assert sound


def test_a_head_that_took_no_times_would_leave_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same run through a head whose times are not compared: the length of nine metres lies below its bounds."""
    monkeypatch.setattr(cycle, "counted_late", lambda own: FALSE)
    program.cache_clear()
    steps = passage(60_000)
    (record,) = sound_records(heard(named(comes_free(steps, "b", last_damped(steps, "b"), 400)), 60_000))
    program.cache_clear()
    assert record["record_axles"] == len(WHEELS)
    assert int(record["record_length_low_um"]) > WHEELS[-1] * 1_000


@pytest.mark.parametrize("speed_mm_s", [1_700, -1_700, 1_300])
def test_a_wheel_that_is_fast_enough_is_reported(speed_mm_s: int) -> None:
    """At the sure speed; a slower one is a fault."""
    found = reported(named(head.samples(CONFIG.head, [head.through(CONFIG.head, (0,), speed_mm_s)])))
    assert (
        Reported(0, fault=True, damped=False) == found
        if abs(speed_mm_s) < 1_500
        else Reported(1, fault=False, damped=False) == found
    )


@pytest.mark.parametrize(
    ("figures", "message"),
    [
        ({"times_as_long": 2}, "may brake, and be refused"),
        ({"sure_speed_mm_s": 1_500}, "may damp the first channel alone for wheel.slow_samples"),
    ],
)
def test_times_that_would_refuse_a_sound_wheel_are_refused(figures: dict[str, int], message: str) -> None:
    """Where a wheel of a braking train may be a fault."""
    with pytest.raises((ValidationError, ValueError), match=message):
        CountingHeadConfig(wheel=WheelTimes(**figures))
