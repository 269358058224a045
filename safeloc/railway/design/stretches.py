"""The stretches of a designed line: from each reference, and each entry of the map, to the next one, with what limits them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.railway.audit.marker_readings import Readings
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stretches import name
from safeloc.railway.design.demands import Stretching
from safeloc.railway.design.figures import Costs
from safeloc.railway.design.options import Options, standing
from safeloc.railway.design.reach import Reach
from safeloc.railway.map.model import Line
from safeloc.railway.map.walk import Walk


@dataclass(frozen=True)
class Stretch:
    """A stretch between two references, or the edge of the map: its length, its limit, and what limits it."""

    origin: str
    goal: str
    direction: str
    length_mm: int
    limit_mm: int
    why: str

    @property
    def spare_mm(self) -> int:
        """The length by which it might be longer."""
        return self.limit_mm - self.length_mm


def stretches(line: Line, reach: Reach) -> list[Stretch]:
    """Return the stretches of a line, the one with the least to spare first; of a vehicle with marker readers those from reading to reading."""
    if reach.layout.markers is not None:
        return sorted(_readings(line, reach), key=lambda one: (one.spare_mm, one.origin, one.goal))
    options = Options(line, tuple(standing(line, Costs(), ())))
    found = dict[tuple[str, str, str], Stretch]()
    for origin, run, way in Stretching(options, reach).ways_of_all():
        if not way:
            continue
        first = way[0]
        limit = reach.limit(origin, first.element)
        begin = f"the edge of the map at {options.walk.topology.start(run)}" if origin is None else name(origin)
        goal = "the end of the map" if first.element is None else name(first.element)
        one = Stretch(begin, goal, run.direction, first.distance_mm, limit.distance_mm, limit.why)
        key = one.origin, one.goal, one.direction
        if key not in found or one.spare_mm < found[key].spare_mm:
            found[key] = one
    return sorted(found.values(), key=lambda one: (one.spare_mm, one.origin, one.goal))


def _readings(line: Line, reach: Reach) -> Iterator[Stretch]:
    layout = reach.layout
    readings = Readings(Walk(line), Rules(layout))
    law = f"{layout.odometry_constant_mm / 1000:.3f} m + {layout.odometry_rate_ppm / 10_000:g} %"
    for goal in readings.goals():
        one = readings.worst(goal)
        length, off = one.figures["distance_mm"], one.figures["apart_mm"]
        kept = one.spare_mm + length + off
        back = "" if goal.mark is None else " and read in a cycle more"
        why = f"odometry {law}: the position is kept for {kept / 1000:.3f} m of true run{back}, less {off / 1000:.3f} m by which the readings may be farther apart"
        yield Stretch(one.origin, goal.name, goal.run.direction, length, kept - off, why)
