"""Markers: near enough to each other on every route, read one by one, and not too many under one vehicle (MRK-1, MRK-D1, MRK-D5)."""

from __future__ import annotations

from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.marker_readings import Pair, Readings
from safeloc.railway.audit.rules import Rules
from safeloc.railway.map.walk import Walk


def check_markers(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Check every reading of a marker, and every way off the map, on all ways that lead to it; then the markers themselves."""
    readings = Readings(walk, rules)
    for goal in readings.goals():
        worst = readings.worst(goal)
        ledger.check(
            rules.marker_stretch,
            walk.place(goal.run, min(goal.offset_mm, walk.topology.length_mm(goal.run))),
            f"from {worst.origin} to {goal.name}, {goal.run.direction}",
            **worst.figures,
        )
    _one_by_one(readings, rules, ledger)
    _waiting(readings, rules, ledger)


def _one_by_one(readings: Readings, rules: Rules, ledger: Ledger) -> None:
    """Check every two markers so near each other on some route that one may be read for the other's turn."""
    nearest: dict[frozenset[str], Pair] = {}
    for pair in readings.pairs(readings.widest_mm + rules.layout.readers.cycle_run_mm):
        both = frozenset((pair.first.name, pair.second.name))
        if both not in nearest or pair.distance_mm < nearest[both].distance_mm:
            nearest[both] = pair
    for pair in nearest.values():
        ledger.check(
            rules.marker_order,
            readings.walk.place(pair.run, pair.offset_mm),
            f"{pair.first.name} and {pair.second.name}",
            spacing_mm=pair.distance_mm,
            within_mm=pair.first.accuracy_mm + pair.second.accuracy_mm,
        )


def _waiting(readings: Readings, rules: Rules, ledger: Ledger) -> None:
    """Check at every marker how many may be under the vehicle on some route, it and those behind it."""
    for mark, run, offset in readings.everywhere():
        ledger.check(
            rules.markers_waiting,
            readings.walk.place(run, offset),
            f"{mark.name} and those behind it, {run.direction}",
            under_the_vehicle=len(readings.under_the_vehicle(mark, run, offset)),
        )
