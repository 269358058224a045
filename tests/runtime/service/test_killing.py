"""Killed at any moment, the process goes on with what the data justify: no wider, no narrower, nothing risen again."""

from __future__ import annotations

import gzip
import json
import random
import signal
import socket
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from safeloc.runtime.embedding import Controller
from safeloc.runtime.service.clock_lag import AT_ONCE_CYCLES
from tests.cli.calling import Call, caller
from tests.runtime.embedding.driving import distances, drive, trusting
from tests.runtime.service.processes import (
    SAFELOC,
    Data,
    command,
    lines,
    numbered,
    ran,
    read,
    reports,
    running,
    wait_for,
)
from tests.shipped_recordings import shipped

CYCLES = 400


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs `safeloc ARGUMENTS` in this process."""
    return caller(monkeypatch, capsys)


def in_a_line(text: str) -> str:
    """A message without its frame and ends of lines."""
    return " ".join(text.replace("│", " ").split())


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The reports of a run that nobody killed."""
    return ran(tmp_path_factory.mktemp("whole"), said="".join(lines(CYCLES))).stdout


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 6))])
def test_a_file_is_gone_on_with_as_if_nothing_had_been(tmp_path: Path, seed: int, uninterrupted: bytes) -> None:
    """Reading a file that grows, killed again and again: the file of reports is that of an uninterrupted run, to the byte."""
    chance = random.Random(seed)
    source, sink, snapshot = (tmp_path / name for name in ("lines.jsonl", "reports.jsonl", "snapshot.json"))
    source.write_text("", encoding="utf-8")
    arguments = ("--from", f"file:{source}", "--to", f"file:{sink}", "--snapshot", str(snapshot))
    left = lines(CYCLES)
    for _ in range(3):
        with running(tmp_path, *arguments, "--snapshot-every-ms", "10") as run:
            run.logged("started")
            for _ in range(chance.randrange(1, 12)):
                count = chance.randrange(1, 60)
                with source.open("a", encoding="utf-8") as file:
                    text = "".join(left[:count])
                    cut = chance.randrange(len(text) + 1)
                    file.write(text[:cut])
                    file.flush()
                    time.sleep(chance.random() * 0.03)
                    file.write(text[cut:])
                left = left[count:]
            time.sleep(chance.random() * 0.05)
            assert run.end(signal.SIGKILL) == -signal.SIGKILL
    with source.open("a", encoding="utf-8") as file:
        file.write("".join(left))
    done = ran(tmp_path, *arguments, "--until-end")
    assert done.returncode == 0, done.stderr
    assert read(done.stderr)[0]["event"] == "resumed"
    assert sink.read_bytes() == uninterrupted


