"""What lines do to vehicles, without any process around it."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.language.system import lower
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.embedding.controller import MOST_RECORDS
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.lines import Line
from safeloc.runtime.streams.steps import SCHEMA
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.data.door_controller import machine as door
from tests.runtime.embedding.driving import distances, drive, trusting
from tests.runtime.service.processes import Data, line, lines, numbered, reports

HERE = "here"


class Told:
    """A fleet that is told lines, with its answers."""

    def __init__(self, fleet: Fleet | None = None, *, from_start: bool = True) -> None:
        self.fleet = fleet or Fleet(trusting(), FleetSettings(100))
        self.from_start, self.number = from_start, 0

    def say(self, *texts: str, origin: str = HERE, only: str | None = None) -> list[Data]:
        """Answers to these lines."""
        answers: list[Data] = []
        for text in texts:
            self.number += 1
            answers += self.fleet.handle(
                origin, Line(self.number, text.strip().encode()), from_start=self.from_start, only=only
            )
        return answers


def end(time_ms: int, **envelope: object) -> str:
    """A cycle is over."""
    return json.dumps({**envelope, "kind": "cycle", "time_ms": time_ms})


def by_hand(cycles: int) -> list[Data]:
    """Reports of a controller that was given the drive."""
    controller = Controller(trusting())
    return [{"vehicle": "1", **controller.step(records).as_data()} for records in drive(cycles)]


def test_records_become_cycles() -> None:
    """A cycle is over when a record of a later one comes; the last one when there are no more."""
    told = Told()
    answers = told.say(*lines(30))
    assert answers == by_hand(29)
    assert [*answers, *told.fleet.finish()] == by_hand(30)


def test_a_cycle_is_over_when_it_is_said_to_be() -> None:
    """At once, without waiting for the next one."""
    told = Told()
    for cycle, records in enumerate(drive(5), 1):
        *none, report = told.say(*map(line, records), end(cycle * 100))
        assert (none, report["cycle"]) == ([], cycle)
    assert told.fleet.finish() == []


def test_vehicles_are_told_apart() -> None:
    """Each has a machine, a clock and a count of its own."""
    told = Told()
    one, other = lines(20, vehicle="a"), numbered(20, "b")
    answers = [answer for pair in zip(one, other, strict=False) for answer in told.say(*pair)]
    apart = [[answer for answer in answers if answer["vehicle"] == name] for name in "ab"]
    assert [report["interval_mm"] for report in apart[0]] == [
        report["interval_mm"] for report in by_hand(len(apart[0]))
    ]
    assert [report["interval_mm"] for report in apart[1]] == [
        report["interval_mm"] for report in by_hand(len(apart[1]))
    ]
    assert len(apart[0]) > 10 < len(apart[1])


def test_a_vehicle_has_its_own_configuration() -> None:
    """Only it: one that does not believe its first marker has no place where another one has."""
    careful = Program(ENTRIES["odometry"].make(OdometryConfig()))
    told = Told(Fleet(trusting(), FleetSettings(100), {"careful": careful}))
    places = {name: told.say(*numbered(3, name))[-1]["interval_mm"] for name in ("careful", "other")}
    assert places["careful"] is None
    assert places["other"] is not None


def test_silence_adds_error_cycle_by_cycle() -> None:
    """A gap in time is so many steps without inputs."""
    told, controller = Told(), Controller(trusting())
    told.say(*lines(3))
    answers = told.say(line(distances(700)[0]))
    for records in drive(3):
        expected = controller.step(records)
    assert [answer["cycle"] for answer in answers] == [3, 4, 5, 6]
    assert answers[0]["outputs"] == expected.outputs
    assert [answer["outputs"] for answer in answers[1:]] == [controller.step([]).outputs for _ in range(3)]


@pytest.mark.parametrize("text", ["{", '{"kind": "distance", "time_ms": 400}', '{"vehicle": "1"}'])
def test_a_line_that_cannot_be_read_is_doubt(text: str) -> None:
    """It may have been a distance of the open cycle or of the next one: neither is used, and the one after them is."""
    told = Told()
    told.say(*lines(4))
    refused, *none = told.say(text)
    assert (refused["event"], refused["line"], none) == ("refused", told.number, [])
    answers = reports(told.say(*lines(3, 5)))
    assert [doubted(answer) for answer in answers] == [True, True, False]


def doubted(report: Data) -> bool:
    """Whether nothing of the cycle was used."""
    return any(fault["channel"] == "*" for fault in report.get("rejections", ()))


def test_within_a_cycle_doubt_stays_there() -> None:
    """With a good line of the same cycle behind it, a bad line is of that cycle."""
    told = Told()
    told.say(*lines(4))
    first, *others = [line(record) for record in distances(500)]
    answers = reports(told.say(first, "{", *others, *lines(3, 6)))
    assert [(answer["cycle"], doubted(answer)) for answer in answers] == [(4, False), (5, True), (6, False), (7, False)]


def test_a_doubtful_cycle_is_an_empty_one() -> None:
    """Its step is that of a cycle in which nothing came."""
    told, empty = Told(), Controller(trusting())
    told.say(*lines(4), end(400))
    for records in drive(4):
        empty.step(records)
    (report,) = reports(told.say("{", *map(line, distances(500)), end(500)))
    assert report["outputs"] == empty.step([]).outputs


def test_a_measurement_that_is_none_costs_its_channel() -> None:
    """The others are used, and the report says which line it was."""
    told = Told()
    told.say(*lines(3), end(300))
    wheel, *others = [line(record) for record in distances(400)]
    (report,) = told.say(wheel.replace("1200", "NaN"), *others, end(400))
    (rejection,) = report["rejections"]
    assert (rejection["channel"], rejection["reason"], rejection["line"]) == ("front_wheel", "NOT_FINITE", 15)


@pytest.mark.parametrize("lost", range(1, 6))
def test_a_lost_line_shows_by_its_number(lost: int) -> None:
    """Whichever line of a cycle is lost, its distances are not taken for the whole of it."""
    told = Told()
    made = numbered(6)
    told.say(*made[:16])
    cycle = made[16:21]
    answers = told.say(*[text for place, text in enumerate(cycle, 1) if place != lost], *made[21:26])
    by_cycle = {answer["cycle"]: doubted(answer) for answer in reports(answers)}
    assert by_cycle == {4: True, 5: lost == 5}


def test_doubled_and_swapped_lines_are_refused() -> None:
    """A distance is never counted twice."""
    told = Told()
    made = numbered(5)
    answers = told.say(*made[:12], made[11], made[13], made[12], *made[14:20])
    refused = [answer for answer in answers if answer.get("event") == "refused"]
    assert [answer["reason"] for answer in refused] == ["number 12 again", "number 13 after 14"]
    assert [answer["cycle"] for answer in reports(answers) if doubted(answer)] == [3]


def test_one_wrong_time_is_one_line() -> None:
    """A clock value far ahead is refused, and the vehicle goes on; its cycle is not used."""
    told = Told()
    told.say(*lines(3), end(300))
    answers = told.say(line(distances(10**7)[0]), *map(line, distances(400)), end(400))
    assert answers[0]["reason"].endswith("ms ahead; a gap may have at most 60000 ms")
    assert (answers[1]["cycle"], doubted(answers[1])) == (4, True)
    assert told.say(*map(line, distances(500)), end(500))[0]["interval_mm"] is not None


@pytest.mark.parametrize("begin_ms", [10**7, 0], ids=["ahead", "back"])
def test_a_clock_that_was_set_is_followed(begin_ms: int) -> None:
    """After ten cycles that agree the vehicle begins anew, in the new time and without a place; no time leads to nothing."""
    told = Told()
    told.say(*lines(900))
    answers = []
    for cycle in range(1, 16):
        answers += told.say(*map(line, distances(begin_ms + cycle * 100)), end(begin_ms + cycle * 100))
    anew = [answer for answer in answers if "anew" in answer]
    assert len(anew) == 1
    assert anew[0]["anew"].startswith("its clock was changed by ")
    last = reports(answers)[-1]
    assert (last["time_ms"], last["interval_mm"], last["mode"]) == (begin_ms + 1_500, None, {"odometry": "DELOCALIZED"})


def test_a_time_that_no_clock_shows() -> None:
    """Refused, and doubt."""
    told = Told()
    told.say(*lines(3), end(300))
    (refused,) = told.say(line(distances(10**30)[0]))
    assert refused["reason"] == f"its time is {10**30} ms, more than any clock can show"
    assert doubted(told.say(end(400))[0])


def test_a_flood_is_refused() -> None:
    """A thousand records in a cycle; with more nothing of it is used, each further one is told, and then it goes on."""
    told = Told()
    told.say(*lines(3), end(300))
    flood = [line(distances(400, distance_mm=0)[0])] * (MOST_RECORDS + 5)
    answers = told.say(*flood, end(400))
    assert [answer["event"] for answer in answers[:-1]] == ["refused"] * 5
    assert doubted(answers[-1])
    assert not doubted(told.say(*map(line, distances(500)), end(500))[0])


def test_a_vehicle_met_under_way() -> None:
    """Where its first line need not be the first there was, its first cycle is not used, unless it is numbered 1."""
    assert doubted(Told(from_start=False).say(*lines(2))[0])
    assert not doubted(Told(from_start=False).say(*numbered(2))[0])
    assert not doubted(Told(from_start=False).say(end(0), *lines(2))[0])


def test_a_bad_line_before_the_first_good_one() -> None:
    """It may have been of the first cycle."""
    assert doubted(Told().say("{", *lines(2))[1])


def test_half_a_line() -> None:
    """At the end of a file it is a line that cannot be read; where a peer went away it comes again, by its number."""
    told = Told()
    made = numbered(4)
    told.say(*made[:18])
    half = made[18][:20].encode()
    assert told.fleet.handle(HERE, Line(19, half, cut=True), from_start=True)[0]["event"] == "refused"
    told.fleet.gone(HERE, "it hung up")
    assert not any(doubted(answer) for answer in told.say(*made[18:]))
    told = Told()
    told.say(*lines(4), made[0][:20])
    assert doubted(told.fleet.finish()[0])


def test_another_peer_speaks_for_a_vehicle() -> None:
    """What the first one said last may be lost, unless the numbers go on."""
    told = Told()
    made = numbered(4)
    told.say(*made[:7])
    assert not any(doubted(answer) for answer in reports(told.say(*made[7:11], origin="there")))
    told = Told()
    told.say(*lines(3))
    assert [doubted(answer) for answer in told.say(*lines(3, 4), origin="there")] == [True, True, False]


def test_a_peer_that_left() -> None:
    """Its vehicles' next cycles are doubtful, those of others are not."""
    told = Told()
    told.say(*lines(3, vehicle="a"), origin="x")
    told.say(*lines(3, vehicle="b"), origin="y")
    told.fleet.gone("x", "it hung up")
    answers = [*told.say(*lines(2, 4, vehicle="a"), origin="z"), *told.say(*lines(2, 4, vehicle="b"), origin="y")]
    assert [(answer["vehicle"], doubted(answer)) for answer in answers] == [
        ("a", True),
        ("a", True),
        ("b", False),
        ("b", False),
    ]


