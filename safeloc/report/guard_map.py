"""A guarded run as a map: tracks, the fixes that were passed on, and those that were withheld, by reason."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from safeloc.report.drawing import GREY, RIGHT, Axis, Swatch, legend, line, metres, picture, stroke_swatch, word
from safeloc.report.guard_words import PASSED, WORDS, mark
from safeloc.report.thinning import Point

_LEFT, TALLEST, LEAST, MARGIN = 15, 640, 240, 25
_Course = Sequence[tuple[float, float]]


class Spot(NamedTuple):
    """A fix in the plane, in metres, and the reason why it was passed on or withheld."""

    east: float
    north: float
    reason: str


@dataclass(frozen=True)
class _Frame:
    """The part of the plane that is shown, at the same scale in both directions."""

    east: Axis
    north: Axis

    def at(self, east: float, north: float) -> Point:
        """Return a place on the page."""
        return Point(self.east.at(east), self.north.at(north))

    def holds(self, east: float, north: float) -> bool:
        """Return whether the map shows this point."""
        return self.east.holds(east) and self.north.holds(north)

    @property
    def scale(self) -> float:
        """Units of the page per metre."""
        return (self.east.end - self.east.begin) / (self.east.high - self.east.low)


def guard_map(courses: Mapping[str, _Course], way: Iterable[str], spots: Sequence[Spot], title: str) -> str:
    """Return the drawing of all spots; empty if there are none."""
    if not spots:
        return ""
    frame = _frame([(spot.east, spot.north) for spot in spots])
    chosen = set(way)
    made = [_tracks([c for e, c in courses.items() if e not in chosen], frame, GREY, 1.0)]
    made += [_tracks([c for e, c in courses.items() if e in chosen], frame, "", 1.6)]
    made += [_marks(spots, frame), _scale_bar(frame)]
    y = frame.north.begin + 42
    keys, y = legend(_keys(spots, bool(chosen)), y)
    clip = f'<clipPath id="{_name(title)}"><rect x="0" y="0" width="1000" height="{frame.north.begin:.0f}"/></clipPath>'
    drawn = "".join(made[:-1])
    return picture([clip, f'<g clip-path="url(#{_name(title)})">{drawn}</g>', made[-1], keys], y, title)


def _name(title: str) -> str:
    return "map-" + "".join(letter if letter.isalnum() else "-" for letter in title)


def _frame(places: Sequence[tuple[float, float]]) -> _Frame:
    """Return a frame around all places, with a margin; its height follows from the scale, within limits."""
    east, north = [place[0] for place in places], [place[1] for place in places]
    width, height = max(max(east) - min(east), 50.0) * 1.06, max(max(north) - min(north), 50.0) * 1.06
    across = RIGHT - _LEFT
    scale = min(across / width, TALLEST / height)
    tall = max(height * scale, LEAST)
    mid_east, mid_north = (max(east) + min(east)) / 2, (max(north) + min(north)) / 2
    half_east, half_north = across / scale / 2, tall / scale / 2
    return _Frame(
        Axis(mid_east - half_east, mid_east + half_east, _LEFT, RIGHT),
        Axis(mid_north - half_north, mid_north + half_north, MARGIN + tall, MARGIN),
    )


def _tracks(courses: Iterable[_Course], frame: _Frame, colour: str, width: float) -> str:
    """Draw the courses that touch the frame; the page clips the parts outside."""
    shown = [course for course in courses if _comes_in(course, frame)]
    return line([[frame.at(*point) for point in course] for course in shown], colour, kind="track", width=width)


def _comes_in(course: _Course, frame: _Frame) -> bool:
    east, north = [point[0] for point in course], [point[1] for point in course]
    apart = max(east) < frame.east.low or min(east) > frame.east.high
    return not (apart or max(north) < frame.north.low or min(north) > frame.north.high)


def _marks(spots: Sequence[Spot], frame: _Frame) -> str:
    """Draw a mark for each spot, at most one per reason and unit of the page; withheld ones on top."""
    found: dict[tuple[int, int, str], str] = {}
    for spot in sorted(spots, key=lambda one: one.reason != PASSED):
        at = frame.at(spot.east, spot.north)
        found.setdefault((round(at.x), round(at.y), spot.reason), mark(at.x, at.y, spot.reason))
    return "".join(found.values())


def _scale_bar(frame: _Frame) -> str:
    """Draw the scale bar, with the direction of north."""
    length = next(one for one in (5000, 2000, 1000, 500, 200, 100, 50, 20, 10, 5) if one * frame.scale <= 260)
    y, end = frame.north.begin + 14, _LEFT + length * frame.scale
    bar = f'<path d="M{_LEFT} {y - 4:.1f}v8m0 -4H{end:.1f}m0 -4v8" class="ink" fill="none"/>'
    return bar + word(end + 8, y + 4, f"{metres(length * 1000)}, north is up")


def _keys(spots: Sequence[Spot], way: bool) -> list[Swatch]:
    keys = [stroke_swatch("", "the way", width=1.6)] if way else []
    keys.append(stroke_swatch(GREY, "other tracks" if way else "tracks", width=1))
    counts = Counter(spot.reason for spot in spots)
    for reason in WORDS:
        if counts[reason]:
            keys.append(Swatch(mark(13, 0, reason, 4), f"{reason}: {counts[reason]}"))
    return keys
