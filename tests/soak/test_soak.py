"""The soak itself: what its fleet does, that it sees what is wrong, and some seconds of it against the real process."""

from __future__ import annotations

import json
import re
import selectors
import signal
import socket
from dataclasses import replace
from itertools import islice, pairwise
from pathlib import Path
from random import Random
from xml.etree import ElementTree as ET

import pytest

from tests.kept_lines import keep, kept_lines
from tests.soak import day
from tests.soak.__main__ import main
from tests.soak.drawing import drawn
from tests.soak.fleet import Plan
from tests.soak.judge import Bounds, growth_mib, judged
from tests.soak.mishaps import MISHAPS, SILENCE_CYCLES
from tests.soak.vehicle import Vehicle
from tests.soak.windows import Window, as_line, as_window, at_share

ANY_LOAD = ("--most-p99-ms", "1e9", "--most-waited", "1e9")
"""How fast it goes says nothing here."""

# ------------------------------------------------------------------ the day


def test_the_truth_of_a_trip_is_that_of_its_records() -> None:
    """What the wheel measures is, within its error, the way that the truth goes; after the last cycle the vehicle stands."""
    trip = day.Trip(5_000, 0, 600)
    run = trip.run
    steps = [
        step for cycle in run.records for said in cycle for step in re.findall(r'"wheel", "distance_mm": (-?\d+)', said)
    ]
    assert len(run.records) == len(run.truth_mm) >= day.TRIP_S[1]
    assert sum(map(int, steps)) == pytest.approx(run.truth_mm[-1], rel=0.05)
    assert (run.truth_mm[0], run.truth_mm[599], run.truth_mm[599]) == tuple(
        map(trip.truth_mm, (6_000, trip.end_ms, trip.end_ms + 60_000))
    )


def test_a_vehicle_pauses_longer_than_silence_adds_error() -> None:
    """So a place that outlives a pause would be a wrong one; silences within a trip are shorter."""
    pauses_s = [(later.begin_ms - earlier.end_ms) / 1_000 for earlier, later in pairwise(islice(day.trips(1, 7), 40))]
    assert min(pauses_s) > 60 > SILENCE_CYCLES[1]
    assert max(pauses_s) >= day.IN_DEPOT_S[0]


def test_about_half_of_the_fleet_drives() -> None:
    """At any time of the day."""
    for time_ms in (0, 7 * day.HOUR_MS, 23 * day.HOUR_MS):
        trips = [next(one for one in day.trips(1, vehicle) if one.end_ms > time_ms) for vehicle in range(60)]
        assert 18 <= sum(one.begin_ms <= time_ms for one in trips) <= 48


def test_lines_are_those_of_a_process() -> None:
    """Numbered, of one time, and the end of the cycle last."""
    said = [json.loads(line) for line in day.lines("v3", 7, 5_000, day.run(0).records[200])]
    assert {("v3", 5_000)} == {(one["vehicle"], one["time_ms"]) for one in said}
    assert [7, 8, 9] == [one["number"] for one in said][:3]
    assert said[-1]["kind"] == "cycle"


@pytest.mark.parametrize("name", MISHAPS)
def test_a_mishap_befalls_lines(name: str) -> None:
    """One cycle looks otherwise than it was said; a marker's time is never among it."""
    chance = Random(name)
    sound = day.lines("v3", 7, 5_000, (*day.run(0).records[200], '"kind": "marker", "end": "front", "marker": 3'))
    befallen = []
    for _ in range(20):
        befallen.append(list(sound))
        MISHAPS[name](befallen[-1], chance)
    assert any(one != sound for one in befallen)
    assert not any(b'"time_ms": 9' in line and b'"marker"' in line for one in befallen for line in one)


@pytest.mark.parametrize("name", MISHAPS)
def test_a_mishap_befalls_a_cycle_without_records(name: str) -> None:
    """Where no unit said anything there is its end alone."""
    chance = Random(name)
    for _ in range(20):
        MISHAPS[name](day.lines("v3", 7, 5_000, ()), chance)