def test_vehicles_are_bounded() -> None:
    """A sender that invents vehicles is refused."""
    told = Told(Fleet(trusting(), FleetSettings(100, most_vehicles=2)))
    answers = [answer for name in "abc" for answer in told.say(*lines(1, vehicle=name))]
    assert {answer["reason"] for answer in answers} == {"2 vehicles already"}
    assert {answer["vehicle"] for answer in answers} == {"c"}


def test_a_machine_that_cannot_go_on_stops_its_vehicle() -> None:
    """It is told once, and later lines are refused; other vehicles go on."""
    target = Target("door", (door,), lower(door), ())
    told = Told(Fleet(Program(target), FleetSettings(500, inputs=True)))
    from_start = {"speed": 0, "released": False, "blocked": False}
    said = [
        {"vehicle": "a", "cycle": 1, **from_start},
        {"vehicle": "a", "cycle": 3, **from_start},
        {"vehicle": "a", "cycle": 4, **from_start},
    ]
    answers = told.say(*map(json.dumps, said), json.dumps({"vehicle": "b", "cycle": 1, **from_start}))
    assert [answer.get("event", "report") for answer in answers] == ["report", "halted", "refused", "report"]
    assert "cannot restart by itself (input speed is missing)" in answers[1]["reason"]


# ------------------------------------------------------------------ steps instead of records


