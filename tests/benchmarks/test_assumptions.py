"""The benchmark of judging laws compares like with like: the same lawful lines, with and without."""

from __future__ import annotations

import json

import pytest

from benchmarks.bench_assumptions import PERIOD_MS, Turns, spent_s, turns
from benchmarks.vehicle_lines import odometry_lines
from safeloc.runtime.service.fleet import FleetSettings
from tests.runtime.embedding.driving import trusting


def test_both_ways_are_timed() -> None:
    """On a short drive, in each round; what counts are the least times."""
    lines = [line for line, _ in zip(odometry_lines("1", PERIOD_MS), range(50), strict=False)]
    found = turns(trusting(), False, lines, 2)
    assert 2 == len(found.without) == len(found.judged)
    assert min(*found.without, *found.judged) > 0
    assert (1.5, [1.0, 2.0]) == (Turns([2.0, 3.0], [4.0, 3.0]).ratio, Turns([2.0, 3.0], [4.0, 3.0]).ratios)


def test_a_drive_that_breaks_a_law_is_no_measure() -> None:
    """The slow way of telling a breach is not what is measured."""
    said = {"kind": "distance", "end": "rear", "unit": "radar", "distance_mm": 0}
    late = [
        {"kind": "distance", "time_ms": 500, "end": "front", "unit": "wheel", "distance_mm": 0},
        {**said, "time_ms": 300},
    ]
    lines = [json.dumps({"number": number, **one}).encode() + b"\n" for number, one in enumerate(late, 1)]
    lines.append(json.dumps({"number": 3, "kind": "cycle", "time_ms": 500}).encode() + b"\n")
    with pytest.raises(RuntimeError, match=r"^no lawful drive: .*breaches=1"):
        spent_s(trusting(), FleetSettings(PERIOD_MS), lines)