# ------------------------------------------------------------------ what is seen


def told(low_mm: int, high_mm: int, *, time_ms: int, vehicle: str = "v0") -> str:
    """A report."""
    place = {"vehicle": vehicle, "cycle": 1, "time_ms": time_ms, "mode": {}, "interval_mm": [low_mm, high_mm]}
    return json.dumps(place) + "\n"


def test_a_wrong_report_is_seen() -> None:
    """One that misses the truth, and one of another vehicle; what holds it, or names no place, is none."""
    here, there = socket.socketpair()
    with selectors.DefaultSelector() as selector, here, there:
        vehicle, window = Vehicle(0, 1, 0, selector), Window(0, 0, 60_000)
        selector.register(here, selectors.EVENT_READ, vehicle)
        vehicle.connection = here
        time_ms = vehicle.next_ms
        truth_mm = next(one for one in day.trips(1, 0) if one.end_ms > 0).truth_mm(time_ms)
        for low_mm, high_mm, wrong in ((0, 0, 0), (-1, 5, 0), (1, 5, 1), (-5, -1, 2)):
            there.sendall(told(truth_mm + low_mm, truth_mm + high_mm, time_ms=time_ms).encode())
            vehicle.hear(window)
            assert (window.wrong, window.located) == (wrong, window.reports)
        assert window.first_wrong.startswith(f"v0: truth {truth_mm} mm, told ")
        there.sendall(told(truth_mm, truth_mm, time_ms=time_ms, vehicle="v1").encode())
        vehicle.hear(window)
        assert window.wrong == 3


def test_latencies_are_counted() -> None:
    """Within 2 %, over several windows."""
    windows = [Window(0, 0, 1), Window(1, 1, 2)]
    for number in range(1, 1_001):
        windows[number % 2].answered(number / 1_000)
    assert at_share([one.latency for one in windows], 0.5) == pytest.approx(500, rel=0.03)
    assert at_share([one.latency for one in windows], 0.99) == pytest.approx(990, rel=0.03)
    assert [one.worst_ms for one in windows] == [1_000, 999]
    assert at_share([], 0.5) == 0


def test_a_window_is_kept(tmp_path: Path) -> None:
    """Nothing of it is lost."""
    window = Window(3, 0, 60_000, life=2, failures=["x"], mishaps={"silence": 2})
    window.answered(0.004)
    keep(tmp_path / "day.jsonl", as_line(window))
    assert [window] == [as_window(line) for line in kept_lines(tmp_path / "day.jsonl")]


# ------------------------------------------------------------------ what is judged


def good_day(grows_kib: int = 0) -> list[Window]:
    """24 windows: memory fills up at first and after each start of the process."""
    made = []
    for number in range(24):
        life = 1 if number < 10 else 2
        since = number if life == 1 else number - 10
        resident_kib = 100_000 + 9_000 * min(since, 2) + grows_kib * since
        window = Window(
            number, number * day.HOUR_MS, (number + 1) * day.HOUR_MS, life, resident_kib=resident_kib, driving=90,
            reports=100, located=80,
        )  # fmt: skip
        for _ in range(100):
            window.answered(0.002)
        made.append(window)
    return made


def failed(windows: list[Window], wanted: int = 24) -> list[str]:
    """The criteria that a day does not meet, in words."""
    return [one.words for one in judged(windows, wanted, Bounds()) if not one.passed]


def test_a_good_day_passes() -> None:
    """All six criteria; memory that fills up with a start is no growth."""
    assert failed(good_day()) == []
    assert len(list(judged(good_day(), 24, Bounds()))) == 6


def test_memory_that_grows_steadily_fails() -> None:
    """12 windows of the last half at 1 MiB each; a single high window changes nothing."""
    growing, spike = good_day(1_024), good_day()
    spike[-1].resident_kib += 500_000
    assert growth_mib(growing) == pytest.approx(12)
    assert failed(growing) == ["memory grows by 12.00 MiB over the last half of the day; at most 8 MiB"]
    assert failed(spike) == []