def steps() -> Told:
    """Lines are inputs."""
    return Told(Fleet(trusting(), FleetSettings(100, inputs=True)))


def inputs(records: list[Any]) -> Data:
    """A cycle's records as inputs."""
    return {name: value for record in records for name, value in record.inputs().items()}


def test_a_step_is_a_cycle() -> None:
    """Numbered or not."""
    plain, counted = steps(), steps()
    said = [inputs(records) for records in drive(20)]
    expected = by_hand(20)
    assert plain.say(*map(json.dumps, said)) == expected
    assert counted.say(*(json.dumps({"cycle": n, **one}) for n, one in enumerate(said, 1))) == expected


def test_a_missing_step_adds_error() -> None:
    """By cycle numbers a gap is so many steps without inputs; without them a line that says something wrong is one."""
    said = [inputs(records) for records in drive(6)]
    counted, plain = steps(), steps()
    gap = counted.say(*(json.dumps({"cycle": n, **one}) for n, one in enumerate(said, 1) if n != 4))
    bad = plain.say(*map(json.dumps, said[:3]), '{"front_whel_mm": 1}', *map(json.dumps, said[4:]))
    assert [answer["outputs"] for answer in gap] == [answer["outputs"] for answer in reports(bad)]
    assert len(gap) == 6
    assert doubted(reports(bad)[3])


