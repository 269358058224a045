"""Axle counters: heads, entry records, and sections with their reset."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.language.expr import FALSE, TRUE
from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.models import axle_counter, axle_head, axle_section
from safeloc.models.axle_counter import AxleCounter, AxleCounterConfig
from safeloc.models.axle_head import AxleHead, AxleHeadConfig, axle_speed_mm_s
from safeloc.models.axle_section import AxleSection, AxleSectionConfig
from safeloc.properties import axle_counter as counter_properties
from safeloc.properties import axle_head as head_properties
from safeloc.properties import axle_section as section_properties
from safeloc.runtime.streams.steps import Cell
from tests.models.everything_proved import unproved_of
from tests.models.fibre_family import labels, mode_labels
from tests.models.inductive import changed, inductive


@cache
def head() -> AxleHead:
    """A counting head."""
    return axle_head.build(axle_head.parts(AxleHeadConfig()))


@cache
def counter() -> AxleCounter:
    """What makes entry records."""
    return axle_counter.build(axle_counter.parts(AxleCounterConfig()))


@cache
def section() -> AxleSection:
    """A section between two counters."""
    return axle_section.build(axle_section.parts(AxleSectionConfig()))


# ------------------------------------------------------------------ heads

ALIVE: dict[str, Cell] = {"channel_a_alive": True, "channel_b_alive": True}


def sampled(samples: str) -> Trace:
    """A head on samples written as -, A, B and X (both damped); in small letters, and o for -, channel A is not alive."""
    steps = [
        ALIVE | {"channel_a_damped": one in "AXax", "channel_b_damped": one in "BXbx", "channel_a_alive": one in "-ABX"}
        for one in samples
    ]
    return run(without_ghosts(lower(head().machine)), steps)


@pytest.mark.parametrize(
    ("samples", "axles"),
    [
        ("-AXB-", ["UP"]),
        ("-BXA-", ["DOWN"]),
        ("-AXB-AXB-BXA-", ["UP", "UP", "DOWN"]),
        ("-AXXAA-", []),
        ("-AXBXBXB-", ["UP"]),
        ("-AXBXA-", []),
        ("-A-A-", []),
    ],
)
def test_axles(samples: str, axles: list[str]) -> None:
    """Whole sequences count, in their direction; a wheel that turns back on the head does not."""
    trace = sampled(samples)
    assert [one for one in labels(trace, "counted") if one != "NONE"] == axles
    assert not any(one.outputs["disturbed"] for one in trace.steps)


@pytest.mark.parametrize("samples", ["-X", "-AB", "-BA", "-AX-", "-BX-"])
def test_no_overlap_or_no_order_disturbs(samples: str) -> None:
    """Direction unknown: disturbed, and nothing is counted until both channels are free."""
    trace = sampled(samples + "B-AXB-")
    assert trace.steps[len(samples) - 1].outputs["disturbed"]
    assert [one for one in labels(trace, "counted") if one != "NONE"] == ["UP"]


@pytest.mark.parametrize("samples", ["-o", "-a", "-b", "-x", "-Ax", "-AXb", "-AXBo"])
def test_a_channel_that_is_not_alive_disturbs(samples: str) -> None:
    """Whatever it tells: disturbed, and nothing is counted until both channels are alive and free."""
    trace = sampled(samples + "oB-AXB-")
    assert trace.steps[len(samples) - 1].outputs["disturbed"]
    ended = len(samples) + 2
    assert [one.outputs["may_miss"] for one in trace.steps[len(samples) - 1 :]] == [True] * 4 + [False] * 4
    assert not trace.steps[ended].outputs["disturbed"]
    assert [one for one in labels(trace, "counted") if one != "NONE"] == ["UP"]


def test_speed_of_an_axle() -> None:
    """Bounds from the time between the channels hold the speed, rounded outward; no wheel is faster than light rail."""
    low, high = axle_speed_mm_s(10_000)
    assert low < 15_000 < high
    assert (low, high) == (148 * 1_000_000 // 10_500, -(-152 * 1_000_000 // 9_500))
    with pytest.raises(InputError, match="no wheel"):
        axle_speed_mm_s(900)


def test_sampling_too_seldom_is_refused() -> None:
    """A wheel must not pass the overlap between two samples."""
    with pytest.raises(ValidationError, match="sample more often"):
        AxleHeadConfig(sample_us=700)


def test_a_channel_alone_is_sampled() -> None:
    """Nor the stretch on which it damps one channel alone: it would look as if both were damped at once."""
    with pytest.raises(ValidationError, match="damps one channel alone for only 40 mm"):
        AxleHeadConfig(spacing_mm=42)


# ------------------------------------------------------------------ entry records


QUIET: dict[str, Cell] = {
    "axle": "NONE", "axles_in_cycle": 1, "head_fault": False, "head_damped": False, "passage_over": False,
}  # fmt: skip


def passage(speeds: list[int], axles: dict[int, int], **at: dict[str, Cell]) -> Trace:
    """A train: its speed in every cycle, axles told in some of them; `c3={...}` changes cells of cycle 3."""
    steps: list[dict[str, Cell]] = [QUIET | {"passage_over": True}]
    for cycle, speed in enumerate(speeds):
        step = dict(QUIET)
        if cycle in axles:
            step |= {"axle": "UP", "axles_in_cycle": axles[cycle]}
            step |= {"axle_speed_low_mm_s": speed - 200, "axle_speed_high_mm_s": speed + 200}
        steps.append(step | at.get(f"c{cycle}", {}))
    return run(without_ghosts(lower(counter().machine)), steps)


def record(trace: Trace) -> dict[str, int]:
    """The one record of a passage."""
    made = [one.outputs for one in trace.steps if one.outputs["record_sound"]]
    assert len(made) == 1
    return dict(made[0])


def test_a_record() -> None:
    """Ten axles in twenty metres a second: count, length and speed."""
    trace = passage([20_000] * 40, {0: 2, 5: 2, 10: 2, 15: 2, 20: 2})
    found = record(trace)
    assert found["record_axles"] == 10
    assert found["record_length_low_um"] <= 40_000_000 <= found["record_length_high_um"]
    assert found["record_speed_low_mm_s"] <= 20_000 <= found["record_speed_high_mm_s"]


def test_length_of_a_braking_train() -> None:
    """The integral of the speed, not the first speed times the time: the bounds hold the true run."""
    speeds = [20_000 - 140 * cycle for cycle in range(70)]
    found = record(passage(speeds, dict.fromkeys(range(0, 41, 5), 2)))
    true = sum(speeds[:40]) * 100
    assert found["record_length_low_um"] <= true <= found["record_length_high_um"]
    assert 20_000 * 40 * 100 > found["record_length_high_um"]


@pytest.mark.parametrize(
    ("cells", "flaw"),
    [
        ({"head_fault": True}, "HEAD_FAULT"),
        ({"axle": "DOWN"}, "TURNED"),
        ({"axle_speed_low_mm_s": 30_000, "axle_speed_high_mm_s": 31_000}, "SPEED_CONTRADICTED"),
        ({"axles_in_cycle": 10, "axle_speed_low_mm_s": 21_000, "axle_speed_high_mm_s": 20_000}, "NO_SPEED"),
    ],
)
def test_a_flaw_gives_no_record(cells: dict[str, Cell], flaw: str) -> None:
    """The rest of the train is not taken for another one; there is no record until the passage is over."""
    trace = passage([20_000] * 40, {0: 2, 5: 2, 10: 2, 15: 2, 20: 2}, c10=cells)
    assert not any(one.outputs["record_sound"] for one in trace.steps)
    assert labels(trace, "record_flaw")[-1] == flaw


def test_a_head_that_is_damped_when_the_train_has_passed_gives_no_record() -> None:
    """A wheel may be on it that is not counted; while the train passes a wheel on the head is nothing."""
    damped: dict[str, Cell] = {"head_damped": True}
    axles = {0: 2, 5: 2, 10: 2, 15: 2, 20: 2}
    stays = passage([20_000] * 40, axles, **{f"c{cycle}": damped for cycle in range(20, 40)})
    assert not any(one.outputs["record_sound"] for one in stays.steps)
    assert labels(stays, "record_flaw")[-1] == "HEAD_DAMPED"
    assert record(passage([20_000] * 40, axles, c9=damped, c10=damped, c22=damped))["record_axles"] == 10


def test_power_up_gives_no_record() -> None:
    """A train that is on the counter at power-up is not counted from its middle."""
    step: dict[str, Cell] = {
        "axle": "UP", "axles_in_cycle": 2, "axle_speed_low_mm_s": 9_000, "axle_speed_high_mm_s": 9_100,
        "head_fault": False, "head_damped": False, "passage_over": False,
    }  # fmt: skip
    trace = run(without_ghosts(lower(counter().machine)), [step] * 3)
    assert mode_labels(counter().machine, trace) == ["SPOILT"] * 3


# ------------------------------------------------------------------ sections


def cycles(*cells: dict[str, Cell]) -> Trace:
    """A section, quiet but for what is given; an int stands for so many quiet cycles."""
    quiet: dict[str, Cell] = {
        "axles_in_low": 0, "axles_in_high": 0, "axles_out_low": 0, "axles_out_high": 0, "head_fault": False,
        "head_damped": False, "reset_requested": False, "sweep_reported_clear": False,
    }  # fmt: skip
    steps = []
    for one in cells:
        steps += [quiet] * int(one["quiet"]) if "quiet" in one else [quiet | one]
    return run(without_ghosts(lower(section().machine)), steps)


READY: tuple[dict[str, Cell], ...] = (
    {"quiet": 10}, {"reset_requested": True}, {"axles_in_low": 8}, {"quiet": 3}, {"axles_out_high": 8},
    {"sweep_reported_clear": True},
)  # fmt: skip


def test_reset_and_sweep() -> None:
    """Unknown, reset, swept, clear, occupied, clear."""
    found = mode_labels(section().machine, cycles(*READY, {"axles_in_low": 4}, {"axles_out_low": 4}))
    assert list(dict.fromkeys(found)) == ["UNKNOWN", "SWEEPING", "CLEAR", "OCCUPIED"]
    assert found[-1] == "CLEAR"


@pytest.mark.parametrize(
    ("before", "cells", "answer"),
    [
        ((), {}, "AXLE_PASSED"),
        ((*READY, {"axles_in_low": 4}, {"quiet": 10}), {}, "AXLES_COUNTED"),
        (({"quiet": 10},), {"head_damped": True}, "HEAD_DAMPED"),
        (({"quiet": 10},), {"head_fault": True}, "HEAD_FAULT"),
        (({"quiet": 10}, {"axles_in_low": 1}), {}, "AXLE_PASSED"),
    ],
    ids=["power-up", "occupied", "damped", "fault", "just passed"],
)
def test_a_reset_is_refused(before: tuple[dict[str, Cell], ...], cells: dict[str, Cell], answer: str) -> None:
    """While occupied, damped, at fault, or just after an axle."""
    trace = cycles(*before, {"reset_requested": True} | cells)
    assert labels(trace, "reset_answer")[-1] == answer
    assert mode_labels(section().machine, trace)[-1] != "SWEEPING"


@pytest.mark.parametrize(
    "cells",
    [(*READY, {"head_damped": True}), (*READY[:5], {"sweep_reported_clear": True, "head_damped": True}),
     (*READY, {"axles_in_low": 4}, {"axles_out_low": 4, "head_damped": True})],
    ids=["clear", "swept", "counted out"],
)  # fmt: skip
def test_a_damped_head_is_occupied(cells: tuple[dict[str, Cell], ...]) -> None:
    """A wheel on a head occupies, whatever is counted; the section is clear again when it is gone."""
    assert mode_labels(section().machine, cycles(*cells))[-1] != "CLEAR"
    assert mode_labels(section().machine, cycles(*cells, {"sweep_reported_clear": True}))[-1] == "CLEAR"


def test_a_sweep_that_backs_out_does_not_clear() -> None:
    """A sweep has to run through: what stands beyond where it turned was not seen."""
    trace = cycles(*READY[:4], {"axles_out_low": 8}, {"sweep_reported_clear": True})
    assert mode_labels(section().machine, trace)[-1] == "SWEEPING"


@pytest.mark.parametrize("cells", [{"axles_out_high": 1}, {"head_fault": True}], ids=["more out than in", "head fault"])
def test_a_disturbed_section_stays_occupied(cells: dict[str, Cell]) -> None:
    """Disturbed, also when the fault is gone."""
    assert mode_labels(section().machine, cycles(*READY, cells, {"quiet": 30}))[-1] == "DISTURBED"


# ------------------------------------------------------------------ proofs


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties and lemmas of the three machines, without bound."""
    for model, found in (
        (head().machine, head_properties.properties(head())),
        (counter().machine, counter_properties.properties(counter())),
        (section().machine, section_properties.properties(section())),
    ):
        assert unproved_of(model, found) == {}


