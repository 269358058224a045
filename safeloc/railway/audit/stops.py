"""Stop points: the reflector is ahead, at the set distance, in view, and the stop window can be kept (RFL-D7)."""

from __future__ import annotations

from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.rules import Rules
from safeloc.railway.map.elements import Reflector, StopPoint
from safeloc.railway.map.places import Place, along
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Walk


def check_stops(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Check every stop point."""
    for stop in walk.line.stop_points:
        _check(walk, rules, ledger, stop)


def _check(walk: Walk, rules: Rules, ledger: Ledger, stop: StopPoint) -> None:
    place, subject = Place(stop.edge, stop.position_mm), f"stop point {stop.id}"
    run = Run(stop.edge, stop.direction)
    window = {"window_before_mm": stop.window_before_mm, "window_after_mm": stop.window_after_mm}
    ledger.check(rules.stop_window, place, subject, **window)
    if run not in walk.references:
        ledger.add(rules.standstill, place, f"{subject}: its direction is against regular travel")
        return
    known = next((one for one in walk.line.reflectors if one.id == stop.reflector), None)
    if known is None:
        return  # on a part of the map that is not loaded
    found = _ahead(walk, run, stop, known)
    if found is None:
        ledger.add(rules.standstill, place, f"{subject}: reflector {stop.reflector} is not ahead of it")
        return
    stated = stop.standstill_distance_mm
    ledger.check(rules.standstill, place, subject, stated_mm=stated, distance_mm=found)
    view = {"view_from_mm": known.view_from_mm, "view_to_mm": known.view_to_mm}
    ledger.check(rules.stop_view, place, f"{subject} with reflector {known.id}", standstill_mm=found, **window, **view)


def _ahead(walk: Walk, run: Run, stop: StopPoint, reflector: Reflector) -> int | None:
    """Return the distance from the stop point to its reflector; None if the reflector is not ahead."""
    reach = max(2 * stop.standstill_distance_mm, reflector.view_from_mm) + 1_000_000
    start = along(run.direction, walk.topology.length_mm(run), stop.position_mm)
    seen = (one for one in walk.ahead(run, start, reach) if one.element is reflector)
    return next((one.distance_mm for one in seen), None)
