"""A safety oracle over whole streams: whatever is done to the lines of a drive, a reported interval holds the truth.

The stream keeps what is assumed: distances are right, markers stand where they are said to stand, and a time that is
wrong is wrong of the line only, not of what was measured. So markers keep their times; all else is dropped, doubled,
swapped, cut, joined, set ahead, renumbered, renamed, spoken by another peer, or lost with the process.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.runtime.service.by_steps import StepsVehicle
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.lines import Line, LineCutter
from safeloc.runtime.service.vehicle import Output
from tests.runtime.embedding.driving import STEP_MM, drive, trusting
from tests.runtime.service.test_fleet import inputs

CYCLES = 120
Spoil = Callable[[list[bytes], int, random.Random], None]
"""Lines, a place among them, chance: changes the lines there."""


def truth_mm(time_ms: int) -> float:
    """Where the front of the train is: the marker of cycle 2 was passed 310 mm before its end."""
    return 250_000 + 310 + (time_ms - 200) * STEP_MM / 100


def dropped(lines: list[bytes], at: int, _: random.Random) -> None:
    """A line does not arrive."""
    del lines[at]


def doubled(lines: list[bytes], at: int, _: random.Random) -> None:
    """Or twice."""
    lines.insert(at, lines[at])


def swapped(lines: list[bytes], at: int, chance: random.Random) -> None:
    """Or later than another one."""
    lines.insert(min(len(lines), at + chance.randrange(1, 30)), lines.pop(at))


def cut(lines: list[bytes], at: int, chance: random.Random) -> None:
    """Or in part."""
    lines[at] = lines[at][: chance.randrange(len(lines[at]) or 1)]


def joined(lines: list[bytes], at: int, chance: random.Random) -> None:
    """Or with the line end damaged of it and some that follow."""
    count = chance.randrange(2, 40)
    lines[at : at + count] = [chance.choice([b"\r", b"", b" "]).join(lines[at : at + count])]


def garbled(lines: list[bytes], at: int, chance: random.Random) -> None:
    """Or with one name or value none any more."""
    lines[at] = lines[at].replace(chance.choice([b'"distance_mm"', b"1200", b'"kind"', b'"time_ms"']), b"NaN", 1)


def _fields(line: bytes) -> dict[str, Any]:
    """What the line says; nothing where it was spoilt before."""
    try:
        return dict(json.loads(line))
    except (ValueError, TypeError):
        return {}


def ahead(lines: list[bytes], at: int, chance: random.Random) -> None:
    """Or with a time up to two minutes ahead, if it is no marker's."""
    fields = _fields(lines[at])
    if type(fields.get("time_ms")) is int and fields.get("kind") in ("distance", "cycle"):
        lines[at] = json.dumps({**fields, "time_ms": fields["time_ms"] + chance.randrange(1_100, 120_000)}).encode()


def renumbered(lines: list[bytes], at: int, chance: random.Random) -> None:
    """Or with a wrong number; or a line of nobody with one is put in."""
    number = chance.choice([1, 2, 10**6, 2**62, chance.randrange(1, 900)])
    lines.insert(at, json.dumps({"number": number, "kind": "cycle", "time_ms": 100}).encode())


def foreign(lines: list[bytes], at: int, chance: random.Random) -> None:
    """Or with a field that is another kind's."""
    if lines[at].endswith(b"}"):
        name = chance.choice(["marker", "value", "pulses", "position_nm", "vehicle", "cycle", "number"])
        lines[at] = lines[at][:-1] + f', "{name}": {chance.choice(["7", "null", "[]"])}}}'.encode()


KILLED, LEFT = b"\x00killed", b"\x00left"


def killed(lines: list[bytes], at: int, chance: random.Random) -> None:
    """The process goes on from an earlier snapshot, and what came since is gone."""
    lines.insert(at, KILLED + str(chance.randrange(0, 60)).encode())


def left(lines: list[bytes], at: int, _: random.Random) -> None:
    """The peer goes away and comes back."""
    lines.insert(at, LEFT)


SPOILS: tuple[Spoil, ...] = (
    dropped, doubled, swapped, cut, joined, garbled, ahead, renumbered, foreign, killed, left,
)  # fmt: skip


def said(way: str) -> list[bytes]:
    """A drive as lines: records with numbers or without, steps with cycle numbers or without."""
    made: list[dict[str, Any]] = []
    for cycle, records in enumerate(drive(CYCLES), 1):
        if way == "steps":
            made.append({**inputs(records), "truth_mm": int(truth_mm(cycle * 100))})
        elif way == "cycles":
            made.append({"cycle": cycle, **inputs(records)})
        else:
            made += [record.model_dump(exclude_none=True) for record in records]
            made.append({"kind": "cycle", "time_ms": cycle * 100})
    counted = [{"number": number, **one} for number, one in enumerate(made, 1)] if way == "numbered" else made
    return [json.dumps(one).encode() for one in counted]


def _number(text: bytes) -> int:
    """The digits that a killing begins with: it may have been cut, or joined with lines that are lost with it."""
    digits = len(text) - len(text.lstrip(b"0123456789"))
    return int(text[:digits] or b"0")


