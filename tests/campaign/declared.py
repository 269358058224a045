"""Campaigns for the tests."""

from __future__ import annotations

from pathlib import Path

SKIDDING = f"{Path(__file__).with_name('skidding.py')}:machine"
SMALL = f"""machine = "{SKIDDING}"
cycles = 150
seed = 3
shard_vehicles = 4
alert_limit_mm = 5_000

[[situations]]
name = "every second one skids"
weight = 1.0
vehicles = 10
"""
"""Three shards, the last one with two vehicles."""

ON_VALLEY = """machine = "odometry"
cycles = 600
shard_vehicles = 3

[figures]
top_share = { distribution = "choice", values = [0.9, 1.0], unit = "share" }

[[lines]]
line = "valley"

[[vehicles]]
vehicle = "desiro-br642"

[[situations]]
name = "no fault"
weight = 0.75
vehicles = 3

[[situations]]
name = "the front wheel slides"
weight = 0.25
vehicles = 3
[[situations.faults]]
kind = "slide"
where = "front_wheel"
begin = { distribution = "uniform", low = 10, high = 20, unit = "s" }
lasts = { distribution = "fixed", value = 50, unit = "cycles" }
"""
