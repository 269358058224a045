"""A controller is the machine and nothing else: same steps, every record accounted for, nothing remembered elsewhere."""

from __future__ import annotations

import json
import sys
import threading
import tracemalloc
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.interpret import run
from safeloc.language.system import lower
from safeloc.runtime.border import Reason
from safeloc.runtime.embedding import EVERY, Controller, Program, Report
from safeloc.runtime.embedding.controller import MOST_RECORDS
from safeloc.runtime.embedding.cycle_length import periods
from safeloc.runtime.streams.cycles import cycles
from safeloc.runtime.streams.records import DistanceRecord, MarkerRecord, TruthRecord, Unusable, ValueRecord
from safeloc.runtime.streams.steps import read_steps
from safeloc.target import Target
from tests.data.door_controller import machine as door
from tests.examples import EXAMPLES
from tests.random_machines import Record as Inputs
from tests.random_machines import first_states, streams
from tests.runtime.embedding.driving import PERIOD_MS, distances, drive, marker, shipped, trusting

SHIPPED = ("odometry", "balise", "reflector", "fibre", "sections")


def own(system_of: Any) -> Program:
    """A program of a machine without a configuration."""
    system = lower(system_of)
    return Program(Target(system.name, system.machines, system, ()))


def located() -> Controller:
    """A controller that has read its first marker."""
    controller = Controller(trusting())
    for records in drive(3):
        controller.step(records)
    assert controller.report.interval is not None
    return controller


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", SHIPPED)
def test_steps_are_the_interpreters(name: str) -> None:
    """On a shipped stream a controller takes the transitions and gives the outputs that the interpreter computes."""
    program = shipped(name)
    target, stream = program.target, read_steps(program.target.streams[0])
    kept = {var.name for var in program.system.state}
    first = {name: value for name, value in stream.first.items() if name in kept}
    controller = Controller(program, period_ms=None if periods(target.config) else PERIOD_MS, first=first)
    inputs = [{key: value for key, value in step.items() if key in program.entries} for step in stream.steps]
    expected = run(program.system, inputs, first=first).steps
    assert len(expected) > 10
    for step, wanted in zip(inputs, expected, strict=True):
        report = controller.step_inputs(step)
        assert report.values == without_absent(wanted.outputs, stand_ins(program.system))
        assert {move.name for move in report.moves} == {name for name in wanted.fired.values() if name != "(stay)"}
        assert report.rejections == ()


def test_a_position_that_is_not_valid_is_absent() -> None:
    """The position and its margins are None, and null in a line; nothing of them is 0, or a number that stands in."""
    report = Controller(shipped("odometry"), period_ms=None).step_inputs({})
    told = json.loads(json.dumps(report.as_data()))["outputs"]
    for name in ("position_mm", "margin_above_mm", "margin_below_mm"):
        assert (report.values[name], report.outputs[name], told[name]) == (None, None, None)
    assert (report.interval, report.outputs["valid"], report.outputs["reason"]) == (None, False, "NO_REFERENCE")


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: str(example.machines[0].name))
def test_any_machine_can_be_embedded(example: Any) -> None:
    """On any stream of any example machine, values and transitions agree with the interpreter."""
    system = example.system
    program = Program(Target(system.name, system.machines, system, ()))

    @settings(max_examples=10)
    @given(stream=streams(program.system, 8), first=first_states(program.system))
    def agree(stream: list[Inputs], first: Inputs) -> None:
        controller = Controller(program, period_ms=1, first=first)
        flags = {option.present.name for option in program.system.optionals}
        for record, wanted in zip(stream, run(program.system, stream, first=first).steps, strict=True):
            report = controller.step_inputs({name: value for name, value in record.items() if name not in flags})
            assert report.values == wanted.outputs
            assert [move.name for move in report.moves] == [x for x in wanted.fired.values() if x != "(stay)"]

    agree()


def test_records_make_the_cycles_that_a_replay_makes() -> None:
    """Records given cycle by cycle become the same inputs as a recording that is cut into cycles afterwards."""
    stream = [record for records in drive(120) for record in records]
    made = cycles(stream, PERIOD_MS, channels=trusting().channels)
    by_inputs, by_records = Controller(trusting()), Controller(trusting())
    for cycle, records in zip(made, drive(120), strict=True):
        assert by_records.step(records) == by_inputs.step_inputs(cycle.inputs)
    assert by_records.report.interval is not None


