"""No section is told clear over a vehicle, whatever happens to reports on their way, and wherever the area moves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from safeloc.errors import InputError, SnapshotError
from safeloc.railway.trackside import area_fleet, seen
from safeloc.railway.trackside.area_fleet import VehicleReports
from safeloc.railway.trackside.trains import Trains
from safeloc.railway.trackside.wiring import VehicleWiring
from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.topics import partition_of
from tests.railway.trackside.areas import (
    CODES,
    LENGTHS_MM,
    OF_AREAS,
    Data,
    Process,
    clear,
    report,
    topic_of,
    wired,
    wiring_text,
)
from tests.railway.trackside.traffic import TROUBLES, Drive

CYCLES = 120


def driven(
    folder: Path, seed: int, *, upwards: bool = True, troubles: tuple[str, ...] = TROUBLES, **more: Any
) -> Drive:
    """A drive to its end."""
    made = Drive(Process(wired(folder, wiring_text(faces_upwards=upwards))), seed, upwards, troubles, **more)
    made.run(CYCLES)
    return made


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("upwards", [True, False], ids=["upwards", "downwards"])
def test_reports_that_come_as_they_should(tmp_path: Path, upwards: bool) -> None:
    """Trains get slots, sections ahead and behind are clear, and none of them over a vehicle."""
    drives = [driven(tmp_path, seed, upwards=upwards, troubles=(), kills=False) for seed in range(4)]
    assert [] == [one for drive in drives for one in drive.wrong]
    assert min(drive.admitted for drive in drives) > 0
    assert sum(drive.clear_told for drive in drives) > CYCLES


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("upwards", [True, False], ids=["upwards", "downwards"])
@pytest.mark.parametrize("trouble", TROUBLES)
def test_reports_in_trouble(tmp_path: Path, trouble: str, upwards: bool) -> None:
    """Late, lost, repeated, foreign, damaged, changed, or without a code; and the area is moved in between."""
    drives = [driven(tmp_path, seed, upwards=upwards, troubles=(trouble,)) for seed in range(2)]
    assert [] == [one for drive in drives for one in drive.wrong]


@pytest.mark.thorough
def test_all_troubles_together(tmp_path: Path) -> None:
    """The same with everything at once, many times."""
    for upwards in (True, False):
        drives = [driven(tmp_path, seed, upwards=upwards) for seed in range(100, 130)]
        assert [] == [one for drive in drives for one in drive.wrong]
        assert sum(drive.clear_told for drive in drives) > CYCLES


def _ageless(self: Trains, seen: seen.Seen, end_ms: int) -> int:
    del self, seen, end_ms
    return 0


def _anywhere(self: Trains, one: Any, side: int, end_ms: int) -> bool:
    del end_ms
    return one.vehicle not in self.slots.values() and one.wiring.faces_upwards is (side == 0)


def _unopened(_self: Codes, _topic: str, payload: bytes) -> bytes:
    return payload[: payload.index(b', "code"')] + b"}" if b', "code"' in payload else payload


def _of_anybody(_vehicle: str, payload: bytes, wiring: VehicleWiring) -> seen.Seen:
    return seen.read_report(json.loads(payload)["vehicle"], payload, wiring)


WRONG: dict[str, tuple[dict[tuple[object, str], object], int, Data]] = {
    "age does not count": ({(Trains, "_age_ms"): _ageless}, 9, {"troubles": ("late",), "kills": False}),
    "codes are not looked at": (
        {(Codes, "opened"): _unopened}, 27, {"troubles": ("shifted",), "kills": False},
    ),
    "reports are anybody's": (
        {(Codes, "opened"): _unopened, (area_fleet, "read_report"): _of_anybody}, 2,
        {"troubles": ("foreign",), "kills": False, "per_cent": 60},
    ),
    "a slot wherever the vehicle is": ({(Trains, "_comes_in"): _anywhere}, 37, {"troubles": ("lost",), "per_cent": 97}),
}  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_process_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, wrong: str) -> None:
    """The drives are hard enough: the process is right in this one, and without one of its protections it tells a clear section
    over a vehicle."""
    instead, seed, how = WRONG[wrong]
    assert driven(tmp_path, seed, **how).wrong == []
    for (where, name), other in instead.items():
        monkeypatch.setattr(where, name, other)
    assert driven(tmp_path, seed, **how).wrong != []


def test_a_train_gets_its_slot_and_keeps_it(tmp_path: Path) -> None:
    """It is told in the first cycle in which detection is occupied; sections ahead of it stay clear; the next owner knows it."""
    process = came_in(tmp_path)
    assert process.area._trains.slots == {1: "a"}
    process.save()
    told = process.move() + process.detect(10_003, **OCCUPIED)
    assert told[-1]["trains"] == {"1": "a"}
    assert clear(told[-1]) == [2, 3, 4, 5, 6]


EMPTY = {
    "counters_clear": True,
    "low_side_clear": False,
    "high_side_clear": True,
    "inner_1_clear": True,
    "inner_2_clear": True,
}
OCCUPIED = {**EMPTY, "counters_clear": False, "inner_1_clear": False}


def came_in(folder: Path) -> Process:
    """An area into which train `a` came in cycle 10 002, seen outside before."""
    process = Process(wired(folder))
    process.detect(10_000, **EMPTY)
    process.hear("a", report("a", 10_000_900, -30_000, -28_000))
    process.detect(10_001, **EMPTY)
    process.hear("a", report("a", 10_001_950, 5_000, 7_000))
    process.detect(10_002, **OCCUPIED)
    return process


def test_a_vehicle_that_vanishes(tmp_path: Path) -> None:
    """Its bounds run on at top speed: one section after the other is not clear any more, and none comes back."""
    process = came_in(tmp_path)
    before = clear(process.detect(10_003, **OCCUPIED)[-1])
    for cycle in range(10_004, 10_100):
        now = clear(process.detect(cycle, **OCCUPIED)[-1])
        assert set(now) <= set(before)
        before = now
    assert before == [5, 6]  # detection inside the area still holds it back


REFUSED = {
    "its code does not fit": report("a", 10_002_950, 25_000, 27_000).replace(b"25000", b"25001"),
    "was changed": report("a", 10_002_950, 25_000, 27_000)[:-5],
    "is another's": report("b", 10_002_950, 25_000, 27_000),
    "too old": report("b", 9_000_000, 25_000, 27_000),
    "ahead of the clock": report("a", 20_000_000, 25_000, 27_000),
    "repeated": report("a", 10_001_950, 25_000, 27_000),
    "two places in order": report("a", 10_002_950, 27_000, 25_000),
}


@pytest.mark.parametrize("why", REFUSED)
def test_what_is_refused_is_told_once(tmp_path: Path, why: str) -> None:
    """A report that is none says why, not with each of them, and a good one after it is used."""
    process = came_in(tmp_path)
    about = "b" if why == "too old" else "a"  # of `a` a newer one is known
    [event] = process.hear(about, REFUSED[why])
    assert (event["vehicle"], event["event"], event["train"]) == ("west", "report refused", about)
    assert why in event["reason"]
    assert process.hear(about, REFUSED[why]) == []
    assert process.detect(10_003, **OCCUPIED)[-1]["outputs"]["area.train_1_accepted"] is False
    assert process.hear("a", report("a", 10_003_950, 25_000, 27_000)) == []
    assert process.detect(10_004, **OCCUPIED)[-1]["outputs"]["area.train_1_accepted"] is True


def test_a_report_counts_once(tmp_path: Path) -> None:
    """The retained one, and the same again from another process of the vehicle's fleet, do not make it fresh."""
    process = came_in(tmp_path)
    said = report("a", 10_002_950, 25_000, 27_000)
    process.hear("a", said)
    assert process.detect(10_003, **OCCUPIED)[-1]["outputs"]["area.train_1_accepted"] is True
    process.hear("a", said)
    assert process.detect(10_004, **OCCUPIED)[-1]["outputs"]["area.train_1_accepted"] is False


