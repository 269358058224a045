"""The intervals of several sources over time relative to the truth, one row each; the fused interval; the leading source.

Each row has its own scale: 0 is the true front end, or the reported one if the truth is unknown.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.railway.pictures import NamedInterval, Sources, ThingKind, Things
from safeloc.report.drawing import (
    BLUE,
    GREEN,
    GREY,
    LEFT,
    RED,
    RIGHT,
    Axis,
    Swatch,
    across_axis,
    band,
    box,
    box_swatch,
    diamond,
    legend,
    line,
    metres,
    picture,
    stroke_swatch,
    triangle,
    upright,
    wide,
    word,
)
from safeloc.report.recorded_run import RecordedRun, Series
from safeloc.report.refusals import refused
from safeloc.report.strips import TALL, strip, strip_legend
from safeloc.report.thinning import Point, Span, spans
from safeloc.report.violations import head, violations

_ROW, APART, LEAST_MM = 74, 16, 2_000


@dataclass(frozen=True)
class _Passed:
    """Something beside the line, with the time in s at which the front end passes it."""

    kind: ThingKind
    label: str
    at_mm: int
    at_s: float


def sources_picture(one: Sources, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a run without any position."""
    zero = _zero(one, recorded)
    if all(place is None for place in zero):
        return ""
    times: Series = [step * one.period_ms / 1_000 for step in range(len(zero))]
    axis, top = Axis(0, len(zero) * one.period_ms / 1_000, LEFT, RIGHT), head(recorded) + 24
    made = [_map(one, recorded, axis, zero, top)]
    y = top + 62
    for interval in (*one.sources, NamedInterval("passed on", one.fused)):
        made.append(_row(one, interval, recorded, axis, zero, y))
        y += _ROW + APART
    leads = recorded.words(one.lead)
    made.append(strip(axis, times, leads, recorded.members(one.lead), y, "leads"))
    y += TALL + 10
    made.append(across_axis(axis, y, "time in s", unit=1))
    made.append(violations(recorded, times, axis, y))
    drawn, y = legend([*_keys(one, recorded), *strip_legend(leads, recorded.members(one.lead))], y + 58)
    return picture([*made, drawn], y, f"{one.title}, recording {recorded.name}")


def _zero(one: Sources, recorded: RecordedRun) -> Series:
    """Return the true position of each step, or the one passed on if the truth is unknown."""
    pairs = zip(recorded.truth(one.fused.truth), recorded.trace.steps, strict=True)
    return [truth if truth is not None else _passed_on(one, step.outputs) for truth, step in pairs]


def _passed_on(one: Sources, outputs: object) -> float | None:
    assert isinstance(outputs, dict)
    return None if one.fused.interval_mm(outputs) is None else float(outputs[one.fused.position])


# ------------------------------------------------------------------ the line, with things that the front end passes


def _map(one: Sources, recorded: RecordedRun, axis: Axis, zero: Series, y: float) -> str:
    made = [word(LEFT - 8, y + 4, "passes", anchor="end")]
    made.append(f'<path d="M{LEFT} {y:.1f}H{RIGHT}" class="ink track" stroke-width="3"/>')
    taken: dict[int, float] = dict.fromkeys((-22, 24, 38), float(LEFT) - 60)
    for thing in sorted(_all_passed(one, recorded, zero), key=lambda thing: thing.at_s):
        x, text = axis.at(thing.at_s), f"{thing.kind} {thing.label}".strip()
        made.append(_drawn(thing.kind, x, y))
        rows = (-22,) if thing.kind == "reflector" else (24, 38)
        free = next((row for row in rows if taken[row] + 6 < x - wide(text) / 2), None)
        if free is not None:
            taken[free] = x + wide(text) / 2
            made.append(word(x, y + free, text, anchor="middle"))
    return "".join(made)


def _drawn(kind: ThingKind, x: float, y: float) -> str:
    match kind:
        case "balise":
            return triangle(x, y, kind="balise")
        case "reflector":
            return diamond(x, y - 8, kind="reflector")
        case "marker":
            return upright(x, y - 9, y + 9, GREEN, kind="marker", dash="")


def _all_passed(one: Sources, recorded: RecordedRun, zero: Series) -> Iterator[_Passed]:
    for things in one.beside:
        yield from _passed(one, things, recorded, zero)