def test_a_report_says_it_in_words() -> None:
    """Mode, interval in metres, and what was not used."""
    report = located().step([*distances(400), marker(300)])
    assert report.words() == (
        "cycle 4 at 400 ms: FRONT; 247.073 m to 258.499 m; front_marker not used: older than the channel allows "
        "(100 ms old, 99 ms allowed)"
    )


def test_a_report_is_plain_data() -> None:
    """For JSON: modes, transitions by name, interval, labels instead of numbers; nothing that does not apply."""
    report = Controller(trusting()).step([*distances(100), marker(100)])
    data = report.as_data()
    assert data.pop("outputs") == report.outputs
    assert report.outputs["values"] == "M1"
    assert data == {
        "cycle": 1,
        "time_ms": 100,
        "mode": {"odometry": "FRONT"},
        "fired": {"odometry": "trusted marker at front"},
        "interval_mm": [report.interval.low_mm, report.interval.high_mm] if report.interval else None,
    }


def test_moves_name_their_requirements() -> None:
    """A transition comes with the modes it went between and the requirements it answers for."""
    (move,) = Controller(trusting()).step([*distances(100), marker(100)]).moves
    assert (move.source, move.target, move.requirements, move.changes_mode) == (
        "DELOCALIZED",
        "FRONT",
        ("MRK-1",),
        True,
    )


def test_every_record_is_used_or_rejected_with_its_place() -> None:
    """Late, from the future, repeated, of another machine, out of range, no measurement: each with its reason."""
    controller = located()
    said = [
        DistanceRecord(time_ms=299, end="front", unit="wheel", distance_mm=1),
        DistanceRecord(time_ms=401, end="front", unit="radar", distance_mm=1),
        marker(400),
        marker(400),
        DistanceRecord(time_ms=400, end="front", unit="laser", distance_mm=1),
        DistanceRecord(time_ms=400, end="rear", unit="wheel", distance_mm=10**9),
        Unusable(400, "rear_radar", Reason.NOT_FINITE, "distance_mm: nan"),
        Unusable(400, "laser", Reason.NOT_FINITE),
    ]
    found = [(fault.number, fault.channel, fault.reason) for fault in controller.step(said).rejections]
    assert sorted(found, key=lambda fault: (fault[0] is None, fault[0])) == [
        (0, "front_wheel", Reason.OUT_OF_ORDER),
        (1, "front_radar", Reason.FUTURE),
        (3, "front_marker", Reason.DUPLICATE),
        (4, "front_laser", Reason.UNKNOWN),
        (6, "rear_radar", Reason.NOT_FINITE),
        (7, "laser", Reason.UNKNOWN),
        (None, "rear_wheel", Reason.OUT_OF_RANGE),
    ]


def test_a_record_with_more_than_the_machine_reads_is_refused_whole() -> None:
    """A marker whose accuracy the machine has no input for would count as better than it is."""
    program = shipped("turn_off")
    said = MarkerRecord(time_ms=1, end="front", marker=3, accuracy_mm=5)
    controller = Controller(program, period_ms=1)
    with pytest.raises(InputError, match="cannot restart"):
        controller.step([said])
    assert "is missing" in controller.halted


READING = {"front_marker": 7, "front_marker_position_mm": 250_000, "front_marker_accuracy_mm": 20_000}


@pytest.mark.parametrize(
    ("more", "refused"),
    [
        ({"front_marker_accuracy_mm": 2_000_000}, {"front_marker_accuracy_mm", "front_marker"}),
        ({"front_marker_position_mm": 10**12}, {"front_marker_position_mm", "front_marker"}),
        ({"front_marker": 0}, set(READING)),
    ],
)
def test_a_reading_that_is_told_value_by_value_goes_as_a_whole(more: dict[str, int], refused: set[str]) -> None:
    """A marker of which the accuracy was refused would count as accurate as any."""
    controller = Controller(trusting())
    controller.step(distances(100))
    values = [ValueRecord(time_ms=200, name=name, value=value) for name, value in (READING | more).items()]
    report = controller.step([*distances(200), *values])
    assert {fault.channel for fault in report.rejections} == refused
    assert report.interval is None
    whole = [ValueRecord(time_ms=300, name=name, value=value) for name, value in READING.items()]
    assert controller.step([*distances(300), *whole]).interval is not None