@pytest.mark.parametrize(
    ("row", "fields", "broken"),
    [
        ("reset accepted", {"target": "CLEAR"}, "a reset leads to a sweep"),
        ("swept", {"when": TRUE}, "clear after a reset needs a sweep"),
        ("count cannot be believed", {"when": FALSE}, "a fault is occupied"),
        ("stay disturbed", {"target": "CLEAR"}, "a fault is not forgotten"),
        ("axles counted in", {"when": FALSE}, "clear is clear"),
        ("axles counted in", {"when": FALSE}, "a damped head is occupied"),
        ("all axles counted out", {"when": TRUE}, "a damped head is occupied"),
        ("swept", {"when": TRUE}, "a damped head is occupied"),
    ],
)
def test_a_broken_section_is_noticed(row: str, fields: dict[str, object], broken: str) -> None:
    """A reset that frees, a sweep that is not needed, a fault that is forgotten: each loses a proof."""
    table = {mode.label: mode for mode in section().machine.modes}
    given = {name: table.get(value, value) if isinstance(value, str) else value for name, value in fields.items()}
    wrong = replace(section(), machine=changed(section().machine, row, **given))
    prop = next(one for one in section_properties.properties(wrong) if one.name == broken)
    assert not inductive(wrong.machine, prop)


@pytest.mark.parametrize(
    ("row", "target", "broken"),
    [
        ("turned back off A", "DISTURBED", "no disturbance by wheels"),
        ("then on both, upwards", "BOTH_DOWN", "every axle is counted"),
        ("both at once", "FREE", "unknown direction disturbs"),
    ],
)
def test_a_broken_head_is_noticed(row: str, target: str, broken: str) -> None:
    """A wheel that disturbs, an axle in the wrong direction, a direction that is guessed: each loses a proof."""
    table = {mode.label: mode for mode in head().machine.modes}
    wrong = replace(head(), machine=changed(head().machine, row, target=table[target]))
    assert not inductive(wrong.machine, next(p for p in head_properties.properties(wrong) if p.name == broken))


