"""The track plan of a line, drawn over the same distance axis as the panels below it."""

from __future__ import annotations

from typing import NamedTuple

from safeloc.railway.pictures import PlanMark, TrackPlan
from safeloc.report.drawing import BLUE, GREEN, GREY, SKY, Axis, cross, line, triangle, upright, word
from safeloc.report.thinning import Point

_LANE, HEAD = 74, 30


class Seen(NamedTuple):
    """The stated route, the places of reflectors seen on it, and the farthest position of the vehicle; mm from the start."""

    route: int | None
    places: frozenset[int]
    furthest: float

    def passed_unseen(self, mark: PlanMark) -> bool:
        """Return whether the vehicle passed a reflector of the stated route without seeing it."""
        return self.route in mark.routes and mark.at_mm <= self.furthest and mark.at_mm not in self.places


def plan_height(plan: TrackPlan) -> float:
    """Return the height of the plan on the page."""
    return plan.lanes * _LANE + HEAD


def plan_drawing(plan: TrackPlan, axis: Axis, top: float, seen: Seen) -> str:
    """Draw the tracks, the stated route as a wide line below them, and everything beside them with its name."""
    made = []
    for track in plan.tracks:
        points = [Point(axis.at(at), _y(top, lane)) for at, lane in track.points]
        if seen.route in track.routes:
            made.append(line([points], BLUE, kind=f"stated track-{track.name}", width=9))
    for track in plan.tracks:
        points = [Point(axis.at(at), _y(top, lane)) for at, lane in track.points]
        made.append(line([points], "", kind=f"track track-{track.name}", width=2.4))
    marks = sorted(plan.marks, key=lambda mark: mark.at_mm)
    made += [_mark(mark, axis, top, seen, _leaves_down(plan, mark)) for mark in marks]
    return "".join(made)


def _leaves_down(plan: TrackPlan, mark: PlanMark) -> bool:
    """Return whether a track leads from the mark to a lane below, where the name would otherwise be written."""
    place = (mark.at_mm, mark.lane)
    ends = [
        (track.points[0], track.points[-1]) for track in plan.tracks if place in (track.points[0], track.points[-1])
    ]
    return any(lane > mark.lane for pair in ends for _, lane in pair)


def _y(top: float, lane: float) -> float:
    return top + HEAD / 2 + _LANE / 2 + lane * _LANE


def _mark(mark: PlanMark, axis: Axis, top: float, seen: Seen, down: bool) -> str:
    x, y = axis.at(mark.at_mm), _y(top, mark.lane)
    if mark.kind == "switch":
        dot = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{GREY}" class="switch ink"/>'
        return dot + word(x, y - 11 if down else y + 19, mark.name, anchor="middle")
    if mark.kind == "balise":
        return triangle(x, y, kind="balise") + word(x, y + 24, mark.name, anchor="middle")
    if mark.kind == "marker":
        return upright(x, y - 9, y + 9, GREEN, kind="marker") + word(x, y + 24, mark.name, anchor="middle")
    return _reflector(mark, x, y, seen)


def _reflector(mark: PlanMark, x: float, y: float, seen: Seen) -> str:
    """Draw a diamond with the model in it and the name above, or beside it on a ramp; crossed out if passed unseen."""
    ramp = mark.lane != int(mark.lane)
    x, middle = (x + 18, y - 4) if ramp else (x, y - 14)
    found = seen.route in mark.routes and mark.at_mm in seen.places
    fill, ink = (SKY, "#101418") if found else ("var(--page,#fff)", "var(--ink,#1c2733)")
    shape = f'<path d="M{x:.1f} {middle - 11:.1f}l11 11l-11 11l-11 -11z" fill="{fill}" class="reflector ink"/>'
    shape += word(x, middle + 4, mark.model, anchor="middle", style=f"fill:{ink};font-weight:700")
    unseen = seen.passed_unseen(mark)
    name = f"{mark.name} not seen" if unseen else mark.name
    shape += cross(x, middle, kind="unseen", size=9) if unseen else ""
    return shape + (word(x + 15, middle + 4, name) if ramp else word(x, middle - 15, name, anchor="middle"))