@pytest.mark.parametrize("merged", [2, 30])
@pytest.mark.parametrize("how", ["\r", " ", "", "x" * 70_000])
def test_what_cannot_be_read_may_have_been_any_number_of_steps(merged: int, how: str) -> None:
    """Line ends that are damaged swallow steps: without cycle numbers the vehicle begins anew, at the next line or at the
    end; with them the gap adds to the error, and the place is kept where it may be."""
    said = [json.dumps(inputs(records)) for records in drive(60)]
    joined = how.join(said[5 : 5 + merged])
    told = steps()
    told.say(*said[:5])
    assert told.fleet.vehicles["1"].place is not None
    flaw = "longer than 65536 bytes" if len(joined) > 65_536 else ""
    (refused,) = told.fleet.handle(HERE, Line(6, b"" if flaw else joined.encode(), flaw), from_start=True)
    anew, report = told.say(said[5 + merged])
    assert refused["event"] == "refused"
    assert anew["anew"] == f"line 6: {refused['reason']}"
    assert (anew["interval_mm"], report["interval_mm"]) == (None, None)
    ended = steps()
    ended.say(*said[:5])
    ended.say(joined)
    assert [one["interval_mm"] for one in ended.fleet.finish()] == [None]
    counted = steps()
    numbered_ = [json.dumps({"cycle": n, **json.loads(one)}) for n, one in enumerate(said, 1)]
    counted.say(*numbered_[:5], how.join(numbered_[5:7]))
    assert not any("anew" in one for one in counted.say(numbered_[7]))


def test_a_step_that_came_before_is_refused() -> None:
    """A cycle is stepped once."""
    told = steps()
    answers = told.say(*(json.dumps({"cycle": n}) for n in (1, 2, 2, 1, 3)), json.dumps({}))
    assert [answer.get("reason", answer.get("cycle")) for answer in answers] == [
        1, 2, "cycle 2 is over", "cycle 1 is over", 3, "no cycle number, but earlier steps had one",
    ]  # fmt: skip


def test_a_loss_of_unknown_length_ends_in_beginning_anew() -> None:
    """Steps without numbers cannot say how many were lost."""
    told = steps()
    told.say(*(json.dumps(inputs(records)) for records in drive(5)))
    told.fleet.gone(HERE, "it hung up")
    answers = told.say(json.dumps({"front_wheel_mm": 1200}))
    assert [answer.get("anew") for answer in answers] == ["it hung up", None]
    assert answers[1]["interval_mm"] is None


def test_the_truth_beside_a_step_is_compared() -> None:
    """And misses are counted."""
    told = steps()
    told.say(*(json.dumps(inputs(records)) for records in drive(3)))
    (report,) = told.say(json.dumps({"truth_mm": 0}))
    assert report["truth"] == "WRONG"
    assert told.fleet.wrong == 1