def _passed(one: Sources, things: Things, recorded: RecordedRun, zero: Series) -> Iterator[_Passed]:
    """Yield each thing once: a reflector when the front end reaches it, anything else when it is first read."""
    first = {given[things.at]: step for step, given in reversed(list(enumerate(recorded.given))) if things.at in given}
    for at, read in first.items():
        step = _reached(zero, at) if things.kind == "reflector" else read
        if step is not None:
            label = recorded.given[read].get(things.label)
            text = "" if label is None else recorded.word(things.label, label)
            yield _Passed(things.kind, text, at, step * one.period_ms / 1_000)


def _reached(zero: Series, at: int) -> int | None:
    """Return the step in which the front end reaches a place; None if it starts beyond it or does not reach it."""
    known = [(step, place) for step, place in enumerate(zero) if place is not None]
    if not known or known[0][1] > at:
        return None
    return next((step for step, place in known if place >= at), None)


# ------------------------------------------------------------------ rows


def _row(one: Sources, interval: NamedInterval, recorded: RecordedRun, axis: Axis, zero: Series, top: float) -> str:
    """Draw the margins around 0, the stretches without an interval, and the refusals of one source."""
    ends = [interval.reported.interval_mm(step.outputs) for step in recorded.trace.steps]
    offs = [
        None if end is None or at is None else (end[0] - at, end[1] - at) for end, at in zip(ends, zero, strict=True)
    ]
    widest = max([LEAST_MM, *(abs(side) for off in offs if off is not None for side in off)])
    widest = -(-widest // 1_000) * 1_000
    height, fused = Axis(-widest, widest, top + _ROW, top), interval.reported == one.fused
    drawn = [
        None if off is None else Span(axis.at(step * one.period_ms / 1_000), height.at(off[0]), height.at(off[1]))
        for step, off in enumerate(offs)
    ]
    made = [_scale(height, interval.name), _silent(one, axis, ends, top, RED if fused else GREY)]
    made.append(band(spans(drawn), GREEN if fused else BLUE, kind=f"interval-{interval.name}".replace(" ", "-")))
    middle = height.at(0)
    made.append(line([[Point(LEFT, middle), Point(RIGHT, middle)]], "", kind="zero", width=1))
    return "".join(made) + _marks(one, interval.name, recorded, axis, top)


def _scale(height: Axis, name: str) -> str:
    """Draw the frame of a row, its name, and the ends of its scale in m."""
    size, most = height.begin - height.end, metres(height.high)
    made = f'<rect x="{LEFT}" y="{height.end:.1f}" width="{RIGHT - LEFT}" height="{size:.1f}" class="frame"/>'
    made += word(LEFT - 8, height.end + 10, f"+{most}", anchor="end", soft=True)
    made += word(LEFT - 8, height.begin, f"\N{MINUS SIGN}{most}", anchor="end", soft=True)
    return made + word(LEFT - 8, height.at(0) + 4, name, anchor="end")


def _silent(one: Sources, axis: Axis, ends: list[tuple[int, int] | None], top: float, colour: str) -> str:
    """Draw the stretches in which a source reports no interval."""
    made, begin, second = "", 0, one.period_ms / 1_000
    for step in range(1, len(ends) + 1):
        if step == len(ends) or (ends[step] is None) is not (ends[begin] is None):
            if ends[begin] is None:
                x = axis.at(begin * second)
                made += box(x, top, axis.at(step * second) - x, _ROW, colour, kind="silent", faint=True)
            begin = step
    return made


def _marks(one: Sources, name: str, recorded: RecordedRun, axis: Axis, top: float) -> str:
    """Draw a line at every refusal of the source, at most one in each column of the page."""
    times = [run.begin * one.period_ms / 1_000 for run in refused(one, recorded) if run.of == name]
    return "".join(
        upright(x, top, top + 12, RED, kind="refused", dash="") for x in sorted({round(axis.at(t)) for t in times})
    )


def _keys(one: Sources, recorded: RecordedRun) -> list[Swatch]:
    known = any(place is not None for place in recorded.truth(one.fused.truth))
    zero = "0: the true front end" if known else "0: the front end as passed on (no truth recorded)"
    return [
        stroke_swatch("", zero, width=1),
        box_swatch(BLUE, "interval stated by a source", faint=True),
        box_swatch(GREEN, "interval passed on", faint=True),
        box_swatch(GREY, "no interval stated", faint=True),
        box_swatch(RED, "restrictive: nothing passed on", faint=True),
        stroke_swatch(RED, "rejected or withdrawn: see the table"),
        Swatch("", "each row has its own scale"),
    ]
