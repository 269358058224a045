"""What the benchmark of the process sends is what a process takes: every line used, one report for each cycle."""

from __future__ import annotations

import tomllib
from collections import Counter
from itertools import islice
from typing import Any

import pytest

from benchmarks.vehicle_lines import MARKER_EVERY, TRAFFIC
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Program, localizer_program
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.lines import LineCutter
from safeloc.shipped_machines import ENTRIES


def told(program: Program, machine: str, period_ms: int, cycles: int) -> list[dict[str, Any]]:
    """Answers of a process to one vehicle."""
    traffic = TRAFFIC[machine]
    fleet, cutter = Fleet(program, FleetSettings(period_ms, inputs="--inputs" in traffic.arguments)), LineCutter()
    sent = islice(traffic.lines("v1", period_ms), cycles)
    return [one for text in sent for line in cutter.feed(text) for one in fleet.handle("peer", line, from_start=True)]


@pytest.mark.parametrize("traffic", ["odometry", "odometry_steps"])
def test_odometry_vehicles(traffic: str) -> None:
    """The first marker locates them, and so they stay, over the next one; as records, and as inputs of steps."""
    period_ms = 10
    config = OdometryConfig.model_validate(tomllib.loads(TRAFFIC["odometry"].config(period_ms)))
    answers = told(Program(ENTRIES["odometry"].make(config)), traffic, period_ms, MARKER_EVERY + 5)
    assert [one["cycle"] for one in answers] == [*range(1, MARKER_EVERY + 6)]
    assert all("rejections" not in one and one["interval_mm"] is not None for one in answers)
    assert answers[MARKER_EVERY]["outputs"]["reference_accepted"]


@pytest.mark.slow
def test_localizer_vehicles() -> None:
    """Their journeys are taken step by step, with nothing refused, and locate them for a part of the way."""
    answers = told(localizer_program(), "localizer", 100, 500)
    assert len(answers) == 500
    found = Counter((one["interval_mm"] is not None, "rejections" in one) for one in answers)
    assert set(found) == {(False, False), (True, False)}
