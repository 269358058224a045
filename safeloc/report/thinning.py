"""Thinning of long runs for a page that keeps every extreme value."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple, TypeAlias


class Point(NamedTuple):
    """A place on the page."""

    x: float
    y: float


class Span(NamedTuple):
    """A band's lower and upper edge at one place across the page."""

    x: float
    low: float
    high: float


_Pieces: TypeAlias = list[list[Point]]


def pieces(points: Iterable[Point | None]) -> _Pieces:
    """Return the uninterrupted stretches of points; None is a gap."""
    return [[point for point in run if point is not None] for gap, run in groupby(points, _is_gap) if not gap]


def spans(bands: Iterable[Span | None]) -> list[list[Span]]:
    """Return the uninterrupted stretches of a band; None is a gap."""
    return [[span for span in run if span is not None] for gap, run in groupby(bands, _is_gap) if not gap]


def _is_gap(value: object) -> bool:
    return value is None


def thinned(points: Sequence[Point]) -> list[Point]:
    """Return, of successive points in one column of the page (a unit wide), the first, lowest, highest and last, in order."""
    return [point for column in _columns(points) for point in _kept(column)]


def _columns(points: Sequence[Point]) -> Iterator[list[Point]]:
    for _, column in groupby(points, lambda point: round(point.x)):
        yield list(column)


def _kept(column: list[Point]) -> Iterator[Point]:
    heights = [point.y for point in column]
    wanted = {0, heights.index(min(heights)), heights.index(max(heights)), len(column) - 1}
    return (column[index] for index in sorted(wanted))


def thinned_band(band: Sequence[Span]) -> list[Span]:
    """Return, for successive spans in one column, one that reaches from the lowest to the highest of them."""
    made = []
    for _, group in groupby(band, lambda span: round(span.x)):
        column = list(group)
        made.append(Span(column[0].x, min(one.low for one in column), max(one.high for one in column)))
        if len(column) > 1:
            made.append(made[-1]._replace(x=column[-1].x))
    return made