def short_stream() -> tuple[list[str], list[Data]]:
    """A stream that leaves out distances that are as they were before, and its steps in full."""
    from_start = [inputs(records) for records in drive(12)]
    for number, step in enumerate(from_start):
        step |= {"front_wheel_mm": 1200 + number // 5, "truth_mm": number * 1200}
    kept = ["front_wheel_mm", "front_radar_mm", "rear_wheel_mm", "rear_radar_mm", "truth_mm"]
    short = [
        {name: value for name, value in step.items() if name not in kept or value != before.get(name)}
        for before, step in pairwise([{}, *from_start])
    ]
    header = {"schema": "safeloc-stream/1", "machine": "odometry", "kept": kept}
    return [json.dumps(header), *map(json.dumps, short)], from_start


def test_a_stream_may_leave_out_what_is_as_before() -> None:
    """As recordings are shipped: reports are those of the steps in full, also behind a restart."""
    said, from_start = short_stream()
    expected = steps().say(*map(json.dumps, from_start))
    told, again = steps(), steps()
    first = told.say(*said[:6])
    again.fleet.restore(json.loads(json.dumps(told.fleet.freeze()())))
    assert [*first, *again.say(*said[6:])] == expected
    assert expected[5]["interval_mm"] is not None


def test_what_is_left_out_behind_a_lost_step_is_not_known() -> None:
    """Nothing of such a step is used, until one says everything again."""
    said, from_start = short_stream()
    answers = steps().say(*said[:5], '{"nonsense": 1}', *said[6:8], json.dumps(from_start[7]), said[9])
    refused = [answer for answer in answers if answer.get("event") == "refused"]
    assert [answer["line"] for answer in refused] == [6, 7, 8]
    assert "is left out as kept, but the step before has no value of it" in refused[1]["reason"]
    told = reports(answers)
    assert [doubted(one) for one in told] == [False] * 4 + [True] * 3 + [False] * 2


# ------------------------------------------------------------------ ways back


MOST = 2**62


@pytest.mark.parametrize("restarted", [False, True])
@pytest.mark.parametrize("wrong", [MOST, 900_000, 200])
def test_a_wrong_number_does_not_mute_a_vehicle(wrong: int, restarted: bool) -> None:
    """After one line with a large number the owner's lines are heard again within ten, also behind a restart, and what
    is missing adds to the error: no cycle that was open then is used."""
    told, made = Told(), numbered(30)
    told.say(*made[:11])
    told.say(json.dumps({"number": wrong, "kind": "cycle", "time_ms": 250}))
    if restarted:
        kept = json.loads(json.dumps(told.fleet.freeze()()))
        told.fleet = Fleet(trusting(), FleetSettings(100))
        told.fleet.restore(kept)
    answers = told.say(*made[11:])
    refused = [one for one in answers if one.get("event") == "refused"]
    assert len(refused) <= 9
    assert reports(answers)[-1]["time_ms"] == 3_000
    assert [one for one in reports(answers) if not doubted(one)][-1]["cycle"] == 30
    if wrong != MOST:
        assert any(doubted(one) for one in reports(answers))


def test_a_number_far_ahead_is_no_loss() -> None:
    """A line that is refused for its number costs nothing where the numbers go on."""
    told, made = Told(), numbered(5)
    told.say(*made[:11])
    (refused,) = told.say(json.dumps({"number": MOST, "kind": "cycle", "time_ms": 250}))
    assert refused["reason"] == f"number {MOST} after 11: too far ahead for a loss"
    assert not any(doubted(one) for one in told.say(*made[11:]))


def test_a_sender_that_does_not_count_any_more_is_followed() -> None:
    """One line with a number among lines without any is one line."""
    told = Told()
    told.say(*lines(3), json.dumps({"number": 7, "kind": "cycle", "time_ms": 300}))
    answers = told.say(*lines(27, 4), end(3_000))
    assert len([one for one in answers if one.get("reason") == "no number, after 7"]) == 9
    assert reports(answers)[-1]["time_ms"] == 3_000
    assert not doubted(reports(answers)[-1])


def test_steps_that_have_no_number_any_more_are_followed() -> None:
    """The same of cycle numbers: how many steps are missing is not known, so the vehicle begins anew."""
    told = steps()
    said = [json.dumps(inputs(records)) for records in drive(40)]
    told.say(*said[:4], json.dumps({"cycle": 5, **json.loads(said[4])}))
    answers = told.say(*said[5:])
    assert len([one for one in answers if one.get("event") == "refused"]) == 9
    assert [one["anew"] for one in answers if "anew" in one] == ["its steps have no cycle number any more"]
    assert reports(answers)[-1]["time_ms"] == 500 + 2_600


@pytest.mark.parametrize("ahead_ms", [1_100, 30_000, 60_000])
def test_a_time_ahead_is_not_believed_of_one_line(ahead_ms: int) -> None:
    """Up to the longest gap: the line is refused, one cycle is not used, and the place is kept."""
    told = Told()
    told.say(*lines(3), end(300))
    (refused,) = told.say(line(distances(400 + ahead_ms)[0]))
    assert refused["reason"] == f"{ahead_ms} ms ahead; accepted as soon as lines of 2 cycles agree"
    answers = told.say(*map(line, distances(400)), end(400), *map(line, distances(500)), end(500))
    assert [(one["cycle"], doubted(one)) for one in answers] == [(4, True), (5, False)]
    assert answers[-1]["interval_mm"] is not None


def test_a_silence_is_believed_when_lines_agree() -> None:
    """Two cycles later it adds to the error cycle by cycle; who speaks that seldom is believed at once from then on."""
    told = Told()
    told.say(*lines(3), end(300))
    answers = told.say(*[text for at in (5_000, 5_100, 5_200) for text in [*map(line, distances(at)), end(at)]])
    assert len(answers) - len(reports(answers)) == 10
    assert [one["time_ms"] for one in reports(answers)] == [100 * n for n in range(4, 53)]
    told = Told()
    answers = told.say(*[end(at) for at in range(0, 60_000, 3_000)])
    assert [one["reason"] for one in answers if "reason" in one] == [
        "2900 ms ahead; accepted as soon as lines of 2 cycles agree"
    ]
    assert reports(answers)[-1]["time_ms"] == 57_000


def test_a_late_line_does_not_vouch_for_one_that_is_ahead() -> None:
    """They are both out of step, and do not agree."""
    told = Told()
    told.say(*lines(3), end(300), line(distances(100)[0]))
    (refused,) = told.say(line(distances(5_000)[0]))
    assert refused["reason"] == "4600 ms ahead; accepted as soon as lines of 2 cycles agree"


# ------------------------------------------------------------------ room


class Clock:
    """Seconds, as told."""

    now = 0.0

    def __call__(self) -> float:
        """What it shows."""
        return self.now


def crowd(**ways: Any) -> tuple[Told, Clock]:
    """A fleet with little room."""
    clock = Clock()
    return Told(Fleet(trusting(), FleetSettings(100, **ways), clock=clock), from_start=False), clock


def test_names_that_nobody_uses_any_more_make_room() -> None:
    """The one that has been silent longest, without a place, is forgotten, and that is told; a located vehicle is not,
    nor one that spoke of late."""
    told, clock = crowd(most_vehicles=3)
    told.say(*numbered(3, "located"))
    told.say(end(100, vehicle="old"))
    clock.now = 30.0
    told.say(end(100, vehicle="young"))
    clock.now = 61.0
    assert "3 vehicles already" not in str(told.say(end(100, vehicle="new")))
    assert list(told.fleet.vehicles) == ["located", "young", "new"]
    (refused,) = told.say(end(100, vehicle="newer"))
    assert refused["reason"] == "3 vehicles already"
    assert told.fleet.by_clock
    clock.now = 200.0
    told.fleet.withdraw("located", "it is silent")
    forgotten, *_ = told.say(end(100, vehicle="newer"))
    assert (forgotten["event"], forgotten["vehicle"]) == ("forgotten", "located")
    assert list(json.loads(json.dumps(told.fleet.freeze()()))) == ["young", "new", "newer"]


def test_one_peer_cannot_use_up_all_names() -> None:
    """It is refused more than its share, and told; others have theirs."""
    told, clock = crowd(most_vehicles=10, most_of_a_peer=2)
    answers = [one for name in "abc" for one in told.say(end(100, vehicle=name), origin="x")]
    assert [one["reason"] for one in answers] == ["2 vehicles of this peer already"]
    assert told.say(end(100, vehicle="d"), origin="y") == []
    clock.now = 100.0
    assert told.say(end(100, vehicle="e"), origin="x")[0]["vehicle"] == "a"


def test_names_of_a_snapshot_make_room_too() -> None:
    """A table that was full when it was saved is not full for ever."""
    told, clock = crowd(most_vehicles=2)
    told.say(end(100, vehicle="a"), end(100, vehicle="b"))
    again, clock = crowd(most_vehicles=2)
    again.fleet.restore(json.loads(json.dumps(told.fleet.freeze()())))
    assert again.say(end(100, vehicle="c"))[0]["reason"] == "2 vehicles already"
    clock.now = 61.0
    assert again.say(end(100, vehicle="c"))[0]["event"] == "forgotten"


def test_what_claims_something_is_not_forgotten() -> None:
    """A machine whose first state says something about the world would say it again."""
    clock = Clock()
    target = Target("door", (door,), lower(door), ())
    told = Told(Fleet(Program(target), FleetSettings(500, inputs=True, most_vehicles=1), clock=clock))
    from_start = {"speed": 0, "released": False, "blocked": False}
    told.say(json.dumps({"vehicle": "a", "cycle": 1, **from_start}))
    clock.now = 1e6
    assert told.say(json.dumps({"vehicle": "b", "cycle": 1, **from_start}))[0]["reason"] == "1 vehicles already"


def test_silence_withdraws_a_place() -> None:
    """Told once, with the reason; what was open is not used, and a vehicle without a place has nothing to withdraw."""
    told = Told()
    told.say(*lines(3), end(300), line(distances(400)[0]))
    doubtful, anew = told.fleet.withdraw("1", "it said nothing for long")
    assert doubted(doubtful)
    assert (anew["anew"], anew["interval_mm"]) == ("it said nothing for long", None)
    assert told.fleet.by_clock
    assert told.fleet.withdraw("1", "it said nothing for long") == []


# ------------------------------------------------------------------ remembered


@given(st.integers(0, 140), st.booleans())
@settings(max_examples=25)
def test_a_fleet_goes_on_where_it_was(cut: int, counted: bool) -> None:
    """Frozen after any line and restored, open cycles and doubts included, the answers are those of one that went on."""
    said = numbered(25) if counted else lines(30)
    said[20] = "{"
    from_start, first, second = Told(), Told(), Told()
    expected = from_start.say(*said)
    answers = first.say(*said[:cut])
    kept = json.loads(json.dumps(first.fleet.freeze()()))
    second.fleet.restore(kept)
    second.fleet.origins.update(first.fleet.origins)
    second.number = first.number
    assert [*answers, *second.say(*said[cut:])] == expected


def test_lost_lines_after_a_restart_are_doubt() -> None:
    """What may have come while nobody listened is not taken for nothing."""
    said = lines(6)
    first, second = Told(), Told()
    first.say(*said[:10])
    second.fleet.restore(first.fleet.freeze()(), "the process was not running")
    assert [doubted(answer) for answer in second.say(*said[14:])] == [True, True, False]


PLAIN = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.sampled_from([0, 100, 400, 2**53, -(10**40)]),
    st.floats(),
    st.text(max_size=5),
)
NAMES = (
    "kind", "time_ms", "end", "unit", "distance_mm", "marker", "position_mm", "accuracy_mm", "since_mm", "name", "value", "vehicle",
    "number", "cycle", "schema", "first", "truth_mm", "front_wheel_mm", "front_marker", "pulses", "position_nm",
)  # fmt: skip
KINDS = st.sampled_from(["distance", "pulses", "marker", "value", "truth", "cycle"])
FIELDS = st.fixed_dictionaries(
    {},
    optional={
        name: PLAIN | KINDS | st.sampled_from(["front", "rear", "wheel", "radar", "front_wheel_mm"]) | st.just([PLAIN])
        if name != "kind"
        else KINDS | PLAIN
        for name in NAMES
    },
)


