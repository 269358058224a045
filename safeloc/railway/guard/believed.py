"""Selects the fixes of a recording that the guard passes on. Only these may serve as true positions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.figures import guard_config
from safeloc.railway.guard.guard import Guard
from safeloc.railway.guard.other_way import Beside
from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.projection import WGS84
from safeloc.railway.map.recorded_run import Fix
from safeloc.railway.map.routes import Route


@dataclass(frozen=True)
class Believed:
    """The times of the fixes that the guard passes on, how many of them came while the route was doubtful, and what made it so first."""

    times: frozenset[int]
    doubtful: int
    doubt: Beside | None


def believed(fixes: Iterable[Fix], route: Route, *, max_speed_mm_s: int, crs: str = WGS84) -> Believed:
    """Return the fixes that the guard passes on, on this route in its own direction.

    Raises InputError for a speed outside the guard's range, and for a route with edges that have no course.
    """
    config = guard_config(None, {"max_speed_mm_s": max_speed_mm_s})
    clear, reach = config.track_clearance_mm, config.tolerance_mm
    guard = Guard(config, Tracks(route.topology.line, clear_mm=clear, reach_mm=reach, route=route, crs=crs))
    deliveries = (Delivery(number, fix.time_ms, fix.x, fix.y) for number, fix in enumerate(fixes, 1))
    passed = [one for one in guard.judge_all(deliveries) if one.passed]
    doubts = [one.beside for one in passed if one.beside is not None and one.beside.doubtful]
    return Believed(frozenset(one.delivery.time_ms or 0 for one in passed), len(doubts), doubts[0] if doubts else None)


def believed_times(fixes: Iterable[Fix], route: Route, *, max_speed_mm_s: int, crs: str = WGS84) -> frozenset[int]:
    """Return the times of these fixes alone."""
    return believed(fixes, route, max_speed_mm_s=max_speed_mm_s, crs=crs).times
