"""How the cost of a fleet over a broker grows: python -m benchmarks.fleet_growth [seconds]

With the vehicles, with the sources of a localizer, and with the cycles that a fleet has run; nothing is killed. Processor
time a message of the processes and of the broker; the ratio is to the first row of each table.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable

from benchmarks.bench_fleet import PERIOD_MS, Measured, measured
from benchmarks.localizers import SOURCES
from benchmarks.vehicle_lines import TRAFFIC, localizer_of

SECONDS = 20.0
VEHICLES, LOCALIZERS, LONGER = (50, 100, 200, 400, 800), 100, (1, 2, 4)


def table(what: str, rows: Iterable[tuple[object, Measured]]) -> None:
    """Print a row for each size."""
    print(
        f"| {what} | messages | unreported | us a message, processes / broker | ratio | p50 | p99 |\n|---|---|---|---|---|---|---|"
    )
    first = 0.0
    for size, one in rows:
        us = one.processes_us + one.broker_us
        first = first or us
        lost = one.sent - len(one.latencies_ms)
        late = f"{one.quantile_ms(0.5):.0f} ms | {one.quantile_ms(0.99):.0f} ms"
        spent = f"{one.processes_us:.0f} / {one.broker_us:.0f}"
        print(f"| {size} | {one.sent} | {lost} | {spent} | {us / first:.2f} | {late} |", flush=True)
    print()


def main() -> None:
    """Print all three tables."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    steps = TRAFFIC["odometry_steps"]
    table("vehicles of odometry, whole steps", ((size, measured(seconds, size, steps, 0)) for size in VEHICLES))
    table(
        f"sources of {LOCALIZERS} localizers",
        ((size, measured(seconds, LOCALIZERS, localizer_of(size), 0)) for size in range(1, len(SOURCES) + 1)),
    )
    cycles = ((round(seconds * times * 1_000 / PERIOD_MS), seconds * times) for times in LONGER)
    table("cycles of 200 vehicles of odometry", ((size, measured(long, 200, steps, 0)) for size, long in cycles))


if __name__ == "__main__":
    main()
