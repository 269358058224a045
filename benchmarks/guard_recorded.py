"""The guard on recorded trains: python -m benchmarks.guard_recorded ../shared/data

First each log as it was recorded, on the way that the train took and on the whole network: what was passed on, what was
withheld and why, how many fixes a second. Then each log on every other way over the network along which a hundred fixes or more
are passed on: whether the way was told to be doubtful, and how many fixes beside the true way were passed on before that. Then the clean logs with spells of another receiver's fault put in: for some
fixes the position of some seconds before is told, on the track and at a plausible speed. What was recorded there counts as
the truth; an interval that misses it is wrong.
"""

from __future__ import annotations

import csv
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random

from safeloc.models.guard.variables import GuardConfig
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.fields import Columns
from safeloc.railway.guard.figures import find_vehicle, guard_config
from safeloc.railway.guard.guard import Guard, Judgement
from safeloc.railway.guard.streams import csv_deliveries
from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.geojson_path import read_path, route_over
from safeloc.railway.map.projection import Projector
from safeloc.railway.map.routes import Route, through_routes
from safeloc.railway.map.topology import Topology

PATHS = {
    "28876": "log_28876_L36-B-path-calculation.geojson",
    "31176": "log_31176_25N-B_to_L36C-B-path-calculation.geojson",
    "29083": "log_29083_L36-A-path-calculation.geojson",
}
EDGES_31259 = ["5916", "2026", "7855", "7818", "9754", "5831", "2013", "9755", "2014", "7819", "7154", "9422", "1388"]
CLEAN = ("28876", "31176")
MOST_WAYS, LEAST_PASSED = 4_000, 100
TWO_WAYS = ("28586",)
"""It is not known over which of two tracks the train ran."""
SPELLS, DELAYS, ROWS, RUNS = (1, 4, 8, 20, 50), (5, 12, 25, 50), (2, 5, 10), 12


@dataclass(frozen=True)
class Recording:
    """A log, its line and the way the train took."""

    name: str
    fixes: tuple[Delivery, ...]
    topology: Topology
    route: Route

    def guarded(self, fixes: Sequence[Delivery], config: GuardConfig, *, known: bool = True) -> list[Judgement]:
        """What the guard makes of fixes on this line."""
        way = self.route if known else None
        line, clear, reach = self.topology.line, config.track_clearance_mm, config.tolerance_mm
        return list(Guard(config, Tracks(line, clear_mm=clear, reach_mm=reach, route=way)).judge_all(fixes))


def recordings(folder: Path) -> dict[str, Recording]:
    """All logs. Whoever has none gets the error of the missing file."""
    topology = Topology(read_geojson(folder / "network_airport.geojson").line)
    return {log: _recording(folder, log, topology) for log in ("28876", "31176", "31259", "29083", "28586")}


def _recording(folder: Path, log: str, topology: Topology) -> Recording:
    if log in PATHS:
        route = read_path(folder / PATHS[log], topology).route
    else:
        route = route_over([f"88_L_{number}" for number in EDGES_31259], topology)
    with (folder / f"log_{log}.csv").open(newline="", encoding="utf-8") as lines:
        return Recording(log, tuple(csv_deliveries(lines, Columns(flag="position_type"), log)), topology, route)


def as_recorded(one: Recording, config: GuardConfig, *, known: bool) -> list[str]:
    """A row of the first table."""
    started = time.perf_counter()
    found = one.guarded(one.fixes, config, known=known)
    rate = len(found) / (time.perf_counter() - started)
    edges = {run.edge for run in one.route.runs}
    foreign = sum(each.passed and each.place is not None and each.place.edge not in edges for each in found)
    reasons = ", ".join(f"{reason} {number}" for reason, number in Counter(each.reason for each in found).most_common())
    return [one.name, "known" if known else "open", reasons, str(foreign), f"{rate:.0f}"]