class Run:
    """A fleet that is told lines, killed and left; its reports have to hold the truth."""

    def __init__(self, way: str) -> None:
        self.by_steps = way in ("steps", "cycles")
        self.fleet, self.number, self.origin = self._fleet(), 0, 0
        self.snapshots: list[str] = []
        self.reports = self.places = 0

    def _fleet(self) -> Fleet:
        return Fleet(trusting(), FleetSettings(100, inputs=self.by_steps))

    def hear(self, line: Line) -> list[dict[str, Any]]:
        """One line, and what is told."""
        if line.text.startswith(LEFT):
            self.fleet.gone(str(self.origin), "it went away")
            self.origin += 1
            return []
        if line.text.startswith(KILLED):
            self._go_on(_number(line.text[len(KILLED) :]))
            return []
        told = self.fleet.handle(str(self.origin), line, from_start=False)
        self.snapshots.append(json.dumps(self.fleet.freeze()()))
        return told

    def _go_on(self, back: int) -> None:
        """Nothing that withdrew a place is unsaid: the loop saves before it tells (tests/runtime/service/test_killing.py)."""
        if self.snapshots:
            self.fleet = self._fleet()
            self.fleet.restore(json.loads(self.snapshots[max(0, len(self.snapshots) - 1 - back)]), "it was killed")


def wrong(way: str, lines: list[bytes]) -> Iterator[str]:
    """Reports whose interval misses the truth of the line's own time (of steps without one: see the test)."""
    run, cutter = Run(way), LineCutter()
    for line in cutter.feed(b"\n".join(lines) + b"\n"):
        for one in run.hear(line):
            run.reports += "mode" in one
            interval = one.get("interval_mm")
            if interval is not None:
                run.places += 1
                if not interval[0] <= truth_mm(one["time_ms"]) <= interval[1]:
                    yield f"line {line.number}: {one}"


@pytest.mark.parametrize("way", ["records", "numbered", "cycles"])
def test_a_drive_that_nobody_spoils_is_located(way: str) -> None:
    """What the others say: the oracle's truth is the drive's, and places come out of it."""
    run = Run(way)
    told = [one for number, text in enumerate(said(way), 1) for one in run.hear(Line(number, text))]
    places = [one for one in told if one.get("interval_mm") is not None]
    assert len(places) > CYCLES // 2
    assert all(one["interval_mm"][0] <= truth_mm(one["time_ms"]) <= one["interval_mm"][1] for one in places)


LOSSLESS = (cut, joined, garbled, renumbered, foreign, killed, left, ahead)
"""What may happen to lines without numbers: no line vanishes without a trace, none comes twice or late."""


@given(st.sampled_from(["numbered", "cycles", "records"]), st.integers(0, 2**32), st.integers(0, 30))
@settings(max_examples=settings.default.max_examples // 4)
def test_a_place_holds_the_truth(way: str, seed: int, faults: int) -> None:
    """Whatever happens to the lines, of what shows by numbers or by itself."""
    chance, lines = random.Random(seed), said(way)
    for _ in range(faults):
        spoil = chance.choice(LOSSLESS if way == "records" else SPOILS)
        spoil(lines, chance.randrange(len(lines)), chance)
    assert list(wrong(way, lines)) == []


BY_STEPS = (cut, joined, garbled, killed, left)
"""What may happen to steps without numbers, as above; they carry the truth, for their time is not said."""


def missed_truths(faults: int, seed: int) -> tuple[int, int]:
    """Reports of a drive of steps without numbers, and those of them that missed the truth beside them."""
    chance, lines, run, cutter = random.Random(seed), said("steps"), Run("steps"), LineCutter()
    for _ in range(faults):
        chance.choice(BY_STEPS)(lines, chance.randrange(len(lines)), chance)
    told = [one for line in cutter.feed(b"\n".join(lines) + b"\n") for one in run.hear(line)]
    return sum("truth" in one for one in told), sum(one.get("truth") == "WRONG" for one in told)


@given(st.integers(0, 2**32), st.integers(0, 12))
@settings(max_examples=25)
def test_a_place_of_steps_holds_the_truth(seed: int, faults: int) -> None:
    """Also where nothing says how many steps were lost."""
    compared, missed = missed_truths(faults, seed)
    assert (compared > 0, missed) == (True, 0)


def test_the_oracle_sees_a_loss_that_adds_too_little_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """With what cannot be read taken for one step, as it once was, places miss the truth."""

    def as_one_step(self: StepsVehicle, why: str) -> list[Output]:
        self._missed(why)
        return self._outputs()

    monkeypatch.setattr(StepsVehicle, "missed", as_one_step)
    assert sum(missed_truths(8, seed)[1] for seed in range(20)) > 0


@pytest.mark.slow
def test_many_lines() -> None:
    """Two million lines, spoilt at one in ten to one in a thousand."""
    chance, heard = random.Random(13), 0
    while heard < 2_000_000:
        way = chance.choice(["numbered", "cycles", "records"])
        lines = said(way)
        for _ in range(chance.choice([1, 5, 20, 60])):
            if not lines:  # a loss may take all that are left
                break
            spoil = chance.choice(LOSSLESS if way == "records" else SPOILS)
            spoil(lines, chance.randrange(len(lines)), chance)
        heard += len(lines)
        assert list(wrong(way, lines)) == []