def test_detection_does_not_speak_for_trains(tmp_path: Path) -> None:
    """A line that gives inputs of a train costs the cycle, and no section is clear after it."""
    process = came_in(tmp_path)
    told = process.detect(10_003, **OCCUPIED, train_1_trusted=True)
    assert "comes from the reports of vehicles" in told[0]["reason"]
    assert clear(told[-1]) == []


def test_silence_of_detection_withdraws_all(tmp_path: Path) -> None:
    """After the longest gap no section is clear; afterwards the area goes on."""
    process = came_in(tmp_path)
    told = process.fleet.withdraw("west", "it ended no cycle")
    assert clear(told[-1]) == []
    assert told[-1]["trains"] == {}
    assert process.fleet.withdrew
    assert process.fleet.withdraw("west", "again") == []
    assert clear(process.detect(10_003, **OCCUPIED)[-1]) == [5, 6]  # by detection inside the area alone
    assert clear(process.detect(10_004, **EMPTY)[-1]) == [1, 2, 3, 4, 5, 6]


@pytest.mark.parametrize("flaw", [{"slots": {"x": "a"}}, {"slots": {"1": 2}}, {"last": {"a": -1}}, {"more": 1}])
def test_a_snapshot_with_wrong_trains(tmp_path: Path, flaw: Data) -> None:
    """It is refused as any other wrong field."""
    process = came_in(tmp_path)
    process.save()
    assert process._saved is not None
    saved = json.loads(json.dumps(process._saved[1]))
    saved["west"]["trains"] |= flaw
    with pytest.raises(SnapshotError, match="vehicle west: a field of the snapshot is wrong"):
        Process(wired(tmp_path)).fleet.restore(saved)


