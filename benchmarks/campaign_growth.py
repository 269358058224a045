"""How the cost of a campaign grows: python -m benchmarks.campaign_growth

With the vehicles of a shard, with their cycles, and with the sources of a localizer. Processor time of this process for
simulation, machine with clauses, and counting, the best of three shards; the ratio is to the first row of each table.
"""

from __future__ import annotations

import time
from collections.abc import Iterable

from benchmarks.bench_campaign import JOURNEY, ON_LINE, Cost, costs
from benchmarks.localizers import SOURCES, with_sources
from safeloc.campaign.counted import Counted, alert_limit_mm, to_parquet
from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.judged import judge_of, libraries
from safeloc.campaign.scenes import drawn_runs
from safeloc.models.localizer.simulation.many import LocalizerJourneys
from safeloc.shipped_machines import ENTRIES

VEHICLES, CYCLES = (25, 50, 100, 200, 400, 800), (575, 1_150, 2_300, 4_600)
FIXED_VEHICLES, FIXED_CYCLES = 200, 2_300
LOCALIZERS = 100
"""Vehicles of a shard of localizers."""
SHARDS = 3


def odometry(vehicles: int, cycles: int) -> Cost:
    """The cheapest of three shards of so many vehicles and cycles."""
    text = ON_LINE.format(machine="odometry", vehicles=vehicles, total=vehicles * SHARDS)
    said = text.replace("cycles = 2300", f"cycles = {cycles}")
    return min(costs(parse_campaign(said, "growth")), key=lambda one: one.whole)


def localizer(sources: int) -> Cost:
    """The cheapest of three shards of localizers with the first so many sources, on one journey, with the same draws."""
    config = with_sources(sources)
    target = ENTRIES["localizer"].make(config)
    journeys = LocalizerJourneys(config, target.system, "main-line", libraries())
    judge = judge_of(target)
    campaign = parse_campaign(
        JOURNEY.format(machine="localizer", vehicles=LOCALIZERS, total=LOCALIZERS * SHARDS), "growth"
    )
    found = []
    for shard in campaign.shards:
        drawn = drawn_runs(campaign, shard)[1]
        began = time.process_time()
        runs = journeys.runs(drawn, campaign.declared.cycles)
        simulated = time.process_time()
        outcome = judge.outcome(runs)
        moved = time.process_time()
        to_parquet(Counted(shard, judge.clauses, drawn, outcome, alert_limit_mm(campaign, target), 50_000).groups())
        found.append(Cost(outcome.told.size, simulated - began, moved - simulated, time.process_time() - moved))
    return min(found, key=lambda one: one.whole)


def table(what: str, rows: Iterable[tuple[object, Cost]]) -> None:
    """Print a row for each size, with the cost of a vehicle-cycle and its ratio to the first row."""
    print(
        f"| {what} | us a vehicle-cycle | ratio | simulation | machine and clauses | counting |\n|---|---|---|---|---|---|"
    )
    first = 0.0
    for size, cost in rows:
        us = cost.whole / cost.vehicle_cycles * 1e6
        first = first or us
        parts = " | ".join(f"{part / cost.whole:.0%}" for part in (cost.simulation, cost.machine, cost.counting))
        print(f"| {size} | {us:.2f} | {us / first:.2f} | {parts} |", flush=True)
    print()


def main() -> None:
    """Print all three tables."""
    table(f"vehicles of a shard, {FIXED_CYCLES} cycles", ((size, odometry(size, FIXED_CYCLES)) for size in VEHICLES))
    table(f"cycles, {FIXED_VEHICLES} vehicles", ((size, odometry(FIXED_VEHICLES, size)) for size in CYCLES))
    table("sources of the localizer", ((size, localizer(size)) for size in range(1, len(SOURCES) + 1)))


if __name__ == "__main__":
    main()