@pytest.mark.slow
@pytest.mark.parametrize("name", ["metro-silent-odometer-corrupted-balise", "freight-fibre-error-no-satellites"])
def test_the_whole_localizer_goes_on_as_if_nothing_had_been(tmp_path: Path, name: str) -> None:
    """All sources, arbitration and both links, killed once before and once after what goes wrong: the reports are, to the
    byte, those of a run that nobody killed, and a place is known after the last kill."""
    chance = random.Random(name)
    text = gzip.decompress((shipped(f"localizer-{name}")).read_bytes()).decode()
    whole = ran(tmp_path, "--inputs", said=text, config="", machine="localizer").stdout
    source, sink, snapshot = (tmp_path / one for one in ("lines.jsonl", "reports.jsonl", "snapshot.json"))
    source.write_text("", encoding="utf-8")
    arguments = ("--inputs", "--from", f"file:{source}", "--to", f"file:{sink}", "--snapshot", str(snapshot))
    cuts = [0, len(text) * 2 // 3 + chance.randrange(999), len(text) * 7 // 8 + chance.randrange(999)]
    for begin, end in pairwise(cuts):
        with running(tmp_path, *arguments, "--snapshot-every-ms", "10", config="", machine="localizer") as run:
            run.logged("started")
            half = begin + chance.randrange(end - begin)
            for part in (text[begin:half], text[half:end]):
                with source.open("a", encoding="utf-8") as file:
                    file.write(part)
                wait_for(lambda: sink.exists() and sink.stat().st_size > 0, "no report")
                time.sleep(chance.random() * 0.3)
            assert run.end(signal.SIGKILL) == -signal.SIGKILL
        held = kept_cycles(snapshot)
        assert 0 < held < len(read(whole))
    with source.open("a", encoding="utf-8") as file:
        file.write(text[cuts[-1] :])
    done = ran(tmp_path, *arguments, "--until-end", config="", machine="localizer")
    assert done.returncode == 0, done.stderr
    assert read(done.stderr)[0]["event"] == "resumed"
    assert sink.read_bytes() == whole
    assert any(one["interval_mm"] is not None for one in read(whole)[held:])


class Talk:
    """A vehicle's computer, over TCP."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=20)
        self._file = self.socket.makefile("rb")

    def say(self, *said: str) -> None:
        """Lines."""
        self.socket.sendall("".join(said).encode())

    def hear(self) -> Data:
        """The next line back."""
        return dict(json.loads(self._file.readline()))

    def close(self) -> None:
        """Hang up."""
        self._file.close()
        self.socket.close()


def by_hand(given: dict[int, list[Any]], last: int) -> list[Data]:
    """Reports of a controller that got these records in these cycles, and nothing in the others."""
    controller = Controller(trusting())
    return [controller.step(given.get(cycle, [])).as_data() for cycle in range(1, last + 1)]


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 8))])
def test_what_was_missed_adds_error(tmp_path: Path, seed: int) -> None:
    """Over TCP, killed after a snapshot: afterwards every report is that of an uninterrupted machine which got nothing in
    the cycles that are lost, and the time between adds to the error. Lines go on by number, so none is doubted for nothing; where
    the time between is long, lines of two cycles have to agree on it."""
    chance = random.Random(seed)
    snapshot = tmp_path / "snapshot.json"
    arguments = ("--from", "tcp:0", "--snapshot", str(snapshot), "--snapshot-every-ms", "10")
    made = [numbered_cycle(number, records) for number, records in enumerate(drive(30), 1)]
    killed_at, again_at = 4 + chance.randrange(10), 14 + chance.randrange(8)
    with running(tmp_path, *arguments) as run:
        talk = Talk(run.port())
        for cycle in range(killed_at):
            talk.say(*made[cycle])
            talk.hear()
        wait_for(snapshot.exists, "no snapshot")
        time.sleep(chance.random() * 0.05)
        run.end(signal.SIGKILL)
        talk.close()
    held = kept_cycles(snapshot)
    assert held <= killed_at
    last = again_at + 4
    with running(tmp_path, *arguments) as run:
        talk = Talk(run.port())
        talk.say(*(text for cycle in made[again_at:last] for text in cycle))
        heard: list[Data] = []
        while not heard or heard[-1]["cycle"] < last:
            heard += reports([talk.hear()])
        talk.close()
    believed_at_once = again_at - held <= AT_ONCE_CYCLES
    doubtful = again_at + 1 if believed_at_once else last - 1
    given = {cycle: records for cycle, records in enumerate(drive(30), 1) if cycle <= held or doubtful < cycle <= last}
    expected = by_hand(given, last)[held:]
    assert [interval(one) for one in heard] == [interval(one) for one in expected]
    assert [one["outputs"] for one in heard] == [one["outputs"] for one in expected]
    (told,) = [one for one in heard if one["cycle"] == doubtful]
    assert any(fault["reason"] == "LOST" for fault in told["rejections"])


def numbered_cycle(number: int, records: list[Any]) -> list[str]:
    """The lines of one cycle of numbered()."""
    whole = numbered(number)
    return whole[-len(records) - 1 :]


def kept_cycles(snapshot: Path) -> int:
    """How many cycles a snapshot holds."""
    controller = json.loads(snapshot.read_text(encoding="utf-8"))["vehicles"]["1"]["controller"]
    return int(json.loads(controller)["done"])


def interval(report: Data) -> Any:
    """What is reported."""
    return report["interval_mm"]


@pytest.mark.thorough
def test_lines_that_go_on_by_number_are_not_doubted(tmp_path: Path) -> None:
    """A process that was stopped in order and misses no line goes on as if it had not been stopped."""
    arguments = ("--from", "tcp:0", "--snapshot", str(tmp_path / "snapshot.json"))
    made = [numbered_cycle(number, records) for number, records in enumerate(drive(12), 1)]
    heard: list[Data] = []
    for part in (made[:5], made[5:]):
        with running(tmp_path, *arguments) as run:
            talk = Talk(run.port())
            for cycle in part:
                talk.say(*cycle)
                heard.append(talk.hear())
            assert run.end(signal.SIGTERM) == 0
            talk.close()
    expected = by_hand(dict(enumerate(drive(12), 1)), 12)
    assert [{**one, "vehicle": "1"} for one in expected] == heard


def test_a_withdrawn_place_stays_withdrawn(tmp_path: Path) -> None:
    """Whatever was reported before the kill: once a place was withdrawn, none is reported after it without a reference,
    though the snapshot in time would have been taken much later."""
    arguments = ("--from", "tcp:0", "--snapshot", str(tmp_path / "snapshot.json"), "--snapshot-every-ms", "3600000")
    made = [numbered_cycle(number, records) for number, records in enumerate(drive(3), 1)]
    with running(tmp_path, *arguments) as run:
        talk = Talk(run.port())
        talk.say(*made[0], *made[1], *made[2], *ending(13))
        heard = [talk.hear() for _ in range(13)]
        run.end(signal.SIGKILL)
        talk.close()
    assert interval(heard[2]) is not None
    assert interval(heard[-1]) is None
    with running(tmp_path, *arguments) as run:
        talk = Talk(run.port())
        talk.say(*ending(16, 40))
        assert [interval(talk.hear()) for _ in range(3)] == [None] * 3
        talk.close()


def ending(cycle: int, number: int | None = None) -> list[str]:
    """A line that says that a cycle is over."""
    said: Data = {"kind": "cycle", "time_ms": cycle * 100}
    count = len(numbered(3)) + 1 if number is None else number
    return [json.dumps({**said, "number": count}) + "\n"]


@pytest.mark.thorough
def test_a_snapshot_of_something_else_is_refused(tmp_path: Path) -> None:
    """Exit code 2 and what to do; with --fresh it begins anew."""
    arguments = ("--snapshot", str(tmp_path / "snapshot.json"))
    assert ran(tmp_path, *arguments, said="".join(lines(5))).returncode == 0
    other = "trust_first_marker = true\ntolerance_mm = 20000\n"
    refused = ran(tmp_path, *arguments, said="".join(lines(5)), config=other)
    assert refused.returncode == 2
    assert b"of another configuration (tolerance_mm 30000, here 20000)" in refused.stderr
    assert b"To start from the initial state: --fresh." in refused.stderr
    assert ran(tmp_path, *arguments, "--fresh", said="".join(lines(5)), config=other).returncode == 0


def test_a_damaged_snapshot_is_refused(tmp_path: Path, call: Call) -> None:
    """What is not whole was not written by this process."""
    snapshot = tmp_path / "snapshot.json"
    (tmp_path / "said.jsonl").write_text("".join(lines(5)), encoding="utf-8")
    sources = ("--from", f"file:{tmp_path / 'said.jsonl'}", "--until-end", "--to", f"file:{tmp_path / 'reports.jsonl'}")
    arguments = (*sources, "--snapshot", str(snapshot))
    assert call(*command(tmp_path, *arguments)[len(SAFELOC) :]).code == 0
    snapshot.write_bytes(snapshot.read_bytes()[:-20])
    refused = call(*command(tmp_path, *arguments)[len(SAFELOC) :])
    assert refused.code == 2
    assert "the snapshot is damaged" in in_a_line(refused.err)


def test_two_processes_do_not_share_a_snapshot(tmp_path: Path, call: Call) -> None:
    """The second one is told so."""
    arguments = ("--from", "tcp:0", "--snapshot", str(tmp_path / "snapshot.json"))
    with running(tmp_path, *arguments) as run:
        run.port()
        second = call(*command(tmp_path, *arguments)[len(SAFELOC) :])
        assert second.code == 2
        assert "another process saves its snapshots there" in in_a_line(second.err)


@pytest.mark.thorough
def test_standard_input_that_goes_on_is_doubted_once(tmp_path: Path) -> None:
    """A pipe has no positions: what came while nobody listened may be lost, and the cycles at both ends are doubtful."""
    arguments = ("--snapshot", str(tmp_path / "snapshot.json"))
    ran(tmp_path, *arguments, said="".join(lines(10)))
    heard = reports(read(ran(tmp_path, *arguments, said="".join(lines(10, 11))).stdout))
    assert [one["time_ms"] for one in heard] == [100 * cycle for cycle in range(11, 21)]
    assert ["*" in [fault["channel"] for fault in one.get("rejections", ())] for one in heard] == [True] + [False] * 9
    whole = by_hand(dict(enumerate(drive(20), 1)), 20)
    for one, same in zip(heard, whole[10:], strict=True):
        assert interval(one)[0] <= interval(same)[0]
        assert interval(same)[1] <= interval(one)[1]


def test_lines_are_numbered_through() -> None:
    """What the other tests say: the lines of a cycle end with its end, and hold the distances."""
    first = [json.loads(one) for one in numbered_cycle(1, distances(100))]
    assert [one["kind"] for one in first] == ["distance"] * 4 + ["cycle"]
    assert [one["number"] for one in first] == [1, 2, 3, 4, 5]