def test_what_else_fails() -> None:
    """A wrong report, a process that failed, places that are rare, a day that is not over."""
    windows = good_day()
    windows[3].missed("v0: truth")
    windows[4].failures.append("Traceback")
    assert [words.split(" ")[0] for words in failed(windows[:-1])] == ["1", "the", "23"]
    assert failed([replace(one, located=40) for one in good_day()]) == [
        "40.0% of the reports have a place; at least 50%"
    ]


def test_latency_is_judged_where_there_were_cores() -> None:
    """Late reports of windows that had to wait for a core are no failure; late ones of others are, and so is nothing to judge."""
    busy, late, nothing = good_day(), good_day(), [replace(one, waited=0.4) for one in good_day()]
    for window in (busy[2], late[2]):
        for _ in range(100):
            window.answered(0.2)
    busy[2].waited = 0.4
    assert failed(busy) == []
    assert "in the 24 of 24 windows" in failed(late)[0]
    assert "in the 0 of 24 windows" in failed(nothing)[0]


def test_a_day_is_drawn() -> None:
    """Axes with units, and where the process was ended."""
    windows = good_day()
    windows[10].ended, windows[-1].ended = "SIGKILL", "SIGTERM"
    picture = ET.fromstring(drawn(windows))
    words = ["".join(one.itertext()) for one in picture.iter() if one.tag.endswith("text")]
    for label in (
        "memory, MiB",
        "latency, ms",
        "vehicles that drive",
        "hours of the fleet's clock",
        "kill -9",
    ):
        assert label in words
    assert "orderly restart" not in words


# ------------------------------------------------------------------ against the process


def soaked(out: Path, *arguments: str) -> int:
    """The exit code of a small soak."""
    return main(["--out", str(out), *ANY_LOAD, *arguments])


SECONDS = ("--hours-of-fleet", "0.25", "--vehicles", "5", "--wall-minutes", "0.04", "--windows", "5")


@pytest.mark.thorough
def test_some_seconds_of_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Killed and restarted on the way."""
    out = tmp_path / "day.jsonl"
    assert soaked(out, *SECONDS) == 0
    assert capsys.readouterr().out.endswith("\n6 passed, 0 failed\n")
    whole = [as_window(line) for line in kept_lines(out)]
    assert ["", signal.SIGKILL.name, signal.SIGTERM.name, "", signal.SIGTERM.name] == [one.ended for one in whole]
    assert sum(one.located for one in whole) > 500


@pytest.mark.slow
def test_an_ended_soak_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Behind its last whole window, with another life of the process."""
    out = tmp_path / "day.jsonl"
    soaked(out, *SECONDS)
    capsys.readouterr()
    whole = [as_window(line) for line in kept_lines(out)]
    text = out.read_text(encoding="utf-8").splitlines(keepends=True)
    out.write_text("".join(text[:3]) + text[3][:40], encoding="utf-8")
    assert soaked(out, *SECONDS) == 0
    assert capsys.readouterr().out.startswith(f"5 windows, 3 of them in {out};")
    assert whole[:3] == [as_window(line) for line in kept_lines(out)][:3]
    assert [4, 4] == [one["life"] for one in kept_lines(out)[3:]]


@pytest.mark.slow
def test_an_hour_of_the_fleet(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """200 vehicles: no report is wrong, most have a place, and memory stays where it is."""
    options = ("--hours-of-fleet", "1", "--vehicles", "200", "--wall-minutes", "1", "--windows", "12")
    assert soaked(tmp_path / "day.jsonl", *options) == 0
    assert "passed: 0 of " in capsys.readouterr().out


def test_windows_are_whole_cycles() -> None:
    """Whatever is asked for."""
    plan = Plan(0.1, 5, 1.0, 7, 1)
    assert (plan.window_ms % day.PERIOD_MS, plan.length_ms) == (0, 7 * plan.window_ms)
    assert plan.speed == pytest.approx(6, rel=0.05)
