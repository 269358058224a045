"""A controller in an asyncio host: records come over a stream, a host object follows the modes.

    python docs/examples/asyncio_controller.py [records.jsonl]

A step takes some 25 microseconds, so it runs in the loop itself; a host with many vehicles, or with slow callbacks, gives
each controller a thread of its own (`asyncio.to_thread`): calls are taken one after the other.
"""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Controller, Program, Report
from safeloc.runtime.streams.record_files import record_or_fault
from safeloc.runtime.streams.records import Record, Unusable
from safeloc.shipped_machines import ENTRIES

PERIOD_MS = 100


class BrakeInterlock:
    """The host's own object. Without a place the train may not run on unsupervised."""

    def __init__(self) -> None:
        self.log: list[str] = []

    def on_enter_front(self, event: Any) -> None:
        """Located: the restriction ends."""
        report: Report = event.kwargs["report"]
        where = report.interval.words() if report.interval else "nowhere"
        self.log.append(f"{report.time_ms} ms: released, {where}")

    def on_enter_delocalized(self, event: Any) -> None:
        """Lost: the restriction begins in the same cycle."""
        report: Report = event.kwargs["report"]
        self.log.append(f"{report.time_ms} ms: restricted, {report.outputs['reason']}")


async def cycles(lines: asyncio.StreamReader) -> AsyncIterator[tuple[list[Record | Unusable], int]]:
    """Records of each cycle with its end, from lines in order of time; a cycle is over when a later record comes."""
    end_ms, pending = PERIOD_MS, []
    while line := await lines.readline():
        record = record_or_fault(json.loads(line))
        while record.time_ms > end_ms:
            yield pending, end_ms
            end_ms, pending = end_ms + PERIOD_MS, []
        pending.append(record)
    yield pending, end_ms


async def control(lines: asyncio.StreamReader) -> tuple[Controller, BrakeInterlock]:
    """Steps a controller until the stream ends."""
    config = OdometryConfig(period_ms=PERIOD_MS, trust_first_marker=True)
    controller, interlock = Controller(Program(ENTRIES["odometry"].make(config))), BrakeInterlock()
    controller.follow(interlock)
    async for records, _ in cycles(lines):
        report = controller.step(records)
        for fault in report.rejections:
            interlock.log.append(f"{report.time_ms} ms: {fault.channel} not used, {fault.reason.value}")
    return controller, interlock


async def main(path: Path) -> None:
    """The records of a file, as if they came over a socket."""
    lines = asyncio.StreamReader()
    lines.feed_data(path.read_bytes())
    lines.feed_eof()
    controller, interlock = await control(lines)
    print(*interlock.log, controller.report.words(), sep="\n")


if __name__ == "__main__":
    asyncio.run(main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("records.jsonl")))