def test_a_broken_record_is_noticed() -> None:
    """A record of a passage whose faults are not looked at, or whose run is not summed, is found."""
    own = counter()
    for row, fields, broken in (
        ("head at fault", {"when": FALSE}, "a fault spoils"),
        ("between axles", {"set": {}}, "length is true"),
        ("train has passed", {"when": TRUE}, "the whole train has passed"),
    ):
        wrong = replace(own, machine=changed(own.machine, row, **fields))
        assert not inductive(wrong.machine, next(p for p in counter_properties.properties(wrong) if p.name == broken))


def test_a_train_that_never_surely_passes_is_refused() -> None:
    """At 8 m/s it may stop after 20.15 m, farther than two axles are apart; at 7.9 m/s before that: no record could come."""
    assert 20_150_000 == AxleCounterConfig(max_speed_mm_s=8_000).surest_run_um
    assert 0 == AxleCounterConfig.model_construct(period_ms=100, max_speed_mm_s=400, change_mm_s2=5_000).surest_run_um
    with pytest.raises(ValueError, match=r"change_mm_s2 1500 may have stopped\. .* and no record can come"):
        AxleCounterConfig(max_speed_mm_s=7_900)


def test_room_for_late_axles_that_leaves_no_length_is_refused() -> None:
    """At both ends it takes the whole spread that a length may have: no record could come."""
    assert AxleCounterConfig(late_mm=9_999, length_spread_mm=19_999).late_mm == 9_999
    with pytest.raises(
        ValueError, match=r"late_mm \(10000\) .* all of length_spread_mm \(20000\), .* no record can come"
    ):
        AxleCounterConfig(late_mm=10_000)
    with pytest.raises(ValueError, match=r"raise length_spread_mm above twice late_mm"):
        AxleCounterConfig(length_spread_mm=1_300)
