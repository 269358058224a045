"""What the computers of vehicles send to a process, cycle after cycle: made beforehand, so that sending is all that is left."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache

from benchmarks.localizers import with_sources
from safeloc.language.system import without_ghosts
from safeloc.models.localizer import LocalizerConfig
from safeloc.runtime.streams.steps import read_steps
from safeloc.shipped_machines import ENTRIES

STEP_MM, MARKER_EVERY = 120, 200
UNITS = (("front", "wheel"), ("front", "radar"), ("rear", "wheel"), ("rear", "radar"))


@dataclass(frozen=True)
class Traffic:
    """A machine, its configuration as TOML by its period in ms, further arguments, and a vehicle's lines by name and period."""

    machine: str
    config: Callable[[int], str]
    arguments: tuple[str, ...]
    lines: Callable[[str, int], Iterator[bytes]]


def odometry_lines(vehicle: str, period_ms: int) -> Iterator[bytes]:
    """Records: four distances, now and then a marker, and the end of the cycle."""
    number = cycle = 0
    while True:
        cycle += 1
        said = list(_records(cycle, cycle * period_ms))
        counted = (
            f'{{"vehicle": "{vehicle}", "number": {number + place}, {one}\n' for place, one in enumerate(said, 1)
        )
        yield "".join(counted).encode()
        number += len(said)


def _records(cycle: int, time_ms: int) -> Iterator[str]:
    for end, unit in UNITS:
        yield f'"kind": "distance", "time_ms": {time_ms}, "end": "{end}", "unit": "{unit}", "distance_mm": {STEP_MM}}}'
    if cycle % MARKER_EVERY == 1:
        place = f'"position_mm": {cycle * STEP_MM}, "accuracy_mm": 500, "since_mm": 0'
        number = 1 + cycle // MARKER_EVERY
        yield f'"kind": "marker", "time_ms": {time_ms}, "end": "front", "marker": {number}, {place}}}'
    yield f'"kind": "cycle", "time_ms": {time_ms}}}'


def odometry_steps(vehicle: str, period_ms: int) -> Iterator[bytes]:
    """The same drive as inputs of whole steps: one line a cycle."""
    del period_ms  # steps have numbers, not times
    cycle = 0
    while True:
        cycle += 1
        inputs: dict[str, object] = {f"{end}_{unit}_mm": STEP_MM for end, unit in UNITS}
        if cycle % MARKER_EVERY == 1:
            inputs |= {
                "front_marker": 1 + cycle // MARKER_EVERY, "front_marker_position_mm": cycle * STEP_MM,
                "front_marker_accuracy_mm": 500, "front_marker_since_mm": 0,
            }  # fmt: skip
        yield json.dumps({"vehicle": vehicle, "cycle": cycle, **inputs}).encode() + b"\n"


def localizer_lines(vehicle: str, period_ms: int) -> Iterator[bytes]:
    """Inputs of whole steps: the shipped journeys, one after the other, over and over."""
    del period_ms  # steps have numbers, not times
    return _numbered_steps(vehicle, _journey(LocalizerConfig()))


def _numbered_steps(vehicle: str, journey: Sequence[str]) -> Iterator[bytes]:
    cycle = 0
    while True:
        yield f'{{"vehicle": "{vehicle}", "cycle": {cycle + 1}, {journey[cycle % len(journey)]}\n'.encode()
        cycle += 1


def localizer_of(sources: int) -> Traffic:
    """The first so many of the localizer's sources, on the same journeys."""
    config = with_sources(sources)

    def lines(vehicle: str, period_ms: int) -> Iterator[bytes]:
        del period_ms  # steps have numbers, not times
        return _numbered_steps(vehicle, _journey(config))

    named = ", ".join(f'"{one}"' for one in config.sources)
    return Traffic("localizer", lambda _: f"sources = [{named}]\n", ("--inputs",), lines)


@cache
def _journey(config: LocalizerConfig) -> list[str]:
    """The inputs of each step as JSON, without the opening brace."""
    target = ENTRIES["localizer"].make(config)
    names = {var.name for var in without_ghosts(target.system).inputs}
    steps = [step for path in target.streams for step in read_steps(path).steps]
    return [json.dumps({name: value for name, value in step.items() if name in names})[1:] for step in steps]


def _odometry_config(period_ms: int) -> str:
    return f"trust_first_marker = true\nperiod_ms = {period_ms}\nreader_latency_ms = 5\n"


TRAFFIC = {
    "odometry": Traffic("odometry", _odometry_config, (), odometry_lines),
    "odometry_steps": Traffic("odometry", _odometry_config, ("--inputs",), odometry_steps),
    "localizer": Traffic("localizer", lambda _: "", ("--inputs",), localizer_lines),
}
"""Of machines that can be driven. The localizer's steps are sent as often as asked for, whatever their length."""
