"""The laws of the worlds on recordings: a lawful recording breaks none, and a breach is named, with the truth or
without.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.proof.verification.assumptions import AtCycle, Judged, JudgedLaw, judge_recording
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.streams.record_files import write_records
from safeloc.runtime.streams.records import DistanceRecord, TruthRecord
from safeloc.runtime.streams.steps import Cell, read_steps, write_steps

REVERSAL, _, SLIDE = load_target("odometry").streams
QUICK = ("turn_off", "verification", "emitter", "axle_section")
BROKEN = {SLIDE.name}
"""Shipped recordings of what breaks a law in a way that inputs show."""


def by_name(judged: Judged) -> Mapping[str, JudgedLaw]:
    """The results by the names of their laws."""
    return {" / ".join(map(str, one.laws)): one for one in judged.every}


def changed(path: Path, to: Path, cycle: int, **cells: int) -> Path:
    """The recording with these values in this cycle (from 1)."""
    stream = read_steps(path)
    steps: list[dict[str, Cell]] = [dict(step) for step in stream.steps]
    steps[cycle - 1] |= cells
    write_steps(to, steps, machine=stream.machine, first=stream.first)
    return to


def require_lawful(name: str) -> None:
    """Check that no shipped recording of the machine shows a breach, except the one named."""
    target = load_target(name)
    found = {path.name: judge_recording(target, path) for path in target.streams}
    assert BROKEN.intersection(found) == {name for name, judged in found.items() if judged.broken}
    assert all(one.laws and one.unjudged[-1].machine == "border" for one in found.values() if one.with_truth)


@pytest.mark.parametrize("name", QUICK)
def test_a_lawful_recording_breaks_nothing(name: str) -> None:
    """With the truth every law is checked, and beside it the conditions that inputs show."""
    require_lawful(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in ENTRIES if name not in QUICK])
def test_no_lawful_recording_breaks_anything(name: str) -> None:
    """The recordings of every other shipped machine break no law either."""
    require_lawful(name)


def test_a_breach_that_only_the_truth_shows(tmp_path: Path) -> None:
    """The vehicle truly runs back at 40 m/s in one cycle, and no unit reports it: four units are wrong together."""
    target = load_target("odometry")
    path = changed(REVERSAL, tmp_path / "run.jsonl", 300, true_cycle_distance_nm=-4_000_000_000)
    laws = by_name(judge_recording(target, path))
    broken = {name: one for name, one in laws.items() if one.breaches}
    assert {
        f"odometry: {end}_{unit} obeys its error law" for end in ("front", "rear") for unit in ("wheel", "radar")
    } <= set(broken)
    assert not any(" / " in name for name in broken)  # what units say has not changed
    wheel = broken["odometry: front_wheel obeys its error law"]
    assert [(300, False)] == [(at.cycle, at.seen) for at in wheel.breaches]
    assert ("truth", "nm", 300) == (wheel.by, wheel.unit, wheel.cycle)
    breach = wheel.breaches[0].breach
    assert wheel.least == breach.distance
    assert -10_000_000_000 < (breach.distance or 0) < -3_000_000_000
    assert -4_000_000_000 == breach.values["true_cycle_distance_nm"]


def test_a_breach_that_inputs_show_is_told_apart(tmp_path: Path) -> None:
    """A switch is reported behind the vehicle: this breach is seen without the truth."""
    target = load_target("turn_off")
    path = changed(target.streams[0], tmp_path / "run.jsonl", 20, switch_position_mm=-900_000)
    law = by_name(judge_recording(target, path))["turn_off: the map gives a switch only while it lies ahead"]
    (at,) = law.breaches
    assert ("inputs", 20, True) == (law.by, at.cycle, at.seen)
    assert law.least == at.breach.distance
    assert (at.breach.distance or 0) < 0
    assert "true_switch_mm" not in at.breach.values


def test_a_recording_and_a_controller_tell_the_same() -> None:
    """For a real slide, without the truth, both report the same laws in the same cycles with the same distances."""
    target = load_target("odometry")
    judged = judge_recording(target, SLIDE)
    told = {(at.cycle, tuple(map(str, one.laws)), at.breach.distance) for one in judged.laws for at in one.breaches}
    controller = Controller(Program(target), assumptions=True)
    known = controller.program.entries
    live = {
        (report.cycle, tuple(map(str, breach.laws)), breach.distance)
        for step in read_steps(SLIDE).steps
        for report in (controller.step_inputs({name: value for name, value in step.items() if name in known}),)
        for breach in report.breaches
    }
    assert told == live
    first = min(cycle for cycle, _, _ in told)
    assert all("odometry: front_wheel obeys its error law" in laws for cycle, laws, _ in told if cycle == first)


def test_what_a_recording_does_not_show_is_not_judged() -> None:
    """Without the truth most laws cannot be checked; they are listed, not passed over."""
    judged = judge_recording(load_target("odometry"), SLIDE)
    assert not judged.with_truth
    assert {"the readers are as far apart as configured", "stray readings are rare"} < {
        law.name for law in judged.unjudged
    }
    assert not {law.name for one in judged.laws for law in one.laws} & {law.name for law in judged.unjudged}


def test_single_records_show_the_clocks_of_their_sources(tmp_path: Path) -> None:
    """The rear radar is 130 ms behind from cycle 20 on; the recorded truth belongs to no source."""
    path = tmp_path / "records.jsonl"
    records = [
        record
        for cycle in range(1, 30)
        for record in (
            TruthRecord(time_ms=cycle * 100, position_nm=0),
            DistanceRecord(time_ms=cycle * 100, end="front", unit="wheel", distance_mm=0),
            DistanceRecord(time_ms=cycle * 100 - (130 if cycle > 20 else 10), end="rear", unit="radar", distance_mm=0),
        )
    ]
    write_records(path, records)
    judged = judge_recording(load_target("odometry"), path, period_ms=100)
    assert judged.one_clock is not None and judged.one_clock in judged.broken
    assert list(range(22, 30)) == [
        at.cycle for at in judged.one_clock.breaches
    ]  # in 21 it was said before the last one
    assert (-31, 22, "ms") == (judged.one_clock.least, judged.one_clock.cycle, judged.one_clock.unit)
    clocks = {one.source: (one.least_ms, one.greatest_ms) for one in judged.clocks}
    assert {"rear_radar": (10, 130), "front_wheel": (-230, -110)} == clocks
    assert isinstance(judged.one_clock.breaches[0], AtCycle) and judged.one_clock.breaches[0].seen
