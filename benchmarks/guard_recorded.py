"""The guard on recorded trains: python -m benchmarks.guard_recorded ../shared/data

First each log as it was recorded, on the way that the train took and on the whole network: what was passed on, what was
withheld and why, how many fixes a second. Then the clean logs with spells of another receiver's fault put in: for some
fixes the position of some seconds before is told, on the track and at a plausible speed. What was recorded there counts as
the truth; an interval that misses it is wrong.
"""

from __future__ import annotations

import csv
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
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
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Topology

PATHS = {
    "28876": "log_28876_L36-B-path-calculation.geojson",
    "31176": "log_31176_25N-B_to_L36C-B-path-calculation.geojson",
    "29083": "log_29083_L36-A-path-calculation.geojson",
}
EDGES_31259 = ["5916", "2026", "7855", "7818", "9754", "5831", "2013", "9755", "2014", "7819", "7154", "9422", "1388"]
CLEAN = ("28876", "31176")
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
    table.writerow(["log", "row", "spell of late fixes", "runs with a wrong interval", "wrong", "intervals"])
    for row in ROWS:
        chosen = config.model_copy(update={"confirmations": row})
        for log in CLEAN:
            for spell in SPELLS:
                runs, misses, total = with_spells(known[log], chosen, spell)
                table.writerow([log, row, spell, f"{runs} of {RUNS}", misses, total])


if __name__ == "__main__":
    main(sys.argv[1])
