"""What nobody planned costs one vehicle its place, and is never forgotten on disk."""

from __future__ import annotations

import json
import selectors
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from safeloc.errors import InputError, SnapshotError
from safeloc.language.system import lower
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.service import messages
from safeloc.runtime.service.feeds import Arrived, Event, Feed, Over
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.lines import Line
from safeloc.runtime.service.loop import Loop
from safeloc.runtime.service.outlets import Outlet
from safeloc.runtime.service.saving import Saver, read_saved
from safeloc.runtime.service.station import Parts, Station
from safeloc.target import Target
from tests.data.door_controller import machine as door
from tests.runtime.embedding.driving import distances, drive, trusting
from tests.runtime.service.processes import Data, line, lines, numbered, reports
from tests.runtime.service.test_fleet import Told, doubted, end, inputs, steps

FOREIGN = json.dumps({**json.loads(line(distances(400)[0])), "marker": 7})
"""A record with a measured field of another kind."""


def breaking(monkeypatch: pytest.MonkeyPatch, times: int = 1) -> None:
    """The next steps of any controller fail as nobody planned."""
    whole, left = Controller.step, [times]

    def step(self: Controller, *given: Any, **named: Any) -> Any:
        if left[0]:
            left[0] -= 1
            raise ZeroDivisionError("nobody planned this")
        return whole(self, *given, **named)

    monkeypatch.setattr(Controller, "step", step)


def test_a_vehicle_that_fails_is_withdrawn_and_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its place is told as withdrawn, with the reason; another vehicle's reports are as they would be without it."""
    told, alone = Told(), Told()
    for vehicle in "ab":
        told.say(*numbered(3, vehicle))
    alone.say(*numbered(3, "b"))
    breaking(monkeypatch)
    failed, anew = told.say(end(400, vehicle="a", number=17))
    assert (failed["event"], failed["vehicle"]) == ("failed", "a")
    assert failed["reason"] == "ZeroDivisionError: nobody planned this"
    assert (anew["vehicle"], anew["interval_mm"], anew["anew"]) == ("a", None, failed["reason"])
    assert told.fleet.withdrew
    assert told.fleet.tally.failed == 1
    (report,) = told.say(end(400, vehicle="b", number=17))
    assert report["interval_mm"] is not None
    assert [report] == alone.say(end(400, vehicle="b", number=17))


def test_a_vehicle_that_failed_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """The line that failed adds to the error: the cycle in which the next one comes is not used; then it is located again."""
    told = Told()
    told.say(*lines(3), end(300))
    breaking(monkeypatch)
    told.say(line(distances(400)[0]), end(400))
    answers = reports(told.say(*[text for n in range(4, 60) for text in [*lines(1, n), end(n * 100)]]))
    assert [doubted(one) for one in answers[:2]] == [True, False]
    assert answers[0]["interval_mm"] is None
    assert answers[-1]["interval_mm"] is not None


def test_a_vehicle_that_fails_again_and_again_claims_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each failure is told; no place comes out of any."""
    told = Told()
    told.say(*lines(3), end(300))
    breaking(monkeypatch, 10**6)
    answers = told.say(*[end(n * 100) for n in range(4, 10)])
    assert [one["event"] for one in answers if "event" in one] == ["failed"] * 6
    assert {json.dumps(one["interval_mm"]) for one in reports(answers)} == {"null"}


def test_a_vehicle_without_another_machine_stops(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the first state claims something, nothing goes on by itself."""
    target = Target("door", (door,), lower(door), ())
    told = Told(Fleet(Program(target), FleetSettings(500, inputs=True)))
    whole = {"speed": 0, "released": False, "blocked": False}
    told.say(json.dumps({"vehicle": "a", "cycle": 1, **whole}))

    def step_inputs(*_: Any, **__: Any) -> Any:
        raise MemoryError

    monkeypatch.setattr(Controller, "step_inputs", step_inputs)
    answers = told.say(json.dumps({"vehicle": "a", "cycle": 2, **whole}))
    assert [one["event"] for one in answers] == ["failed", "halted"]
    monkeypatch.undo()
    (refused,) = told.say(json.dumps({"vehicle": "a", "cycle": 3, **whole}))
    assert refused["reason"].startswith("halted: ")