@given(
    st.lists(FIELDS.map(lambda fields: json.dumps(fields, default=str)) | st.binary(max_size=40), max_size=12),
    st.booleans(),
)
@settings(max_examples=2 * settings.default.max_examples)
def test_no_line_breaks_the_process(said: list[str | bytes], by_steps: bool) -> None:
    """Whatever the bytes: an answer or none, never an exception, and a drive that follows is heard."""
    told = Told(Fleet(trusting(), FleetSettings(100, inputs=by_steps)))
    for number, text in enumerate(said, 1):
        data = text if isinstance(text, bytes) else text.encode()
        answers = told.fleet.handle(HERE, Line(number, data), from_start=True)
        assert json.loads(json.dumps(answers)) == answers
    json.dumps(told.fleet.freeze()())
    fresh = [json.dumps({"cycle": n, "vehicle": "z"}) for n in range(1, 4)] if by_steps else numbered(4, "z")
    assert len(reports(told.say(*fresh))) >= 3


@given(st.lists(st.sampled_from(["{", "[]", '{"vehicle": "1"}', "good", "end", "late", "far", "double"]), max_size=40))
@settings(max_examples=40)
def test_whatever_is_said_cycles_go_on(kinds: list[str]) -> None:
    """Each line is used, refused or rejected, cycles are numbered through, and no interval is narrower than the machine's
    own would be with all lines."""
    told, cycle = Told(), 3
    told.say(*lines(3))
    seen: list[Data] = []
    for kind in kinds:
        cycle += kind in ("good", "end")
        records = [line(record) for record in distances(cycle * 100)]
        said = {"good": records, "end": [end(cycle * 100)], "double": records[:1] * 2}
        said |= {"late": [line(distances(100)[0])], "far": [line(distances(10**8)[0])]}
        seen += told.say(*said.get(kind, [kind]))
    numbers = [answer["cycle"] for answer in reports(seen)]
    assert numbers == list(range(3, 3 + len(numbers)))


