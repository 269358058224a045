"""Proofs around a stream: processor time against the length of the stream, the width of the tube and the number of sources that deviate.

python -m benchmarks.bench_around [NAME ...]    all rows, or those of the machines named
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.catalogue import load_target
from safeloc.language.verdict import told
from safeloc.proof.around.claims import written_claim
from safeloc.proof.around.deviations import deviations
from safeloc.proof.around.given import recorded
from safeloc.proof.around.proving import Around
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.replay import read_recording
from safeloc.runtime.streams.steps import StepStream


@dataclass(frozen=True)
class Row:
    """One question: the first `cycles` of a recording, widths by name, and a claim from a cycle on."""

    machine: str
    stream: str
    widths: dict[str, int]
    claim: str
    first: int
    cycles: int = 10**6


FRONT = ("front_wheel_mm", "front_radar_mm")
SOURCES = (*FRONT, "rear_wheel_mm", "rear_radar_mm")
ROWS = (
    *(Row("odometry", "odometry-service", dict.fromkeys(FRONT, 2), "valid", 420, cycles) for cycles in (450, 600, 800, 1050)),
    *(Row("odometry", "odometry-service", dict.fromkeys(FRONT, width), "valid", 420) for width in (0, 1, 4)),
    *(Row("odometry", "odometry-service", dict.fromkeys(SOURCES[:count], 2), "valid", 420, 600) for count in (1, 3, 4)),
    Row("odometry", "odometry-service", {"front_wheel_mm": 50}, "margin_above_mm <= 30000", 420),
    Row("unlinked_group", "unlinked_group-rolled-back", {"odometer_mm": 20, "telegram_age_ms": 20}, "distance_mm <= 572960", 1),
    Row("unlinked_group", "unlinked_group-rolled-back", {"odometer_mm": 20, "telegram_age_ms": 20}, "age_ms <= 34310", 1),
    Row("reflector", "reflector-figure-1", dict.fromkeys(("distance_mm", "echo_1_range_mm", "echo_2_range_mm"), 20), "position_mm <= 973614", 1),
    Row("route", "route-acd-every-reflector", dict.fromkeys(("odometer_mm", "sighting_range_mm"), 1), "route_1_high_mm <= 320075", 1),
    Row("balise", "balise-service", {"odometer_mm": 2}, 'mode != "DELOCALIZED"', 500),
    Row("balise", "balise-service", {"odometer_mm": 10}, 'mode != "DELOCALIZED"', 500),
    Row("axle_counter", "axle_counter-crawling", {"axle_speed_low_mm_s": 5, "axle_speed_high_mm_s": 5}, "record_axles <= 20", 1),
    Row("localizer", "localizer-main-line", {"motion.odometer_mm": 1}, "arbitration.valid", 230),
    Row("localizer", "localizer-main-line", {"motion.odometer_mm": 5}, "arbitration.valid", 230),
)  # fmt: skip


def measured(row: Row) -> str:
    """Return a row of the table."""
    target = load_target(row.machine)
    path = next(one for one in target.streams if one.name.startswith(row.stream))
    stream, _ = read_recording(target, path)
    stream = StepStream(
        stream.steps[: row.cycles], stream.lines[: row.cycles], stream.first, stream.machine, stream.columns
    )
    run = recorded(target, path, stream)
    near = deviations(target.system, row.widths, {}, {})
    asked = [written_claim(target.system, row.claim, row.first, None)]
    began, clock = _processor_s(), time.monotonic()
    [found] = Around(target.name, target.system, row.stream, run.given, near, asked, Limits()).findings()
    used, waited = _processor_s() - began, time.monotonic() - clock
    widths = ", ".join(f"{name} ± {width}" for name, width in row.widths.items())
    return f"| {row.stream} | {run.given.length} | {widths} | `{row.claim}` | {told(found.result)} | {used:.0f} | {waited:.0f} |"


def _processor_s() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def rows(names: list[str]) -> Iterator[Row]:
    """Yield the rows of these machines; all if none is named."""
    yield from (row for row in ROWS if not names or row.machine in names)


if __name__ == "__main__":
    print("| stream | cycles | widths | claim | verdict | processor s | clock s |\n|---|---|---|---|---|---|---|")
    for each in rows(sys.argv[1:]):
        print(measured(each), flush=True)