def test_two_channels_that_say_the_same_input() -> None:
    """Neither is used: nobody knows which is right. Also where an input has several names."""
    controller = Controller(trusting())
    controller.step(distances(100))
    own = MarkerRecord(time_ms=200, end="front", marker=7, position_mm=250_000, accuracy_mm=20_000)
    other = ValueRecord(time_ms=200, name="front_marker_accuracy_mm", value=0)
    report = controller.step([*distances(200), own, other])
    assert [(fault.channel, fault.reason) for fault in report.rejections] == [
        ("front_marker_accuracy_mm", Reason.SURPLUS),
        ("front_marker", Reason.SURPLUS),
    ]
    assert report.interval is None
    balise = Controller(load_target("balise"))
    twice = [ValueRecord(time_ms=100, name="odometer_mm", value=5)]
    report = balise.step([*twice, DistanceRecord(time_ms=100, end="front", unit="wheel", distance_mm=1_200)])
    assert {fault.channel for fault in report.rejections} == {"odometer_mm", "front_wheel"}


def test_truth_values_and_members_are_judged() -> None:
    """A value of the wrong kind is a fault of its channel, and one machine's wrong word never an exception."""
    controller = Controller(own(door), period_ms=500)
    said = [
        ValueRecord(time_ms=500, name="speed", value=0),
        ValueRecord(time_ms=500, name="released", value=1),
        ValueRecord(time_ms=500, name="blocked", value=False),
    ]
    with pytest.raises(InputError, match="input released is missing"):
        controller.step(said)
    why = r"released was refused: expected true or false, got 1\."
    with pytest.raises(
        InputError, match=rf"^door has halted: input released is missing; {why} Make a new controller\.$"
    ):
        controller.step(said)


def test_records_speak_to_every_machine_of_a_composition() -> None:
    """An input of a composition is meant by its own name, without the machine's."""
    controller = Controller(shipped("supervised_odometry"))
    reports = [controller.step(records) for records in drive(100)]
    assert reports[-1].modes == {"odometry": "FRONT", "delocalized": "LOCALIZED"}
    assert reports[-1].interval is not None
    assert reports[-1].mode == "FRONT, LOCALIZED"


def test_what_may_be_incomplete_is_not_used() -> None:
    """A cycle of which something was lost gives no input at all: the step is that of an empty cycle."""
    lossy, empty = located(), located()
    report = lossy.step(distances(400), lost="a line was cut")
    assert report.values == empty.step([]).values
    assert [(fault.channel, fault.reason, fault.detail) for fault in report.rejections] == [
        (EVERY, Reason.LOST, "a line was cut")
    ]


def test_a_flood_is_not_used() -> None:
    """More records than a cycle can have: none is used, and the rest is not even looked at."""
    flood = [DistanceRecord(time_ms=400, end="front", unit="wheel", distance_mm=0)] * (MOST_RECORDS + 50)
    controller, empty = located(), located()
    report = controller.step(iter(flood))
    assert report.values == empty.step([]).values
    assert report.rejections[-1].detail == f"more than {MOST_RECORDS} records in one cycle"


def test_missing_channels_are_named() -> None:
    """A channel of which fewer records came than expected gives no input."""
    controller = Controller(trusting(), expected={"front_wheel": 2})
    (fault,) = controller.step(distances(100)).rejections
    assert (fault.channel, fault.reason, fault.detail) == ("front_wheel", Reason.MISSING, "1 of 2")


def test_silence_widens_and_then_loses_the_place() -> None:
    """Cycles in which nothing comes add to the error one by one, and the place is lost within the configured cycles."""
    controller = located()
    before = controller.report.interval
    lengths = [before.length_mm if before else 0]
    for _ in range(10):
        interval = controller.step([]).interval
        if interval is None:
            break
        lengths.append(interval.length_mm)
    assert lengths == sorted(set(lengths))
    assert controller.report.mode == "DELOCALIZED"
    assert controller.report.outputs["reason"] == "SENSOR_FAILURE"


def test_a_wrong_input_empties_its_cycle() -> None:
    """Half a reading may mean something else: with one wrong value nothing of the step is used, and time adds to the error."""
    wrong, empty = located(), located()
    inputs: dict[str, object] = {"front_wheel_mm": 1200, "front_marker": 9, "front_marker_accuracy_mm": 10**9}
    report = wrong.step_inputs(inputs)
    assert report.values == empty.step_inputs({}).values
    assert [(fault.channel, fault.reason) for fault in report.rejections] == [
        ("front_marker_accuracy_mm", Reason.OUT_OF_RANGE)
    ]


