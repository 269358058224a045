"""An area for the tests: its wiring, its program, and the process without a broker."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from safeloc.models.area import AreaConfig
from safeloc.models.sections import SectionsConfig
from safeloc.railway.trackside.area_fleet import AreaFleet
from safeloc.railway.trackside.area_vehicle import AreaVehicle
from safeloc.railway.trackside.wiring import Wiring, load_wiring
from safeloc.runtime.embedding import Program
from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.topics import Topics, partition_of
from safeloc.runtime.service.fleet import FleetSettings
from safeloc.runtime.service.lines import Line
from safeloc.shipped_machines import ENTRIES

END_MM, SECTION_MM, PERIOD_MS, CLOCK_ERROR_MS = 3_000_000, 500_000, 1_000, 50
LENGTHS_MM = {"a": 120_000, "b": 80_000, "c": 200_000}
CODES = Codes(b"0123456789abcdef0123456789abcdef")
TOPICS, OF_AREAS = Topics("fleet", 4), Topics("areas", 4)
Data = dict[str, Any]


@cache
def config() -> SectionsConfig:
    """Six sections, two detection sections inside, two slots."""
    area = AreaConfig(trains=2, borders="occupancy", entry_report_delay_ms=2_000, inner_detection=2)
    return SectionsConfig(area=area, sections=END_MM // SECTION_MM)


@cache
def program() -> Program:
    """The machine, compiled once."""
    return Program(ENTRIES["sections"].make(config()))


def wiring_text(*, faces_upwards: bool = True, shortest_mm: int = 5_000) -> str:
    """The file of `--trackside`, of one area `west` and three vehicles."""
    stretches = [[begin, begin + SECTION_MM] for begin in range(0, END_MM, SECTION_MM)]
    vehicles = "".join(
        f'[vehicles.{name}]\nlength_mm = {length}\nfaces_upwards = {json.dumps(faces_upwards)}\nwhole = "whole"\n'
        for name, length in LENGTHS_MM.items()
    )
    return (
        f'fleet = "fleet"\npartitions = 4\nclock_error_ms = {CLOCK_ERROR_MS}\nshortest_mm = {shortest_mm}\n{vehicles}'
        f"[areas.west]\nlow_end_mm = 0\nhigh_end_mm = {END_MM}\nsections_mm = {stretches}\n"
        f"inner_mm = [[0, {END_MM // 2}], [{END_MM // 2 + 1}, {END_MM}]]\n"
    )


def wired(folder: Path, text: str | None = None) -> Wiring:
    """The wiring of a text, read from a file."""
    path = folder / "areas.toml"
    path.write_text(wiring_text() if text is None else text, encoding="utf-8")
    return load_wiring(path, config())


def topic_of(vehicle: str) -> str:
    """Where the reports of a vehicle are."""
    return TOPICS.report(partition_of(vehicle, TOPICS.partitions), vehicle)


def report(vehicle: str, time_ms: int, low_mm: int, high_mm: int, *, whole: bool = True) -> bytes:
    """A report with its code, as the process of the vehicle publishes it."""
    fields = {
        "vehicle": vehicle,
        "time_ms": time_ms,
        "interval_mm": [low_mm, high_mm],
        "outputs": {"whole": whole},
    }
    return CODES.added(topic_of(vehicle), json.dumps(fields).encode())


class Process:
    """The areas of a process, fed by hand: what it was told of detection can be told again, as a broker does."""

    def __init__(self, wiring: Wiring) -> None:
        self._wiring = wiring
        self.fleet = AreaFleet(program(), FleetSettings(PERIOD_MS), wiring, CODES, OF_AREAS)
        self.lines: list[bytes] = []
        self._saved: tuple[int, Mapping[str, Any]] | None = None

    def detect(self, cycle: int, **found: bool) -> list[Data]:
        """A line of detection, and what it leads to; inputs by their names in the area."""
        fields = {"vehicle": "west", "number": len(self.lines) + 1, "cycle": cycle, "area.counters_healthy": True}
        text = json.dumps({**fields, **{f"area.{name}": value for name, value in found.items()}}).encode()
        return self.say(CODES.added(OF_AREAS.record("west"), text))

    def say(self, text: bytes) -> list[Data]:
        """A line of detection as it stands."""
        self.lines.append(text)
        return self._handled(len(self.lines))

    def hear(self, vehicle: str, payload: bytes) -> list[Data]:
        """A report under the topic of a vehicle."""
        return self.fleet.told(vehicle, payload)

    def save(self) -> None:
        """A snapshot."""
        self._saved = len(self.lines), json.loads(json.dumps(self.fleet.freeze()()))

    def move(self) -> list[Data]:
        """Go on in another process, from the last snapshot: lines of detection since then come again, reports do not."""
        self.fleet = AreaFleet(program(), FleetSettings(PERIOD_MS), self._wiring, CODES, OF_AREAS)
        known = 0
        if self._saved is not None:
            known, saved = self._saved
            self.fleet.restore(saved, "the area came to another process")
        return [one for number in range(known + 1, len(self.lines) + 1) for one in self._handled(number)]

    @property
    def area(self) -> AreaVehicle:
        """The area."""
        found = self.fleet.vehicles["west"]
        assert isinstance(found, AreaVehicle)
        return found

    def _handled(self, number: int) -> list[Data]:
        return self.fleet.handle("west", Line(number, self.lines[number - 1]), from_start=False, only="west")


def clear(one: Data) -> list[int]:
    """The sections (from 1) that a report of the area tells as clear."""
    return [n for n in range(1, END_MM // SECTION_MM + 1) if one["outputs"][f"section_{n}.clear"]]
