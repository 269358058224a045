"""Picture of the possible routes over the distance run, with the reasons that excluded the others (source 001, fig. 3)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from safeloc.language.nodes import Value
from safeloc.railway.pictures import Hypothesis, Recognition, TrackPlan
from safeloc.report.drawing import (
    BLUE,
    GREEN,
    GREY,
    LEFT,
    RIGHT,
    SKY,
    Axis,
    Swatch,
    across,
    across_axis,
    box,
    box_swatch,
    cross,
    diamond,
    legend,
    line,
    metres,
    picture,
    triangle,
    upright,
    wide,
    word,
)
from safeloc.report.plan import Seen, plan_drawing, plan_height
from safeloc.report.recorded_run import RecordedRun, Series
from safeloc.report.strips import TALL, strip, strip_legend
from safeloc.report.thinning import Point
from safeloc.report.violations import head, violations

_ROW = 26


class _Refuted(NamedTuple):
    """The end of a route's possibility: the step (from 0), and the reason: what was seen, and what the route has instead."""

    step: int
    why: str


@dataclass(frozen=True)
class _Hunt:
    """A run as positions (mm from the common start), possible routes and refutations."""

    one: Recognition
    recorded: RecordedRun
    plan: TrackPlan | None

    @cached_property
    def places(self) -> Series:
        """The true distance of each step, or the middle of all possible intervals if it is unknown."""
        truth = self.recorded.truth(self.one.truth)
        return [
            self._middle(row) if true is None else true for true, row in zip(truth, self.recorded.rows, strict=True)
        ]

    def _middle(self, row: Mapping[str, Value]) -> float | None:
        ends = [row[name] for one in self.one.hypotheses if row[one.possible] for name in (one.low, one.high)]
        return (min(ends) + max(ends)) / 2 if ends else None

    @cached_property
    def counts(self) -> list[int]:
        """The number of possible routes after each step."""
        return [sum(bool(row[one.possible]) for one in self.one.hypotheses) for row in self.recorded.rows]

    @property
    def stated(self) -> int | None:
        """The number of the only route that is possible at the end; None if there is none or more than one."""
        last = [one.number for one in self.one.hypotheses if self.recorded.rows[-1][one.possible]]
        return last[0] if len(last) == 1 else None

    @property
    def missed(self) -> Seen:
        """The reflectors seen on the stated route, and the farthest position of the vehicle."""
        route = next((one for one in self.one.hypotheses if one.number == self.stated), None)
        furthest = max((place for place in self.places if place is not None), default=0.0)
        seen = {given[route.place] for given in self.recorded.given if route is not None and route.place in given}
        return Seen(self.stated, frozenset(seen), furthest)

    def refutations(self, route: Hypothesis) -> Iterator[_Refuted]:
        """Yield each step in which the route ceases to be possible."""
        possible = self.recorded.flags(route.possible)
        for step in range(1, len(possible)):
            if possible[step - 1] and not possible[step]:
                yield _Refuted(step, self._why(route, step))

    def _why(self, route: Hypothesis, step: int) -> str:
        given, seen = self.recorded.given[step], self.one.sighting
        if seen.start in given:
            return "a new start"
        fired = ", ".join(self.recorded.trace.steps[step].fired.values())
        if self.counts[step] == 0:
            return f"all given up: {fired}"
        if seen.range in given:
            before = self.recorded.rows[step - 1]
            return self._not_there(route, given, (before[route.low] + before[route.high]) / 2)
        turned, course = (self.recorded.word(name, given[name]) for name in (seen.turned, route.course))
        return f"turned {turned}, this route goes {course}"

    def _not_there(self, route: Hypothesis, given: Mapping[str, Value], about: float) -> str:
        seen = self.one.sighting
        model, away = self.recorded.word(seen.model, given[seen.model]), given[seen.range]
        at = f"about {metres(about + away)}"
        if route.place not in given:
            return f"reflector {model} seen at {at}: none of model {model} on this route"
        other = self.recorded.word(route.model, given[route.model])
        nearest = f"the nearest {other} of this route is at {metres(given[route.place])}"
        return f"reflector {model} seen at {at}: {nearest}"