def test_a_reader_that_fails_has_read_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever it raises: the line is refused, and is doubt for its vehicle and for no other one."""

    def raising(_: object) -> Any:
        raise KeyError("nobody planned this")

    told = Told()
    for vehicle in "ab":
        told.say(*lines(3, vehicle=vehicle), end(300, vehicle=vehicle))
    with monkeypatch.context() as patch:
        patch.setattr(messages, "record_or_fault", raising)
        (refused,) = told.say(line(distances(400)[0], vehicle="a"))
    assert refused["reason"].startswith("not read: safeloc itself failed on it (KeyError: 'nobody planned this', ")
    answers = told.say(end(400, vehicle="a"), end(400, vehicle="b"))
    assert [doubted(one) for one in answers] == [True, False]


@pytest.mark.parametrize("by_steps", [False, True])
def test_a_foreign_field_is_survived(by_steps: bool) -> None:
    """The fault that brought the whole process down: now a line of one vehicle, used or refused."""
    told = steps() if by_steps else Told()
    told.say(*(map(json.dumps, map(inputs, drive(3))) if by_steps else [*lines(3), end(300)]))
    answers = told.say(FOREIGN, *([] if by_steps else [end(400)]))
    assert answers
    assert json.loads(json.dumps(told.fleet.freeze()()))["1"]["stopped"] == ""


# ------------------------------------------------------------------ the process


class Said(Feed):
    """Lines that are there, and then an exception or the end."""

    whole = True

    def __init__(self, texts: list[str], error: BaseException | None = None) -> None:
        self.texts, self.error = texts, error

    def open(self, selector: Any) -> None:
        """Nothing to open."""

    def hold(self, held: bool) -> None:
        """They wait."""

    @property
    def again_s(self) -> float | None:
        """At once."""
        return 0.0

    def look(self) -> Iterator[Event]:
        """All of them."""
        for number, text in enumerate(self.texts, 1):
            yield Arrived("here", Line(number, text.strip().encode()))
        if self.error is not None:
            raise self.error
        yield Over()

    def close(self) -> None:
        """Nothing to close."""


class Heard(Outlet):
    """Keeps what was handed over."""

    def __init__(self) -> None:
        self.put_in: list[bytes] = []
        self.out: list[bytes] = []

    def put(self, origin: str, data: bytes, *, event: bool = False) -> None:
        """One line."""
        del origin, event
        self.put_in.append(data)

    def flush(self) -> None:
        """All of it."""
        self.out += self.put_in
        self.put_in = []

    @property
    def full(self) -> bool:
        """Never."""
        return False

    @property
    def waiting(self) -> bool:
        """Whether anything waits."""
        return bool(self.put_in)


def ran(path: Path, feed: Feed, log: int) -> Heard:
    """A loop in this process."""
    heard = Heard()
    journal = Journal(log)
    station = Station(Parts(feed, heard, Fleet(trusting(), FleetSettings(100)), journal, Saver(path)))
    Loop(station, selectors.SelectSelector(), journal).run()
    return heard


@pytest.fixture
def log(tmp_path: Path) -> Iterator[int]:
    """Where the journal goes."""
    with (tmp_path / "log").open("wb") as file:
        yield file.fileno()


def test_after_an_unplanned_exception_nothing_is_saved(tmp_path: Path, log: int) -> None:
    """The snapshot is the one from before, as after kill -9; the log says what happened."""
    path = tmp_path / "snapshot.json"
    ran(path, Said(lines(3)), log)
    before = path.read_bytes()
    with pytest.raises(RuntimeError, match="a defect"):
        ran(path, Said(lines(9), RuntimeError("a defect")), log)
    assert path.read_bytes() == before
    said = [json.loads(one) for one in (tmp_path / "log").read_bytes().splitlines()]
    assert [one["event"] for one in said[-2:]] == ["failed", "stopped"]
    assert said[-2]["why"] == "RuntimeError: a defect"
    assert "look" in said[-2]["trace"]


def test_after_a_planned_one_it_is(tmp_path: Path, log: int) -> None:
    """What was heard until then is remembered."""
    path = tmp_path / "snapshot.json"
    with pytest.raises(InputError):
        ran(path, Said(lines(9), InputError("the disk is full")), log)
    assert read_saved(path) is not None


@cache
def whole() -> Data:
    """A vehicle's part of a snapshot, with a record that waits."""
    told = Told()
    told.say(*lines(3), line(distances(400)[0]))
    part: Data = json.loads(json.dumps(told.fleet.freeze()()))["1"]
    return part


PARTS = ("controller", "lost", "count", "recount", "streak", "rhythm", "stopped", "pending")


def test_the_fields_of_a_vehicles_part() -> None:
    """None is left out of the test below."""
    assert PARTS == tuple(whole())


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("wrong", ["missing", None, -1, 1.5, "x", [], {}, [1], [None, -1], [["x"]], [[1, {"a": 1}]]])
def test_a_vehicles_part_of_a_snapshot(name: str, wrong: Any) -> None:
    """Under a checksum that fits: a field that is missing or of a wrong kind is a SnapshotError, and never an exception
    later on."""
    spoilt = {**whole(), name: wrong} if wrong != "missing" else {k: v for k, v in whole().items() if k != name}
    fleet = Fleet(trusting(), FleetSettings(100))
    fine = (name, wrong) in [("controller", None), ("stopped", "x"), ("pending", [])]
    fine = fine or (wrong == "missing" and name in ("recount", "rhythm"))
    if fine:
        fleet.restore({"1": spoilt})
    else:
        with pytest.raises(SnapshotError):
            fleet.restore({"1": spoilt})
