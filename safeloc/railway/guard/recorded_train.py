"""A recorded train on its route, as the records that its odometers, balise readers and satellite receiver would have sent.

The guard decides which fixes of the log are believed: no other fix becomes a marker, a balise reading or the true position.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from safeloc.railway.guard.believed import believed
from safeloc.railway.guard.other_way import Beside
from safeloc.railway.map.placing import with_balise_groups
from safeloc.railway.map.recorded_run import (
    Reading,
    Trust,
    balise_records,
    in_order,
    odometer_records,
    on_route,
    read_fixes,
    satellite_records,
    trusted_times,
    truth_records,
)
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Topology
from safeloc.runtime.streams.records import Record

_FIRST_FIX_IDENTITY = 500_000
"""Fixes as virtual markers are numbered from here on, beyond every NID_BG."""


@dataclass(frozen=True)
class RecordedTrain:
    """The records of a recorded train, in order of time, with counts: all fixes, those near the track, those trusted by
    the guard, balise readings, and fixes that the guard passed on while the route was doubtful, with what made it so first."""

    records: tuple[Record, ...]
    fixes: int
    near: int
    trusted: int
    balises: int
    doubtful: int = 0
    doubt: Beside | None = None


def equipped(route: Route, spacing_mm: int | None, at_mm: Iterable[int], accuracy_mm: int) -> Route:
    """Return the route with further balise groups on it, numbered after those of the line.

    spacing_mm  distance between groups; None: no such groups; at_mm: positions of single groups along the route
    """
    spaced = [] if spacing_mm is None else range(spacing_mm, route.length_mm, spacing_mm)
    places = sorted({*spaced, *at_mm})
    highest = max((group.identity for group in route.topology.line.balise_groups), default=0)
    line = with_balise_groups(route, places, first_identity=highest + 1, accuracy_mm=accuracy_mm)
    return Route(Topology(line), route.runs, route.start_mm, route.end_mm)


def recorded_train(
    log: Path, route: Route, trust: Trust, reading: Reading, accuracies: Mapping[str, int]
) -> RecordedTrain:
    """Return the records of the train whose log (CSV) is given.

    accuracies  quality flag of the receiver -> accuracy in mm: fixes with this flag become markers. StreamError for a log
                that cannot be read
    """
    fixes = read_fixes(log)
    placed = on_route(fixes, route)
    passed = believed(fixes, route, max_speed_mm_s=trust.max_speed_mm_s)
    trusted = trusted_times([fix for fix in placed if fix.time_ms in passed.times], trust)
    balises = list(balise_records(placed, route, reading, trusted))
    records = in_order(
        balises,
        satellite_records(placed, accuracies, _FIRST_FIX_IDENTITY, trusted),
        odometer_records(placed, along="radar", straight="wheel"),
        truth_records(placed, trusted),
    )
    near = sum(abs(fix.offset_mm) <= trust.offset_limit_mm for fix in placed)
    return RecordedTrain(tuple(records), len(placed), near, len(trusted), len(balises), passed.doubtful, passed.doubt)