def other_ways(one: Recording) -> Iterator[Route]:
    """Every way over the network that runs nowhere against the train, once for all that differ only where no fix lies."""
    true = {run.edge for run in one.route.runs}
    tracks = Projector(one.topology.line)
    places = [(fix.x, fix.y) for fix in one.fixes[::10] if fix.x is not None and fix.y is not None]
    near = {each.place.edge for x, y in places for each in tracks.near(x, y, 10_000)}
    seen: set[frozenset[str]] = set()
    for route in through_routes(one.topology, MOST_WAYS):
        against = any(run.edge in true and run not in one.route.runs for run in route.runs)
        met = frozenset(run.edge for run in route.runs) & near
        if not against and not met >= true & near and met not in seen:
            seen.add(met)
            yield route


def on_another_way(one: Recording, config: GuardConfig) -> list[object]:
    """A row of the table on wrong ways: ways, of them with fixes beside the true way, told as doubtful, most fixes there before and in all."""
    true, tried, beside, told, before, most = {run.edge for run in one.route.runs}, 0, 0, 0, 0, 0
    for route in other_ways(one):
        found = [each for each in replace(one, route=route).guarded(one.fixes, config) if each.passed]
        if len(found) < LEAST_PASSED:
            continue
        off = [number for number, each in enumerate(found) if each.place is not None and each.place.edge not in true]
        doubts = [number for number, each in enumerate(found) if each.beside is not None and each.beside.doubtful]
        first = doubts[0] if doubts else len(found)
        tried, beside, told = tried + 1, beside + (len(off) > 0), told + (len(doubts) > 0)
        before, most = max(before, sum(number < first for number in off)), max(most, len(off))
    return [one.name, tried, beside, told, before, most]


def delayed(fixes: Sequence[Delivery], begin: int, spell: int, delay: int) -> list[Delivery]:
    """The fixes with a spell in which those of some fixes before are told again."""
    made = list(fixes)
    for number in range(begin, begin + spell):
        old = fixes[number - delay]
        made[number] = replace(fixes[number], x=old.x, y=old.y)
    return made


def wrong(found: Sequence[Judgement], truth: Mapping[int, int]) -> int:
    """Intervals that miss what was recorded there."""
    return sum(
        not each.interval_mm[0] <= truth[each.delivery.number] <= each.interval_mm[1]
        for each in found
        if each.interval_mm is not None
    )


def with_spells(one: Recording, config: GuardConfig, spell: int) -> tuple[int, int, int]:
    """Runs with a wrong interval, wrong intervals, and intervals in all."""
    random = Random(spell)
    truth = {each.delivery.number: each.position_mm or 0 for each in one.guarded(one.fixes, config)}
    runs = misses = total = 0
    for number in range(RUNS):
        delay = DELAYS[number % len(DELAYS)]
        begin = random.randrange(100, len(one.fixes) - 100)
        found = one.guarded(delayed(one.fixes, begin, spell, delay), config)
        missed = wrong(found, truth)
        runs, misses, total = (
            runs + (missed > 0),
            misses + missed,
            total + sum(f.interval_mm is not None for f in found),
        )
    return runs, misses, total


def main(data: str) -> None:
    """Print both tables."""
    table = csv.writer(sys.stdout, delimiter="|")
    known = recordings(Path(data) / "trains")
    config = guard_config(find_vehicle("desiro-br642"))
    table.writerow(["log", "way", "deliveries", "on a track beside the way", "fixes a second"])
    for way in (True, False):
        table.writerows(as_recorded(one, config, known=way) for one in known.values())
    table.writerow(
        ["log", "other ways", "with fixes beside the true way", "told as doubtful", "most such fixes before", "in all"]
    )
    table.writerows(on_another_way(one, config) for one in known.values() if one.name not in TWO_WAYS)
    table.writerow(["log", "row", "spell of late fixes", "runs with a wrong interval", "wrong", "intervals"])
    for row in ROWS:
        chosen = config.model_copy(update={"confirmations": row})
        for log in CLEAN:
            for spell in SPELLS:
                runs, misses, total = with_spells(known[log], chosen, spell)
                table.writerow([log, row, spell, f"{runs} of {RUNS}", misses, total])


if __name__ == "__main__":
    main(sys.argv[1])
