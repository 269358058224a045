"""Lanes of modes: one for each machine that changes mode, on the scale of the charts below, with the violating step marked."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from safeloc.report.lanes import MOST_LANES, mode_lanes
from safeloc.report.plot import LEFT, WIDTH, line_chart

SIGNALS = {"mode": {"unit": "", "members": ["DOWN", "A <b>&"]}, "height_mm": {"unit": "mm", "members": []}}


def run_of(modes: Mapping[str, Sequence[int]]) -> dict[str, Any]:
    """A run in which the variables have these values, the first before the first step."""
    states = [dict(zip(modes, values, strict=True)) for values in zip(*modes.values(), strict=True)]
    return {"first": states[0], "steps": [{"state": state} for state in states[1:]]}


def bars(svg: str) -> list[tuple[float, float, str]]:
    """Begin, end and tip of each bar."""
    found = re.findall(r'<rect x="([\d.]+)" .*?width="([\d.]+)".*?<title>(.*?)</title>', svg)
    return [(float(left), float(left) + float(width), tip) for left, width, tip in found]


def test_each_stretch_is_a_bar() -> None:
    """From its first step to the first of the next; letters of a mode are text."""
    svg = mode_lanes(run_of({"mode": [0, 0, 1, 1, 1, 0, 0, 0, 0]}), SIGNALS)
    room = (WIDTH - LEFT - 10) / 8
    ends = [0, 2, 5, 8]
    assert [(left, right) for left, right, _ in bars(svg)] == [
        (round(LEFT + room * first, 1), round(round(LEFT + room * first, 1) + round(room * (last - first), 1), 1))
        for first, last in pairwise(ends)
    ]
    assert [tip for *_, tip in bars(svg)] == [
        "mode = DOWN, steps 0 to 1",
        "mode = A &lt;b&gt;&amp;, steps 2 to 4",
        "mode = DOWN, steps 5 to 8",
    ]
    assert "<b>" not in svg


def test_the_mark_stands_where_it_does_in_the_chart() -> None:
    """Both have the same scale, and the last step is the one that violates."""
    modes = [0, 0, 1]
    lanes = mode_lanes(run_of({"mode": modes}), SIGNALS)
    chart = line_chart("height_mm", "mm", {"height_mm": [0.0, 1.0, 2.0]}, broken=2)
    mark = re.compile(r'<line x1="([\d.]+)" x2="\1" .*?class="broken"><title>violated at step 2</title>')
    (in_lanes,), (in_chart,) = mark.findall(lanes), mark.findall(chart)
    assert in_lanes == in_chart == f"{WIDTH - 10:.1f}"
    assert "violated at step 2</text>" in chart
    assert "violated" not in line_chart("height_mm", "mm", {"height_mm": [0.0, 1.0, 2.0]})


def test_a_short_stretch_has_no_letters() -> None:
    """They would run over the next one; the tip says it."""
    modes = [0] * 200 + [1] + [0] * 200
    svg = mode_lanes(run_of({"mode": modes}), SIGNALS)
    assert len(bars(svg)) == 3
    assert svg.count("DOWN</text>") == 2
    assert "&amp;</text>" not in svg


def test_only_machines_that_change_mode_have_a_lane() -> None:
    """Of a composition; a machine by itself always has one."""
    names = [f"m{number}.mode" for number in range(9)]
    signals = dict.fromkeys(names, SIGNALS["mode"])
    still = run_of({name: [0, 0] for name in names})
    assert mode_lanes(still, signals) == ""
    assert mode_lanes(run_of({"mode": [0, 0]}), SIGNALS).count("<rect") == 1
    svg = mode_lanes(run_of({name: [0, number % 2] for number, name in enumerate(names)}), signals)
    assert [name for name in names if f">{name}<" in svg] == ["m1.mode", "m3.mode", "m5.mode", "m7.mode"]
    every = mode_lanes(run_of({name: [0, 1] for name in names}), signals)
    assert sum(f">{name}<" in every for name in names) == MOST_LANES
    assert every.endswith(f"<p>{len(names) - MOST_LANES} more machines change mode.</p>")
    assert "more machines" not in svg


def test_a_long_name_is_shortened() -> None:
    """It does not run into the first bar; the tip has it in full."""
    name = "a machine with a very long name.mode"
    svg = mode_lanes(run_of({name: [0, 1]}), {name: SIGNALS["mode"]})
    assert "\N{HORIZONTAL ELLIPSIS}</text>" in svg
    assert f"<title>{name} = DOWN, steps 0 to 0</title>" in svg


def test_no_steps_no_lanes() -> None:
    """A first state that violates has no run to show."""
    assert mode_lanes(run_of({"mode": [0]}), SIGNALS) == ""