@pytest.mark.parametrize(
    ("value", "reason"),
    [(float("nan"), Reason.NOT_FINITE), (1.5, Reason.WRONG_TYPE), ("7", Reason.WRONG_TYPE), (True, Reason.WRONG_TYPE)],
)
def test_why_an_input_is_refused(value: object, reason: Reason) -> None:
    """No value is converted."""
    (fault,) = located().step_inputs({"front_wheel_mm": value}).rejections
    assert (fault.channel, fault.reason) == ("front_wheel_mm", reason)


def test_an_unknown_input_is_the_hosts_mistake() -> None:
    """It is told with the nearest name, and the cycle is not over."""
    controller = located()
    with pytest.raises(InputError, match=r"odometry has no input 'front_wheel'; .* Did you mean 'front_wheel_mm'\?$"):
        controller.step_inputs({"front_wheel": 1})
    assert controller.report.cycle == 3


def test_what_is_no_record_is_the_hosts_mistake() -> None:
    """Nothing has happened then."""
    controller = located()
    with pytest.raises(InputError, match=r"^expected records \(safeloc\.runtime\.streams\.records\), got dict\.$"):
        controller.step([{"kind": "distance"}])  # type: ignore[list-item]
    assert controller.report.cycle == 3


def test_truth_beside_the_records_is_compared() -> None:
    """A truth record is read by no machine; the report says how it stands to it."""
    controller = located()
    interval = controller.report.interval
    assert interval is not None
    inside, outside = (TruthRecord(time_ms=t, position_nm=p) for t, p in ((400, 252_700 * 10**6), (500, 0)))
    assert controller.step([*distances(400), inside]).standing == "contained"
    assert controller.step([*distances(500), outside]).standing == "WRONG"
    assert controller.begin_anew("test").standing is None
    assert controller.step([TruthRecord(time_ms=600, position_nm=0)]).standing == "INVALID"


def test_beginning_anew_forgets_the_place() -> None:
    """The reason is told, and only a reference brings a place again."""
    controller = located()
    report = controller.begin_anew("the vehicle was towed", start_ms=10_000)
    assert (report.interval, report.anew, report.mode) == (None, "the vehicle was towed", "DELOCALIZED")
    assert controller.step(distances(10_100)).interval is None
    assert controller.next_end_ms == 10_200


@pytest.mark.parametrize("start_ms", [float("nan"), 1.5, "0", True])
def test_a_beginning_that_is_no_time(start_ms: Any) -> None:
    """Refused, and nothing has happened: with NaN no record would ever be late."""
    with pytest.raises(InputError, match=r"^start_ms is .*; give whole ms"):
        Controller(trusting(), start_ms=start_ms)
    controller = located()
    with pytest.raises(InputError, match="start_ms"):
        controller.begin_anew("test", start_ms=start_ms)
    assert controller.report.interval is not None


def test_a_claim_about_the_world_is_not_begun_anew() -> None:
    """A door that may have been opened meanwhile is not taken for locked."""
    with pytest.raises(InputError, match="its initial state makes a claim about the world"):
        Controller(own(door), period_ms=500).begin_anew("test")


def test_the_period_is_said_once() -> None:
    """By the configuration, or by the host for a machine that has none."""
    with pytest.raises(
        InputError,
        match=r"^the configuration of door has no cycle length; give period_ms, on the command line --period-ms\.$",
    ):
        Controller(own(door))
    with pytest.raises(InputError, match="configured for cycles of 100 ms, not 50 ms"):
        Controller(trusting(), period_ms=50)
    with pytest.raises(InputError, match="at least 1 ms"):
        Controller(own(door), period_ms=0)


