"""Real trains over the real network: clean logs are believed and held, false fixes narrow nothing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.errors import StreamError
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import Enumeration
from safeloc.models import odometry
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.railway.map.recorded_run import (
    Columns,
    OnRoute,
    Reading,
    Trust,
    balise_records,
    in_order,
    odometer_records,
    read_fixes,
    satellite_records,
    trusted_times,
    truth_records,
)
from safeloc.runtime.border import channels_of
from safeloc.runtime.streams.cycles import Cycle, cycles
from safeloc.runtime.streams.records import MarkerRecord
from tests.railway.map.recorded_trains import equipped, fixes_of, route_of

PERIOD_MS = 400
LENGTH_MM = 100_000
TRUST = Trust(offset_limit_mm=15_000, max_speed_mm_s=44_445)
FALSE_MM = 50_000
"""Beyond this off the track a fix is false, not merely coarse: in the faulty log there is nothing between 30 and 76 m."""
SPACING_MM = 250_000
FIRST_FIX = 500_000
CLAIMED = {"NARROW_INT3": 1_000, "PROPAGATED": 5_000, "SINGLE": 10_000}
"""What each quality flag claims; the narrow one is false by 86 to 200 m."""

CONFIG = OdometryConfig(period_ms=PERIOD_MS, reader_latency_ms=0, vehicle_length_mm=LENGTH_MM, trust_first_marker=True)
MACHINE = odometry.machine(CONFIG)
REJECTED = {
    "MALFORMED",
    "FOREIGN",
    "REPEATED",
    "OUT_OF_ORDER",
    "UNPAIRED",
    "UNCONFIRMED",
    "TOO_COARSE",
    "OUT_OF_WINDOW",
}


@dataclass(frozen=True)
class Step:
    """One cycle: what came in, and what the machine said of it."""

    cycle: Cycle
    state: Mapping[str, Value]
    outputs: Mapping[str, Value]

    def label(self, name: str) -> str:
        """An enumerated state variable as its member."""
        unit = code().system.variable(name).unit
        assert isinstance(unit, Enumeration)
        return unit.members[int(self.state[name])]

    @property
    def margin(self) -> int:
        """The greater side, in mm."""
        return max(int(self.outputs["margin_above_mm"]), int(self.outputs["margin_below_mm"]))

    def holds(self, position_mm: int) -> bool:
        """Whether the reported interval holds the position."""
        centre = int(self.outputs["position_mm"])
        return (
            centre - int(self.outputs["margin_below_mm"])
            <= position_mm
            <= centre + int(self.outputs["margin_above_mm"])
        )


@cache
def code() -> Compiled:
    """What runs on board."""
    return compile_system(without_ghosts(lower(MACHINE)))


HOW = Reading(length_mm=LENGTH_MM, accuracy_mm=1_000)


@cache
def times_of(log: str) -> frozenset[int]:
    """Where map and motion trust the log."""
    return trusted_times(fixes_of(log), TRUST)


@cache
def driven(log: str, satellites: bool = False, ask_the_map: bool = True) -> tuple[Step, ...]:
    """The log over its way: wheels measure from fix to fix, radars along the track, readers pass the balises."""
    fixes, route = fixes_of(log), equipped(log, SPACING_MM)
    trusted = times_of(log)
    among = trusted if ask_the_map else None
    records = in_order(
        balise_records(fixes, route, HOW, trusted),
        satellite_records(fixes, CLAIMED, FIRST_FIX, among) if satellites else (),
        odometer_records(fixes, along="radar", straight="wheel"),
        truth_records(fixes, trusted),
    )
    return tuple(_steps(list(cycles(records, PERIOD_MS, channels=channels_of(MACHINE, PERIOD_MS)))))


def _steps(run: Sequence[Cycle]) -> list[Step]:
    board = code()
    state, steps = board.first(), []
    for cycle in run:
        state, _ = board.step(state, board.read(cycle.inputs))
        steps.append(Step(cycle, dict(zip(board.state_names, state, strict=True)), board.named_outputs(state)))
    return steps


def judged(steps: Sequence[Step]) -> set[str]:
    """Every verdict on a distance."""
    units = [f"{end}_{unit}_last_verdict" for end in ("front", "rear") for unit in ("wheel", "radar")]
    return {step.label(unit) for step in steps for unit in units}


def readings(steps: Sequence[Step]) -> set[str]:
    """Every verdict on a marker."""
    return {step.label(f"{end}_reading") for step in steps for end in ("front", "rear")}


def wrong(steps: Sequence[Step]) -> int:
    """Cycles whose valid interval misses the projected position."""
    told = [step for step in steps if step.outputs["valid"] and "truth_mm" in step.cycle.remarks]
    return sum(not step.holds(step.cycle.remarks["truth_mm"]) for step in told)


# ------------------------------------------------------------------ clean runs


@pytest.mark.parametrize(("log", "cycles_", "balises"), [("28876", 1_131, 22), ("31176", 713, 17)])
def test_clean_logs_are_believed_and_held(log: str, cycles_: int, balises: int) -> None:
    """Nothing is rejected, and from the first balise on the interval is valid and holds the projected position."""
    steps = driven(log)
    assert cycles_ == len(steps)
    assert [] == [fault for step in steps for fault in step.cycle.faults]
    assert {"ADMITTED"} == judged(steps)
    assert set() == readings(steps) & REJECTED
    read = [step for step in steps if step.label("front_reading") == "ACCEPTED"]
    assert balises == len(read)
    located = steps[steps.index(read[0]) :]
    assert all(step.outputs["valid"] for step in located)
    assert 0 == wrong(steps)


@pytest.mark.parametrize("log", ["28876", "31176"])
def test_the_interval_is_no_wider_than_the_layout_needs(log: str) -> None:
    """A balise every 250 m keeps the interval within 14 m; without the balises it would reach the tolerance, 30 m."""
    widths = [step.margin for step in driven(log) if step.outputs["valid"]]
    assert 6_000 <= min(widths)
    assert max(widths) <= 14_000


@pytest.mark.parametrize(("log", "median_mm", "most_mm"), [("28876", 1_685, 3_291), ("31176", 1_239, 6_234)])
def test_clean_logs_lie_on_the_track(log: str, median_mm: int, most_mm: int) -> None:
    """The receiver's distance off the track, over all fixes."""
    offsets = sorted(abs(fix.offset_mm) for fix in fixes_of(log))
    assert (median_mm, most_mm) == (offsets[len(offsets) // 2], offsets[-1])


# ------------------------------------------------------------------ the mild and the faulty run


def test_the_mild_log_is_held() -> None:
    """A few distances are rejected, some fixes lie 31 m off the track; where it can be told the interval holds."""
    steps = driven("31259")
    assert {"ADMITTED", "JUMP"} == judged(steps)
    assert 5 == sum(step.label("front_wheel_last_verdict") == "JUMP" for step in steps)
    assert 0 == wrong(steps)
    assert sum(bool(step.outputs["valid"]) for step in steps) > 500


def test_the_faulty_log_never_moves_the_interval_off_the_track() -> None:
    """Fixes up to 200 m off the track are no markers; jumps of distance are refused with a reason; nothing is wrong."""
    steps = driven("29083", satellites=True)
    assert {"ADMITTED", "JUMP", "TOO_FAST", "MISSING"} == judged(steps)
    assert {"OUT_OF_RANGE"} <= {fault.reason.name for step in steps for fault in step.cycle.faults}
    assert 0 == wrong(steps)
    assert sum(bool(step.outputs["valid"]) for step in steps) > 500


def false_times() -> set[int]:
    """When the faulty receiver was off the track by more than any coarse fix is."""
    found = {fix.time_ms for fix in fixes_of("29083") if abs(fix.offset_mm) > FALSE_MM}
    assert 271 == len(found)
    return found


def test_no_false_fix_narrows_the_interval() -> None:
    """Wherever the faulty log's interval becomes narrower, a reading on the track was accepted in that cycle."""
    steps = driven("29083", satellites=True)
    false = false_times()
    narrowed = 0
    for before, after in pairwise(steps):
        if before.outputs["valid"] and after.outputs["valid"] and after.margin < before.margin:
            narrowed += 1
            assert after.label("front_reading") == "ACCEPTED" or after.label("rear_reading") == "ACCEPTED"
            assert after.cycle.end_ms not in false
    assert narrowed >= 10


def test_the_map_is_what_keeps_false_fixes_out() -> None:
    """Without it the faulty receiver's own flags are believed, false fixes agree among themselves, and it goes wrong."""
    assert wrong(driven("29083", satellites=True, ask_the_map=False)) > 20


def test_a_located_train_refuses_the_first_false_fix() -> None:
    """By motion alone: 78 m ahead within one cycle. The position is rather given up than moved there."""
    steps = driven("29083", satellites=True, ask_the_map=False)
    false = false_times()
    first = next(i for i, step in enumerate(steps) if step.cycle.end_ms in false)
    assert steps[first].cycle.inputs["front_marker_position_mm"] == 734_520
    assert steps[first - 1].outputs["valid"]
    assert steps[first].label("front_reading") in REJECTED
    assert not steps[first].outputs["valid"]


def test_flags_do_not_bound_the_error() -> None:
    """Of the fixes that claim the best quality every one is more than 80 m off the track."""
    narrow = [abs(fix.offset_mm) for fix in fixes_of("29083") if fix.status == "NARROW_INT3"]
    assert 148 == len(narrow)
    assert min(narrow) > 80_000


# ------------------------------------------------------------------ records


def test_readings_are_where_the_ends_pass() -> None:
    """The front reads a group when the fix passes it, the rear one a vehicle length later; `since` leads back to it."""
    fixes = fixes_of("28876")
    found = list(balise_records(fixes, equipped("28876", SPACING_MM), HOW, times_of("28876")))
    at = {fix.time_ms: fix.position_mm for fix in fixes}
    behind = {"front": 0, "rear": LENGTH_MM}
    assert {"front", "rear"} == {record.end for record in found}
    for record in found:
        assert record.position_mm is not None and record.since_mm is not None
        assert at[record.time_ms] == record.position_mm + behind[record.end] + record.since_mm
    assert 22 == len({record.marker for record in found})


def test_a_balise_between_untrusted_fixes_is_not_read() -> None:
    """A jump over a group is no reading of it."""
    fixes = (OnRoute(0, 0, 0, None, ""), OnRoute(400, 300_000, 90_000, 300_000, ""))
    route = equipped("28876", SPACING_MM)
    assert [] == list(balise_records(fixes, route, HOW, trusted_times(fixes, TRUST)))
    near = (fixes[0], OnRoute(400, 300_000, 0, 300_000, ""))
    assert 1 == len([one for one in balise_records(near, route, HOW, {0, 400}) if one.end == "front"])


def test_backward_steps_are_negative_for_both_units() -> None:
    """The straight distance has no sign of its own; it takes that of the movement along the track."""
    fixes = (OnRoute(0, 10_000, 0, None, ""), OnRoute(400, 9_000, 0, 1_001, ""))
    records = list(odometer_records(fixes, along="radar", straight="wheel"))
    assert {"front_wheel": -1_001, "front_radar": -1_000, "rear_wheel": -1_001, "rear_radar": -1_000} == {
        record.channel: next(iter(record.inputs().values())) for record in records
    }


def test_one_marker_an_end_and_time() -> None:
    """Of two readings at the same end and time the first stream's is kept: balises before satellites."""
    fixes = fixes_of("28876")
    balises = list(balise_records(fixes, equipped("28876", SPACING_MM), HOW, times_of("28876")))
    both = in_order(balises, satellite_records(fixes, CLAIMED, FIRST_FIX, times_of("28876")))
    count = Counter((record.time_ms, record.channel) for record in both)
    assert {1} == set(count.values())
    kept = [record for record in both if isinstance(record, MarkerRecord) and record.marker < FIRST_FIX]
    assert sorted(map(repr, balises)) == sorted(map(repr, kept))


# ------------------------------------------------------------------ logs

LOG = "timestamp,longitude,latitude,position_type\n"
ROW = "2022-02-25T09:32:54.400,4.5,50.9,SINGLE\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,longitude\n", ":1: columns ['latitude', 'position_type', 'timestamp'] are missing"),
        (LOG, ": has no fixes."),
        (LOG + "yesterday,4.5,50.9,SINGLE\n", ":2: 'yesterday' is no time (ISO 8601)."),
        (LOG + "2022-02-25T09:32:54.400,nan,50.9,SINGLE\n", ":2: column 'longitude': 'nan' is no finite number."),
        (LOG + "2022-02-25T09:32:54.400,4.5,north,SINGLE\n", ":2: column 'latitude': 'north' is no number."),
        (LOG + "2022-02-25T09:32:54.400,4.5\n", ":2: column 'latitude': None is no number."),
        (LOG + ROW + ROW, ":3: its time is not after that of the previous fix."),
        (LOG + ROW + ROW.replace("54.400", "54.000"), ":3: its time is not after that of the previous fix."),
    ],
)
def test_what_is_no_log_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """With file and line."""
    path = tmp_path / "log.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StreamError) as refused:
        read_fixes(path)
    assert str(refused.value).startswith(f"{path}{message}")


def test_columns_are_the_users(tmp_path: Path) -> None:
    """Other names and another coordinate system."""
    path = tmp_path / "log.csv"
    path.write_text("t,e,n,q\n2022-01-01T00:00:00,1,2,A\n2022-01-01T00:00:01.5,3,4,B\n", encoding="utf-8")
    fixes = read_fixes(path, Columns(time="t", x="e", y="n", status="q", crs="EPSG:31370"))
    assert [(0, 1.0, 2.0, "A"), (1_500, 3.0, 4.0, "B")] == [(fix.time_ms, fix.x, fix.y, fix.status) for fix in fixes]


def test_the_ways_are_as_long_as_the_runs() -> None:
    """The paths that were published with the logs, over whole elements."""
    assert {"28876": 5_617_981, "31176": 5_263_319, "29083": 5_605_194} == {
        log: route_of(log).length_mm for log in ("28876", "31176", "29083")
    }
