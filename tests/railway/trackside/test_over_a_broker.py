"""Two vehicles and one area over mosquitto: their processes are killed, and no section is told clear over a vehicle."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from safeloc.models.area import AreaConfig
from safeloc.models.sections import SectionsConfig
from safeloc.railway.trackside.area_fleet import AreaFleet, VehicleReports
from safeloc.railway.trackside.wiring import load_wiring
from safeloc.runtime.embedding import Program
from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.division import Division
from safeloc.runtime.service.broker.settings import Broker as Settings
from safeloc.runtime.service.broker.topics import Topics
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.shipped_machines import ENTRIES
from tests.runtime.embedding.driving import STEP_MM
from tests.runtime.service.broker.mosquitto import Broker, Gateway, broker, gateway, messages, needs_mosquitto
from tests.runtime.service.broker.workers import Worker, turn_for, turn_until
from tests.runtime.service.processes import Data, numbered

pytestmark = needs_mosquitto
KEY = b"0123456789abcdef0123456789abcdef"
CYCLES, PERIOD_MS, LENGTH_MM, GAP_MM = 220, 100, 20_000, 70_000
LOW_MM, HIGH_MM, SECTION_MM = 300_000, 500_000, 50_000
BEHIND_MM = {"a": 0, "b": GAP_MM}
WIRING = f"""
fleet = "fleet"
partitions = 4
clock_error_ms = 20
vehicles.a = {{ length_mm = {LENGTH_MM}, faces_upwards = true }}
vehicles.b = {{ length_mm = {LENGTH_MM}, faces_upwards = true }}

[areas.west]
low_end_mm = {LOW_MM}
high_end_mm = {HIGH_MM}
sections_mm = [[300_000, 350_000], [350_000, 400_000], [400_000, 450_000], [450_000, 500_000]]
inner_mm = [[300_000, 399_999], [400_000, 500_000]]
"""


@cache
def config() -> SectionsConfig:
    """Four sections, and cycles of the vehicles' length."""
    area = AreaConfig(
        trains=2, period_ms=PERIOD_MS, borders="occupancy", inner_detection=2, entry_report_delay_ms=1_000
    )
    return SectionsConfig(area=area, sections=4)


@cache
def program() -> Program:
    """Compiled once."""
    return Program(ENTRIES["sections"].make(config()))


class Areas:
    """The prefix of the areas on the broker."""

    def __init__(self, there: Broker) -> None:
        self.url = there.url.replace("/fleet", "/areas")


class AreaWorker(Worker):
    """A process of the areas, turned by hand: what `safeloc run sections --trackside` does."""

    def __init__(self, there: Broker, folder: Path) -> None:
        program()
        (folder / "areas.toml").write_text(WIRING, encoding="utf-8")
        self._wiring = load_wiring(folder / "areas.toml", config())
        super().__init__(Areas(there), folder, lease_ms=3_000, code_key_file="report.key")

    def _divided(self, broker: Settings, folder: Path) -> Division:
        assert broker.codes is not None
        self._codes = broker.codes
        return Division(
            broker, folder, "sections", self._station, self.journal, VehicleReports(self._wiring, broker.partitions)
        )

    def _fleet(self) -> Fleet:
        return AreaFleet(program(), FleetSettings(PERIOD_MS), self._wiring, self._codes, Topics("areas", 4))


def drive(name: str) -> list[bytes]:
    """The messages of a vehicle, one for each cycle; `b` runs behind `a`."""
    made: list[str] = []
    for text in numbered(CYCLES, name):
        fields: dict[str, Any] = json.loads(text)
        if "position_mm" in fields:
            fields["position_mm"] -= BEHIND_MM[name]
        made.append(json.dumps(fields) + "\n")
    return messages(made)


def stretches(cycle: int) -> Iterator[tuple[int, int]]:
    """Where both trains truly are at the end of a cycle: the marker was read 310 mm before."""
    for behind_mm in BEHIND_MM.values():
        front = 250_000 + 310 + (cycle - 2) * STEP_MM - behind_mm
        yield front - LENGTH_MM, front


