"""A trace of the report as rows and as charts, from the report's data alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safeloc.language.units import NM_PER_MM
from safeloc.report.lanes import mode_lanes
from safeloc.report.plot import line_chart
from safeloc.reported import Reported

_Data = Mapping[str, Any]
Series = list[float | None]
_MOST_CHARTS = 3


def trace_rows(trace: _Data, signals: _Data) -> list[dict[str, Any]]:
    """Return one row a step: number, what fired, the inputs that were present and those just gone, the state that changed."""
    before, came = trace["first"], dict[str, Any]()
    rows = [{"number": 0, "fired": "start", "inputs": "", "changed": _values(signals, before)}]
    for number, step in enumerate(trace["steps"], 1):
        changed = {name: value for name, value in step["state"].items() if before[name] != value}
        rows.append(
            {
                "number": number,
                "fired": ", ".join(step["fired"].values()),
                "inputs": "  ".join(filter(None, (_values(signals, step["inputs"]), *_gone(came, step["inputs"])))),
                "changed": _values(signals, changed),
            }
        )
        before, came = step["state"], step["inputs"]
    return rows


def _gone(before: _Data, now: _Data) -> list[str]:
    """Return what to say of inputs that came in the step before and are absent now."""
    return [f"no {name}" for name in before if name not in now]


def _values(signals: _Data, values: _Data) -> str:
    return "  ".join(f"{name}={shown_value(signals, name, value)}" for name, value in values.items())


def shown_value(signals: _Data, name: str, value: bool | int) -> str:
    """Return a member's label, true or false, or the number; variables of observers are numbers without a name for them."""
    members = signals[name]["members"] if name in signals else []
    if members:
        return str(members[value])
    return str(value).lower() if isinstance(value, bool) else str(value)


def trace_charts(trace: _Data, machine: _Data) -> str:
    """Return the charts of a run that ends with the step that violates a property.

    They show the modes, and truth, reported position and margins where the machine reports an interval; otherwise what
    changed most.
    """
    signals = machine["signals"]
    modes = mode_lanes(trace, signals)
    if machine["reported"] is not None:
        return modes + _position_chart(trace, Reported(**machine["reported"]))
    numbers = [name for name in trace["first"] if name in signals and signals[name]["unit"]]
    moving = sorted((name for name in numbers if _spread(trace, name)), key=lambda name: -_spread(trace, name))
    return modes + "".join(
        line_chart(name, signals[name]["unit"], {name: _series(trace, name)}, broken=len(trace["steps"]))
        for name in moving[:_MOST_CHARTS]
    )


def _series(trace: _Data, name: str) -> Series:
    return [float(trace["first"][name]), *(float(step["state"][name]) for step in trace["steps"])]


def _spread(trace: _Data, name: str) -> float:
    values = [value for value in _series(trace, name) if value is not None]
    return max(values) - min(values)


def _position_chart(trace: _Data, reported: Reported) -> str:
    truth = _truth_mm(trace, reported)
    ends = [None, *(reported.interval_mm(step["outputs"]) for step in trace["steps"])]
    position: Series = [None]
    for step, end in zip(trace["steps"], ends[1:], strict=True):
        position.append(None if end is None else float(step["outputs"][reported.position]))
    low: Series = [None if end is None else float(end[0]) for end in ends]
    high: Series = [None if end is None else float(end[1]) for end in ends]
    origin = next((value for value in (*truth, *position) if value is not None), 0.0)
    lines = {"truth": _shift(truth, origin), "reported position": _shift(position, origin)}
    title = f"truth, position and interval, from {origin:.0f} mm on"
    chart = line_chart(title, "mm", lines, (_shift(low, origin), _shift(high, origin)), len(trace["steps"]))
    return chart + _margin_chart(truth, position, low, high)


def _margin_chart(truth: Series, position: Series, low: Series, high: Series) -> str:
    """Draw the deviation of the true position from the reported one, with the margins: outside the band a report is
    WRONG."""
    below, above = _minus(low, position), _minus(high, position)
    lines = {"- below": below, "+ above": above, "truth - position": _minus(truth, position)}
    title = "distance of the truth from the reported position, and margins"
    return line_chart(title, "mm", lines, (below, above), len(truth) - 1)


def _truth_mm(trace: _Data, reported: Reported) -> Series:
    """The ghost in mm; of a recorded run, which has no ghost, the recorded truth, with gaps where there is none."""
    if reported.truth not in trace["first"]:
        recorded = trace["truth_mm"] or [None] * len(trace["steps"])
        return [None, *(None if value is None else float(value) for value in recorded)]
    return [None if value is None else value / NM_PER_MM for value in _series(trace, reported.truth)]


def _shift(series: Series, origin: float) -> Series:
    return [None if value is None else value - origin for value in series]


def _minus(first: Series, second: Series) -> Series:
    return [None if a is None or b is None else a - b for a, b in zip(first, second, strict=True)]
