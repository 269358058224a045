"""A controller that judges the assumptions: a breach is named in its cycle, and the machine does what it does anyway."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace

import pytest

from safeloc.errors import SnapshotError
from safeloc.runtime.embedding import Controller, Report
from safeloc.runtime.embedding.snapshot import opened, sealed
from safeloc.runtime.source_clocks import ONE_CLOCK
from safeloc.runtime.streams.records import DistanceRecord, Record
from tests.runtime.embedding.driving import ENDS, PERIOD_MS, STEP_MM, drive, shipped, trusting

FRONT_WHEEL = "odometry: front_wheel obeys its error law"
LEAST_MM, SLOWER_MM = 300, 50


def sliding(cycles: int, first: int = 1) -> Iterator[list[Record]]:
    """The front wheel slides ever more from the beginning: slowly, so that each distance can have been run."""
    for cycle in range(first, first + cycles):
        slid = max(LEAST_MM, STEP_MM - SLOWER_MM * cycle)
        yield [
            DistanceRecord(
                time_ms=cycle * PERIOD_MS, end=end, unit=unit, distance_mm=slid if (end, unit) == ("front", "wheel") else STEP_MM
            )
            for end in ENDS
            for unit in ("wheel", "radar")
        ]  # fmt: skip


def watching(*, assumptions: bool = True) -> Controller:
    """A controller of the odometry machine."""
    return Controller(trusting(), assumptions=assumptions)


def broken(report: Report) -> list[list[str]]:
    """The laws of each breach, by name."""
    return [[str(law) for law in breach.laws] for breach in report.breaches]


def test_a_lawful_drive_has_no_breach() -> None:
    """Markers are read, and all units agree."""
    controller = watching()
    assert all(not controller.step(records).breaches for records in drive(120))


def test_a_slide_is_named_in_its_cycle() -> None:
    """The unit that slides is in every pair that is told; what the machine does and reports is the same without the watch."""
    watched, plain = watching(), watching(assumptions=False)
    reports = [(watched.step(records), plain.step(records)) for records in sliding(40)]
    assert all(replace(one, breaches=()) == other for one, other in reports)
    found = [one for one, _ in reports if one.breaches]
    assert found and all(FRONT_WHEEL in laws for one in found for laws in broken(one))
    first = found[0].breaches[0]
    assert first.distance is not None and first.distance < 0 and first.unit == "nm"
    assert first.values["front_wheel_mm"] == max(LEAST_MM, STEP_MM - SLOWER_MM * found[0].cycle)
    assert f"law broken: {FRONT_WHEEL} (supplier) or " in found[0].words()
    (told, *_) = found[0].as_data()["assumptions_broken"]
    assert {"machine": "odometry", "name": "front_wheel obeys its error law", "owner": "supplier"} in told["laws"]
    assert "assumptions_broken" not in reports[0][0].as_data()


def test_what_was_summed_up_is_in_the_snapshot() -> None:
    """Restored in the middle of a slide, the breach comes in the same cycle."""
    whole, rest = watching(), watching()
    for records in sliding(10):
        whole.step(records)
    rest.restore(whole.snapshot())
    told = [(whole.step(records), rest.step(records)) for records in sliding(20, 11)]
    assert all(one == other for one, other in told)
    assert any(one.breaches for one, _ in told)
    assert whole.snapshot() == rest.snapshot()


def test_without_what_was_summed_up_nothing_is_judged_until_the_machine_begins_anew() -> None:
    """A snapshot of a controller that judged nothing does not say what was heard before."""
    plain, rest = watching(assumptions=False), watching()
    for records in sliding(10):
        plain.step(records)
    assert b"observed" not in plain.snapshot()
    rest.restore(plain.snapshot())
    assert not any(rest.step(records).breaches for records in sliding(30, 11))
    rest.begin_anew("a test")
    assert any(rest.step(records).breaches for records in sliding(40, 41))


def test_a_snapshot_with_other_sums_is_refused() -> None:
    """A checksum that fits values that do not was not made by this program."""
    controller = watching()
    for records in sliding(3):
        controller.step(records)
    body = opened(controller.snapshot())
    for observed in ({"nothing": 1}, dict.fromkeys(body["observed"], -1)):
        wrong = {key: value for key, value in body.items() if key not in ("kind", "version")}
        with pytest.raises(SnapshotError, match=r"^the snapshot's state (has other variables|does not fit)"):
            controller.restore(sealed({**wrong, "observed": observed}))


def test_a_source_with_another_clock_is_named() -> None:
    """Its records come a cycle after another source has told a later time; the record is refused, and the law named."""
    controller = watching()
    late: list[Report] = []
    for cycle in range(1, 8):
        end_ms = cycle * PERIOD_MS
        said: list[Record] = [
            DistanceRecord(time_ms=end_ms, end="front", unit="wheel", distance_mm=STEP_MM),
            DistanceRecord(time_ms=end_ms - (130 if cycle > 4 else 0), end="rear", unit="radar", distance_mm=STEP_MM),
        ]
        late.append(controller.step(said))
    assert [[], [], [], [], [], [[f"border: {ONE_CLOCK}"]], [[f"border: {ONE_CLOCK}"]]] == [broken(one) for one in late]
    (breach,) = late[-1].breaches
    assert (-31, "ms") == (breach.distance, breach.unit)
    assert {"source": "rear_radar", "behind": "front_wheel", "lag_ms": 130} == breach.values
    assert json.loads(json.dumps(late[-1].as_data()))["assumptions_broken"][0]["distance"] == -31


def test_a_repeated_record_is_no_other_clock() -> None:
    """What a source says again is refused for its order, and its clock is not in doubt."""
    controller = watching()
    reports = [controller.step([*records, *next(drive(1))]) for records in drive(5)]
    assert reports[-1].rejections and not any(report.breaches for report in reports)


def test_two_sources_that_exclude_each_other_are_named() -> None:
    """In a composition of them or alone: no interval holds the truth of both."""
    program = shipped("arbitration")
    said = {f"{name}_valid": False for name in ("odometry", "reflector", "satellite", "fibre", "balise")}
    numbers = {name: 0 for name, entry in program.entries.items() if entry.kind is int and entry.present_at is None}
    apart = {"balise_valid": True, "balise_position_mm": 9_000, "fibre_valid": True, "fibre_margin_below_mm": 10}
    needed = {name: False for name, entry in program.entries.items() if entry.kind is bool}
    labels = {name: next(iter(entry.members)) for name, entry in program.entries.items() if entry.members}
    controller = Controller(program, period_ms=100, assumptions=True)
    report = controller.step_inputs({**needed, **numbers, **labels, **said, **apart})
    assert [["arbitration: balise holds the truth", "arbitration: fibre holds the truth"]] == broken(report)
    assert [(-9_000_000_000, "nm")] == [(one.distance, one.unit) for one in report.breaches]