def free(cycle: int, low_mm: int, high_mm: int) -> bool:
    """Nobody is there."""
    return not any(low <= high_mm and high >= low_mm for low, high in stretches(cycle))


def detection(cycle: int) -> bytes:
    """What train detection says of a cycle."""
    outside = [(LOW_MM - 200_000, LOW_MM), (HIGH_MM, HIGH_MM + 200_000)]
    low, high = (all(free(one, *side) for one in (cycle - 1, cycle)) for side in outside)
    found = {
        "counters_healthy": True, "counters_clear": free(cycle, LOW_MM, HIGH_MM), "low_side_clear": low,
        "high_side_clear": high, "inner_1_clear": free(cycle, LOW_MM, 399_999), "inner_2_clear": free(cycle, 400_000, HIGH_MM),
    }  # fmt: skip
    named = {f"area.{name}": value for name, value in found.items()}
    text = json.dumps({"vehicle": "west", "number": cycle, "cycle": cycle, **named}).encode()
    return Codes(KEY).added(Topics("areas", 4).record("west"), text)


def wrong(one: Data) -> list[str]:
    """Sections that a report tells as clear, over a train."""
    cycle, found = one["time_ms"] // PERIOD_MS, []
    for section in range(1, 5):
        low = LOW_MM + (section - 1) * SECTION_MM
        if one["outputs"][f"section_{section}.clear"] and not free(cycle, low, low + SECTION_MM):
            found.append(f"cycle {cycle}: section {section}")
    return found


def owned(worker: Worker) -> bool:
    """Each partition is its own."""
    return sorted(worker.running) == [0, 1, 2, 3]


@pytest.mark.thorough
def test_an_area_that_moves_under_two_trains(tmp_path: Path) -> None:
    """The area's process is killed with both trains coming in, and that of the vehicles after it; others go on."""
    (tmp_path / "cars").mkdir()
    (tmp_path / "report.key").write_bytes(KEY)
    (tmp_path / "cars" / "report.key").write_bytes(KEY)
    with (
        broker(tmp_path / "broker") as there,
        gateway(there.port) as cars,
        gateway(there.port, name="detection", prefix="areas") as west,
    ):
        how: dict[str, Any] = {"lease_ms": 3_000, "code_key_file": "report.key"}
        running: list[Worker] = [Worker(there, tmp_path / "cars", **how), AreaWorker(there, tmp_path)]
        turn_until(lambda: all(map(owned, running)), "owners", *running)
        said = {name: drive(name) for name in BEHIND_MM}
        for cycle in range(1, CYCLES + 1):
            for name, texts in said.items():
                cars.send(name, texts[cycle - 1])
            west.send("west", detection(cycle))
            turn_for(0.008, *running)
            if cycle in (70, 110, 150):
                _replace(there, tmp_path, running, which=0 if cycle == 110 else 1, how=how)
        turn_until(lambda: CYCLES in {one["time_ms"] // PERIOD_MS for one in west.reports}, "reports", *running)
        for one in running:
            one.stop()
    _judge(west)


def _replace(there: Broker, folder: Path, running: list[Worker], *, which: int, how: dict[str, Any]) -> None:
    """Kill a process; another one goes on."""
    running[which].kill()
    running[which] = Worker(there, folder / "cars", **how) if which == 0 else AreaWorker(there, folder)
    turn_until(lambda: owned(running[which]), "taken over", *running)


def _judge(west: Gateway) -> None:
    assert {one["time_ms"] // PERIOD_MS for one in west.reports} == set(range(1, CYCLES + 1))
    assert [] == [each for one in west.reports for each in wrong(one)]
    assert not any("anew" in one or one.get("rejections") for one in west.reports)
    late = [one for one in west.reports if one["time_ms"] > 160 * PERIOD_MS]  # after the last process was killed
    assert late[-1]["trains"] == {"1": "a", "2": "b"}
    for slot in (1, 2):
        assert any(one["outputs"][f"area.train_{slot}_accepted"] for one in late)
    told = {tuple(one["outputs"][f"section_{n}.clear"] for n in range(1, 5)) for one in west.reports}
    assert (False, False, True, True) in told or (False, True, True, True) in told