def recognition_picture(one: Recognition, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a run without any position."""
    hunt = _Hunt(one, recorded, one.plan(recorded.name))
    places = [place for place in hunt.places if place is not None]
    if not places:
        return ""
    plan = hunt.plan
    ends = [] if plan is None else [float(at) for track in plan.tracks for at, _ in track.points]
    axis = across([*places, *ends])
    top = head(recorded)
    y = top + (0 if plan is None else plan_height(plan))
    made = list[str]()
    if plan is not None:
        made.append(plan_drawing(plan, axis, top, hunt.missed))
    bottom = y + (len(one.hypotheses) + 2) * _ROW
    made += [_switches(plan, axis, y, bottom), _sightings(hunt, axis, y)]
    for number, route in enumerate(one.hypotheses, 1):
        made.append(_route(hunt, route, axis, y + number * _ROW))
    modes, members = recorded.words(one.mode), recorded.members(one.mode)
    made.append(strip(axis, hunt.places, modes, members, bottom - _ROW, "mode"))
    made.append(across_axis(axis, bottom + 4, "distance from the common start in m"))
    made.append(violations(recorded, hunt.places, axis, bottom))
    first, y = legend(strip_legend(modes, members), bottom + 62, "mode")
    second, y = legend(_keys(hunt), y)
    return picture([*made, first, second], y, f"{one.title}, recording {recorded.name}")


def _switches(plan: TrackPlan | None, axis: Axis, top: float, bottom: float) -> str:
    """Draw a line down through the strips at each switch, where routes part."""
    marks = () if plan is None else plan.marks
    return "".join(
        upright(axis.at(mark.at_mm), top, bottom, GREY, kind="at-switch", dash="1 3")
        for mark in marks
        if mark.kind == "switch"
    )


def _sightings(hunt: _Hunt, axis: Axis, y: float) -> str:
    """Draw the strip of the reflector model in view."""
    seen = hunt.one.sighting
    words = [
        hunt.recorded.word(seen.model, given[seen.model]) if seen.range in given else ""
        for given in hunt.recorded.given
    ]
    places = [place if label else None for place, label in zip(hunt.places, words, strict=True)]
    return strip(axis, places, words, hunt.recorded.members(seen.model), y, "reflector in view")


def _route(hunt: _Hunt, route: Hypothesis, axis: Axis, y: float) -> str:
    """Draw one route: where it is possible, where it is the only one, and where and why it is refuted."""
    label = f"route {route.number}"
    if hunt.plan is not None and route.number in hunt.plan.routes:
        label += f" {hunt.plan.routes[route.number]}"
    words = [
        None if not possible else "only" if count == 1 else "possible"
        for possible, count in zip(hunt.recorded.flags(route.possible), hunt.counts, strict=True)
    ]
    made = [word(LEFT - 8, y + TALL - 6, label, anchor="end", style=_bold(route.number == hunt.stated))]
    made.append(f'<path d="M{LEFT} {y + TALL / 2:.1f}H{RIGHT}" class="grid"/>')
    made += [
        box(begin, y, end - begin, TALL, GREEN if kind == "only" else SKY, kind=f"route-{route.number} {kind}")
        for kind, begin, end in _bars(hunt, axis, words)
    ]
    for refuted in hunt.refutations(route):
        place = hunt.places[refuted.step]
        if place is not None:
            made.append(_refutation(axis.at(place), y + TALL / 2, route.number, refuted, place))
    return "".join(made)


def _bold(wanted: bool) -> str:
    return "font-weight:700" if wanted else ""


def _bars(hunt: _Hunt, axis: Axis, words: list[str | None]) -> Iterator[tuple[str, float, float]]:
    """Yield the bars of a route: a text, with start and end on the page."""
    begin: float | None = None
    last = 0.0
    for step, label in enumerate(words):
        place = hunt.places[step]
        x = last if place is None else axis.at(place)
        if begin is None and label is not None:
            begin = x
        following = words[step + 1] if step + 1 < len(words) else None
        if begin is not None and label is not None and following != label:
            after = hunt.places[step + 1] if step + 1 < len(words) else None
            end = x if after is None else axis.at(after)
            yield label, min(begin, end), max(begin, end)
            begin = None
        last = x


def _refutation(x: float, y: float, number: int, refuted: _Refuted, place: float) -> str:
    text = f"{metres(place)}: {refuted.why}"
    right = x + 12 + wide(text) < RIGHT
    label = word(x + 12 if right else x - 12, y + 4, text, anchor="start" if right else "end", style=_on_bar(right))
    return cross(x, y, kind=f"refuted-{number}") + label


def _on_bar(right: bool) -> str:
    """Return the style of words: left of the cross they are on the bar, which is light in every colour scheme."""
    return "" if right else "fill:#101418"


def _keys(hunt: _Hunt) -> list[Swatch]:
    keys = [
        box_swatch(SKY, "route is possible"),
        box_swatch(GREEN, "it is the only possible one"),
        Swatch(cross(13, 0, kind="key"), "refuted, with the reason"),
    ]
    if hunt.plan is not None:
        keys.append(Swatch(diamond(13, 0, kind="key"), "reflector and its model; filled: seen on the stated route"))
        keys.append(Swatch(triangle(13, -5, kind="key"), "balise group"))
        if any(mark.kind == "marker" for mark in hunt.plan.marks):
            keys.append(Swatch(upright(13, -8, 8, GREEN, kind="key"), "marker"))
        keys.append(Swatch(f'<circle cx="13" cy="0" r="4" class="key ink" fill="{GREY}"/>', "switch"))
    if hunt.plan is not None and hunt.stated is not None:
        way = line([[Point(0, 0), Point(26, 0)]], BLUE, kind="key", width=6)
        keys.append(Swatch(way, f"route stated at the end: {hunt.stated}"))
    return keys
