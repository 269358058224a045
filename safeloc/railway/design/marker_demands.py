"""Demands of the rules on markers, as clauses over all options at once: what keeps the position until each reading, and pairs too near.

The clauses on readings are the audit's rule itself: every goal of the audit, on every way that leads to it. So that the lower bound is
tight, the same is asked of every place on the way, whether or not something is read there: a position is kept from reading to reading.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from safeloc.railway.audit.marker_readings import Goal, Readings
from safeloc.railway.audit.rules import Rules
from safeloc.railway.design.least_cost import Demand
from safeloc.railway.design.options import Options


def marker_demands(options: Options, rules: Rules) -> Iterator[Demand]:
    """Yield the demands on all readings of markers, and that of two markers too near each other one is not chosen."""
    readings = Readings(options.walk, rules)
    for goal in readings.goals():
        yield from _before(options, readings, goal)
        if goal.mark is not None and not goal.path:
            yield from _before(options, readings, replace(goal, mark=None))
    for pair in readings.pairs(readings.widest_mm + rules.layout.readers.cycle_run_mm):
        within = pair.first.accuracy_mm + pair.second.accuracy_mm
        if rules.marker_order.broken({"spacing_mm": pair.distance_mm, "within_mm": within}):
            both = (options.number_of(pair.first.element), options.number_of(pair.second.element))
            yield Demand(frozenset(), frozenset(both))


def _before(options: Options, readings: Readings, goal: Goal) -> Iterator[Demand]:
    """On each way to a goal something that keeps the position is chosen, or what is read there is not."""
    unless = frozenset[int]() if goal.mark is None else frozenset([options.number_of(goal.mark.element)])
    for way in readings.ways(goal, None):
        near = [one for one in way.origins if one.spare_mm >= 0]
        if any(one.mark is None for one in near):
            continue
        numbers = frozenset(options.number_of(one.mark.element) for one in near if one.mark is not None)
        if not numbers & unless:
            yield Demand(numbers, unless)