def test_a_clock_that_was_set(tmp_path: Path) -> None:
    """Detection on another day: the area begins anew, with no section clear, and does not stop for good."""
    process = came_in(tmp_path)
    told = [one for cycle in range(500_000, 500_012) for one in process.detect(cycle, **EMPTY)]
    anew = next(one for one in told if "anew" in one)
    assert clear(anew) == []
    assert clear(process.detect(500_012, **EMPTY)[-1]) == [1, 2, 3, 4, 5, 6]


def test_an_area_that_is_not_wired(tmp_path: Path) -> None:
    """Its lines are refused; a snapshot of one is not dropped in silence."""
    process = came_in(tmp_path)
    process.save()
    other = Process(wired(tmp_path, wiring_text().replace("areas.west", "areas.east")))
    assert "no area of this name" in other.detect(10_000, **EMPTY)[0]["reason"]
    assert process._saved is not None
    with pytest.raises(InputError, match=r"area west of the snapshot is not in .*areas\.toml"):
        other.fleet.restore(process._saved[1])


def test_a_defect_costs_the_area_its_trains(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An exception in what is made of a report: the area begins anew, and goes on."""
    process = came_in(tmp_path)

    def broken(*_: object) -> str:
        raise KeyError("a defect")

    with monkeypatch.context() as patched:
        patched.setattr(Trains, "hear", broken)
        told = process.hear("a", report("a", 10_002_950, 25_000, 27_000))
    assert [one.get("event") for one in told] == ["failed", None]
    assert clear(told[-1]) == []
    process.detect(10_003, **EMPTY)
    assert clear(process.detect(10_004, **EMPTY)[-1]) == [1, 2, 3, 4, 5, 6]


def test_who_listens_to_whom(tmp_path: Path) -> None:
    """The partition of an area subscribes to the reports of its vehicles; other topics are about nobody."""
    reports = VehicleReports(wired(tmp_path), 2)
    own = partition_of("west", 2)
    assert set(reports.topics(own)) == {topic_of(one) for one in LENGTHS_MM}
    assert list(reports.topics(1 - own)) == []
    assert reports.about(topic_of("a")) == "a"
    assert reports.about("fleet/reports/0/nobody") is None


@pytest.mark.parametrize("damage", ["changed", "of another area", "without a code", "no line"])
def test_lines_of_detection_have_a_code(tmp_path: Path, damage: str) -> None:
    """One that does not fit costs its cycle and the one after it: then only detection inside the area shows what is clear."""
    process = came_in(tmp_path)
    good = json.dumps(
        {"vehicle": "west", "number": 4, "cycle": 10_003, **{f"area.{k}": v for k, v in EMPTY.items()}}
    ).encode()
    bad = {
        "changed": CODES.added(OF_AREAS.record("west"), good).replace(b"10003", b"10004"),
        "of another area": CODES.added(OF_AREAS.record("east"), good),
        "without a code": good,
        "no line": b"{",
    }
    [refused] = process.say(bad[damage])
    assert "its code does not fit" in refused["reason"]
    told = [one for one in process.detect(10_004, **OCCUPIED) if "mode" in one]
    assert [clear(one) for one in told] == [[], [5, 6]]