# ------------------------------------------------------------------ a peer that is known to be one vehicle

NOT_ITS_OWN = "a line of vehicle {}; the sender's certificate is for vehicle 12 only"


def two() -> Told:
    """Vehicles 12 and 13, each known by its certificate."""
    told = Told(from_start=False)
    for name in ("12", "13"):
        answers = told.say(*numbered(3, name), origin=name, only=name)
        assert [answer["cycle"] for answer in reports(answers)] == [1, 2, 3]
    return told


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (numbered(4, "13")[-1], "13"),  # the very line that vehicle would say next
        ('{"vehicle": "13", "number": "x"}', "13"),
        ('{"vehicle": "14", "number": 1, "kind": "cycle", "time_ms": 100}', "14"),
        (end(400), "1"),
    ],
)
def test_a_certificate_speaks_for_its_own_vehicle_only(text: str, name: str) -> None:
    """A line of another one is refused to who sent it: the other is as it was, none is made, and the sender may have lost
    a line of its own."""
    told = two()
    before = told.fleet.freeze()()
    assert told.say(text, origin="12", only="12") == [
        {"event": "refused", "line": told.number, "reason": NOT_ITS_OWN.format(name)}
    ]
    after = told.fleet.freeze()()
    assert after.keys() == {"12", "13"}
    assert after["13"] == before["13"]
    assert [before["12"]["lost"][0], after["12"]["lost"][0][:8]] == ["", f"line {told.number}: "[:8]]
    assert told.fleet.origins == {"12": "12", "13": "13"}
    goes_on = told.say(*numbered(4, "13")[-5:], origin="13", only="13")
    assert not doubted(reports(goes_on)[-1])


def test_a_stream_without_a_name_is_of_vehicle_1() -> None:
    """Its header says so as its lines do, so only that vehicle's certificate may say it."""
    header = '{"schema": "' + SCHEMA + '", "kept": ["front_wheel_mm"]}'
    told = Told(Fleet(trusting(), FleetSettings(100, inputs=True)), from_start=False)
    (refused,) = told.say(header, origin="12", only="12")
    assert refused["reason"] == NOT_ITS_OWN.format("1")
    assert told.fleet.vehicles == {}
    assert told.say(header, origin="1", only="1") == []
    assert list(told.fleet.vehicles) == ["1"]