class Host:
    """A host's object that notes what it is told."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def on_enter_front(self, event: Any) -> None:
        """The place is known."""
        report: Report = event.kwargs["report"]
        self.told.append(f"front at {report.time_ms}")

    def on_enter_delocalized(self, event: Any) -> None:
        """The place is lost."""
        self.told.append(f"lost: {event.kwargs['report'].outputs['reason']}")


def test_a_host_object_follows_the_modes() -> None:
    """Its callbacks run when a mode is entered, with the report."""
    controller, host = Controller(trusting()), Host()
    controller.follow(host)
    for records in drive(3):
        controller.step(records)
    for _ in range(8):
        controller.step([])
    assert host.told == ["front at 200", "lost: SENSOR_FAILURE"]
    assert host.state == "DELOCALIZED"  # type: ignore[attr-defined] # `transitions` gave it the attribute


def test_one_machine_of_several_is_followed() -> None:
    """In a composition the host says which one."""
    controller = Controller(shipped("supervised_odometry"))
    with pytest.raises(InputError, match=r"^name the machine to follow: one of odometry, delocalized\.$"):
        controller.follow(SimpleNamespace())
    with pytest.raises(InputError, match=r"^no machine 'x' to follow; there are odometry, delocalized\.$"):
        controller.follow(SimpleNamespace(), "x")
    host = SimpleNamespace()
    controller.follow(host, "delocalized")
    for records in drive(100):
        controller.step(records)
    assert host.state == "LOCALIZED"


def test_listeners_get_each_report_and_fail_together() -> None:
    """One that fails keeps nobody from being told, and the step is done."""
    controller = Controller(trusting())
    got: list[Report] = []

    def fail(report: Report) -> None:
        raise RuntimeError(f"host at {report.cycle}")

    controller.listen(fail)
    controller.listen(got.append)
    with pytest.raises(ExceptionGroup, match="listeners failed after cycle 1; the step itself is done"):
        controller.step(distances(100))
    assert got == [controller.report]
    assert controller.report.cycle == 1


def test_a_listener_must_not_step() -> None:
    """A step within a step would have two orders of time."""
    controller = Controller(trusting())
    controller.listen(lambda _report: controller.step([]))
    with pytest.raises(ExceptionGroup) as failed:
        controller.step([])
    assert "must not step its own controller" in str(failed.value.exceptions[0])
    assert controller.report.cycle == 1


@pytest.fixture
def hasty() -> Iterator[None]:
    """Threads are switched after every few instructions, so that what is not locked is interrupted within."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(usual)


@pytest.mark.usefixtures("hasty")
def test_threads_take_turns() -> None:
    """Steps of several threads are all taken, one after the other, each with a cycle of its own."""
    controller = Controller(trusting())
    seen: list[int] = []
    controller.listen(lambda report: seen.append(report.cycle))
    together = threading.Barrier(4)

    def drive_on() -> None:
        together.wait()
        for _ in range(100):
            controller.step([])
            controller.snapshot()

    threads = [threading.Thread(target=drive_on) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == list(range(1, 401))


def test_controllers_share_nothing_but_the_program() -> None:
    """One vehicle's marker does not locate another one."""
    one, other = Controller(trusting()), Controller(trusting())
    for records in drive(3):
        one.step(records)
        other.step(records[:4])
    assert one.report.interval is not None
    assert other.report.interval is None


@given(st.lists(st.sampled_from(["drive", "nothing", "unknown", "future", "nan", "wrong"]), min_size=20, max_size=20))
@settings(max_examples=30)
def test_no_record_is_too_odd(kinds: list[str]) -> None:
    """Whatever comes, a cycle is a report, and an empty cycle is never better than one of good records."""
    controller = located()
    for number, kind in enumerate(kinds, 4):
        end_ms = number * PERIOD_MS
        said: dict[str, list[Any]] = {
            "drive": distances(end_ms),
            "nothing": [],
            "unknown": [ValueRecord(time_ms=end_ms, name="x", value="?")],
            "future": distances(10**9),
            "nan": [Unusable(end_ms, "front_wheel", Reason.NOT_FINITE)],
            "wrong": [ValueRecord(time_ms=end_ms, name="front_wheel_mm", value="?")],
        }
        report = controller.step(said[kind])
        assert report.cycle == number
        if kind != "drive":
            assert report.rejections or kind == "nothing"


@pytest.mark.thorough
def test_memory_does_not_grow() -> None:
    """A thousand cycles, with senders that invent channels and faults, leave no more behind than hundreds."""
    controller = Controller(trusting())

    def go(first: int, count: int) -> None:
        for number, records in enumerate(drive(count, first), first):
            odd = ValueRecord(time_ms=number * PERIOD_MS, name=f"channel_{number}", value=number)
            controller.step([*records, odd, Unusable(number * PERIOD_MS, f"other_{number}", Reason.NOT_FINITE)])

    go(1, 300)
    tracemalloc.start()
    go(301, 100)
    before = tracemalloc.get_traced_memory()[0]
    go(401, 1_000)
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert grown < 10_000
