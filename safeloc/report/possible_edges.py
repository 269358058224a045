"""The edges of a map on which a vehicle may be, over time: one strip for each edge, with the true one underlined."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from safeloc.language.units import MS_PER_S
from safeloc.railway.pictures import PossibleEdges
from safeloc.report.drawing import (
    LEFT,
    Axis,
    across,
    across_axis,
    legend,
    line,
    picture,
    stroke_swatch,
    word,
)
from safeloc.report.recorded_run import RecordedRun, Series
from safeloc.report.strips import TALL, strip, strip_legend
from safeloc.report.thinning import Point
from safeloc.report.violations import head, violations

_APART = TALL + 10
_MOST = 40
"""Edges that are drawn; of a longer drive the first ones, and how many more there are."""
_POSSIBLE, _TOLD, _WRONG = _STANDINGS = ("possible", "told", "told: NOT the true one")


def possible_edges_picture(one: PossibleEdges, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a run without steps, or without any edge."""
    edges = list(dict.fromkeys(edge for row in _by_step(one, recorded) for edge in row))
    if not edges:
        return ""
    times: Series = [float(number * one.period_ms) for number in range(1, len(recorded.rows) + 1)]
    axis, top, names = across([0.0, times[-1] or 0.0]), head(recorded), one.called(recorded.name)
    made, shown = list[str](), edges[:_MOST]
    standings = [_standings(one, recorded, edge) for edge in shown]
    for row, (edge, words) in enumerate(zip(shown, standings, strict=True)):
        y = top + _APART * row
        made.append(_row(axis, times, words, y, names.get(edge, f"edge {edge}")))
        made.append(_truth(axis, times, [true == edge for true in _true_edges(one, recorded)], y + TALL + 2))
    bottom = top + _APART * len(shown)
    made.append(word(LEFT, bottom + 10, _left_out(edges), soft=True))
    modes, members = recorded.words(one.mode), recorded.members(one.mode)
    made.append(strip(axis, times, modes, members, bottom + 18, "mode"))
    bottom += 18 + _APART
    made.append(across_axis(axis, bottom + 4, "time in s", unit=MS_PER_S))
    made.append(violations(recorded, times, axis, bottom))
    first, y = legend(strip_legend(modes, members), bottom + 62, "mode")
    keys = strip_legend([standing or "" for words in standings for standing in words], _STANDINGS)
    second, y = legend([*keys, stroke_swatch("", "the true edge", width=3)], y)
    return picture([*made, first, second], y, f"{one.title}, recording {recorded.name}")


def _by_step(one: PossibleEdges, recorded: RecordedRun) -> Iterator[list[int]]:
    """Yield the edges of each step: those that are possible, and the true one if it is known."""
    for row, true in zip(recorded.rows, _true_edges(one, recorded), strict=True):
        found = [int(row[track.edge]) for track in one.tracks.possible if row[track.edge]]
        yield found if true is None else [*found, true]


def _true_edges(one: PossibleEdges, recorded: RecordedRun) -> list[int | None]:
    """Return the true edge of each step; None where the recording has no true position."""
    pairs = zip(recorded.rows, recorded.truth_mm, strict=True)
    return [None if truth is None else int(row[one.true_edge]) for row, truth in pairs]


def _standings(one: PossibleEdges, recorded: RecordedRun, edge: int) -> list[str | None]:
    """Return how each step speaks of an edge; None where it is excluded."""
    found = list[str | None]()
    for row, true in zip(recorded.rows, _true_edges(one, recorded), strict=True):
        if row[one.tracks.edge] == edge:
            found.append(_TOLD if true in (None, edge) else _WRONG)
        else:
            found.append(_POSSIBLE if any(row[track.edge] == edge for track in one.tracks.possible) else None)
    return found


def _row(axis: Axis, times: Series, words: Sequence[str | None], y: float, label: str) -> str:
    places = [time if standing else None for time, standing in zip(times, words, strict=True)]
    return strip(axis, places, [standing or "" for standing in words], _STANDINGS, y, label)


def _truth(axis: Axis, times: Series, there: Sequence[bool], y: float) -> str:
    """Draw a line where this is the true edge."""
    stretches = list[list[Point]]()
    for true, group in groupby(zip(there, times, strict=True), lambda pair: pair[0]):
        places = [axis.at(time) for _, time in group if time is not None]
        if true:
            stretches.append([Point(places[0], y), Point(places[-1], y)])
    return line(stretches, "", kind="true-edge", width=3)


def _left_out(edges: Sequence[int]) -> str:
    return f"{len(edges) - _MOST} more edges are not drawn" if len(edges) > _MOST else ""
