"""Snapshots on disk are whole, and the newest; the watchdog knows whose silence it was."""

from __future__ import annotations

import json
import os
import selectors
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError, SnapshotError
from safeloc.runtime.embedding.snapshot import sealed
from safeloc.runtime.service import saving
from safeloc.runtime.service.address import Address, address
from safeloc.runtime.service.feeds import Arrived, Feed
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.journal import MOST_A_SECOND, Journal
from safeloc.runtime.service.lines import Line
from safeloc.runtime.service.outlets import Stdout
from safeloc.runtime.service.saving import KIND, VERSION, Saver, claimed, next_turn, read_saved, write_atomically
from safeloc.runtime.service.station import Parts, Station
from safeloc.runtime.service.watchdog import Watchdog
from tests.runtime.embedding.driving import trusting
from tests.runtime.service.processes import nowhere


def content(number: int) -> Mapping[str, Any]:
    """Something to save."""
    return {"number": number}


def test_what_is_saved_is_read(tmp_path: Path) -> None:
    """And nothing is left beside it."""
    path = tmp_path / "snapshot.json"
    saver = Saver(path)
    for number in range(3):
        saver.save(lambda number=number: content(number))
        saved = read_saved(path)
        assert saved is not None
        assert saved["number"] == number
    saver.end()
    assert [one.name for one in tmp_path.iterdir()] == ["snapshot.json"]


def test_nothing_saved_yet(tmp_path: Path) -> None:
    """Is no error."""
    assert read_saved(tmp_path / "absent") is None


def test_what_cannot_be_read(tmp_path: Path) -> None:
    """A folder, half a file, another kind: each said with the file's name."""
    with pytest.raises(InputError, match="cannot be read"):
        read_saved(tmp_path)
    path = tmp_path / "snapshot.json"
    path.write_bytes(sealed(content(1), KIND, VERSION)[:-3])
    with pytest.raises(SnapshotError, match=r"snapshot\.json: the snapshot is damaged"):
        read_saved(path)
    path.write_bytes(sealed(content(1), KIND, VERSION + 1))
    with pytest.raises(SnapshotError, match="has version 2"):
        read_saved(path)


@pytest.mark.parametrize("moment", ["write", "fsync", "replace"])
def test_a_write_that_fails_leaves_the_old_one(tmp_path: Path, moment: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whenever it stops: the file is the old one, whole."""
    path = tmp_path / "snapshot.json"
    write_atomically(path, b"old")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    if moment == "replace":
        monkeypatch.setattr(Path, "replace", full)
    elif moment == "fsync":
        monkeypatch.setattr(saving.os, "fsync", full)
    else:
        monkeypatch.setattr(Path, "open", full)
    with pytest.raises(OSError, match="No space"):
        write_atomically(path, b"new")
    monkeypatch.undo()
    assert path.read_bytes() == b"old"


def test_a_disk_that_is_full_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who waits for it gets the reason, and it can be tried again."""
    saver = Saver(tmp_path / "snapshot.json")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(saving, "write_atomically", full)
    with pytest.raises(InputError, match=r"snapshot\.json: the snapshot cannot be written: No space left on device\.$"):
        saver.save(lambda: content(1))
    monkeypatch.undo()
    saver.save(lambda: content(2))
    assert saver.failed is None
    saver.end()


def test_of_several_that_wait_the_newest_is_written(tmp_path: Path) -> None:
    """Older ones are passed over, and nobody waits for ever."""
    saver, written, go = Saver(tmp_path / "snapshot.json"), [], threading.Event()

    def slow() -> Mapping[str, Any]:
        go.wait()
        written.append(0)
        return content(0)

    def noted(number: int) -> Mapping[str, Any]:
        written.append(number)
        return content(number)

    saver.ask(slow)
    while not saver.busy:
        pass
    for number in (1, 2):
        saver.ask(lambda number=number: noted(number))
    go.set()
    saver.save(lambda: noted(3))
    saver.end()
    assert written[-1] == 3
    assert 1 not in written
    saved = read_saved(tmp_path / "snapshot.json")
    assert saved is not None
    assert saved["number"] == 3


def test_a_file_is_claimed_once(tmp_path: Path) -> None:
    """And again when the first one has let go."""
    path = tmp_path / "snapshot.json"
    with claimed(path), pytest.raises(InputError, match="another process saves its snapshots there"), claimed(path):
        pass
    with claimed(path), claimed(None):
        pass


def test_silence_is_noticed() -> None:
    """A period and the grace after the last cycle, and then every period."""
    watchdog = Watchdog(0.3, 0.1)
    watchdog.ended("a", 0.0)
    times = [number / 20 for number in range(12)]
    assert [now for now in times if list(watchdog.overdue(now))] == [0.3, 0.4, 0.5]


def test_who_speaks_is_not_overdue() -> None:
    """Each vehicle has its own time; one that is forgotten has none."""
    watchdog = Watchdog(0.3, 0.1)
    for name in "abc":
        watchdog.ended(name, 0.0)
    list(watchdog.overdue(0.1))
    watchdog.ended("a", 0.2)
    watchdog.forget("c")
    list(watchdog.overdue(0.25))
    assert list(watchdog.overdue(0.35)) == ["b"]


def test_time_in_which_the_process_did_not_run_is_nobodys_silence() -> None:
    """After a stop of the process the vehicles have their time again."""
    watchdog = Watchdog(0.3, 0.1)
    watchdog.ended("a", 0.0)
    list(watchdog.overdue(0.1))
    assert list(watchdog.overdue(60.0)) == []
    assert list(watchdog.overdue(60.15)) == []
    assert list(watchdog.overdue(60.25)) == ["a"]


def test_it_looks_often_enough() -> None:
    """It never sleeps so long that it would take its own sleep for a stop."""
    watchdog = Watchdog(0.3, 0.1)
    assert watchdog.next_s(0.0) is None
    watchdog.ended("a", 0.0)
    assert watchdog.next_s(0.0) == 0.15
    assert watchdog.next_s(0.25) == pytest.approx(0.05)
    assert watchdog.next_s(9.0) == 0.0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("9000", Address("127.0.0.1", 9_000)),
        ("localhost:0", Address("127.0.0.1", 0)),
        ("127.0.0.5:1", Address("127.0.0.5", 1)),
        ("[::1]:7", Address("::1", 7)),
    ],
)
def test_addresses(text: str, expected: Address) -> None:
    """Of this machine."""
    assert address(text) == expected


@pytest.mark.parametrize(
    "text", ["", "x", "-1", "65536", "0.0.0.0:1", "10.0.0.1:1", "[::]:1", "a.example:1", "1:2:3", "٣"]
)
def test_addresses_elsewhere(text: str) -> None:
    """Refused."""
    with pytest.raises(InputError):
        address(text)


def test_the_log_never_waits() -> None:
    """A reader that does not read costs lines, and they are counted; so are those beyond twenty a second."""
    reading, writing = os.pipe()
    try:
        journal = Journal(writing)
        for number in range(3_000):
            journal.info(f"event {number}", text="x" * 100)
        heard = os.read(reading, 1 << 20)
        journal.info("again")
        last = json.loads(os.read(reading, 1 << 20))
        assert heard.count(b"\n") < 3_000
        assert last["left_out"] == 3_000 - heard.count(b"\n")
        for _ in range(MOST_A_SECOND + 10):
            journal.warning("much")
        assert os.read(reading, 1 << 20).count(b'"much"') <= 2 * MOST_A_SECOND
    finally:
        os.close(reading)
        os.close(writing)


@pytest.mark.parametrize("field", ["x" * 20_000, "\U0001f682" * 5_000, ["y" * 300] * 100, {"a": "b" * 9_000}])
def test_an_event_is_one_line_however_long(field: object) -> None:
    """What is too long is shortened, and marked; the next event is a line of its own."""
    reading, writing = os.pipe()
    try:
        journal = Journal(writing)
        journal.warning("refused", reason=field, line=7, **{f"more{n}": field for n in range(40)})
        journal.info("next")
        first, second = [json.loads(one) for one in os.read(reading, 1 << 20).splitlines()]
        assert (first["event"], first["shortened"], second["event"]) == ("refused", True, "next")
        journal.warning("refused", reason=field, line=7)
        one = json.loads(os.read(reading, 1 << 20))
        assert (one["line"], one["shortened"]) == (7, True)
    finally:
        os.close(reading)
        os.close(writing)


def test_a_huge_snapshot_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is one written that could not be read back."""
    monkeypatch.setattr(saving, "LONGEST", 1_000)
    path = tmp_path / "snapshot.json"
    path.write_bytes(b"x" * 1_001)
    with pytest.raises(SnapshotError, match=r"snapshot\.json: over 1000 bytes"):
        read_saved(path)
    with pytest.raises(OSError, match="1001 bytes, but only 1000"):
        write_atomically(path, b"y" * 1_001)
    assert path.read_bytes() == b"x" * 1_001


@pytest.mark.parametrize("device", ["/dev/full", "/dev/zero"])
def test_a_device_is_no_place_for_snapshots(device: str) -> None:
    """It is refused before it is read, and no lock is left beside it."""
    with pytest.raises(InputError, match="a device or a pipe; name a file"), claimed(Path(device)):
        pass
    assert not Path(f"{device}.lock").exists()


def test_time_in_which_nobody_could_be_heard_counts_for_nobody() -> None:
    """While a file is read that was written before, nobody is silent."""
    watchdog = Watchdog(0.3, 0.1)
    watchdog.ended("a", 0.0)
    for now in (0.1, 0.2, 0.4, 0.6):
        watchdog.pass_over(now)
    assert list(watchdog.overdue(0.7)) == []
    assert list(watchdog.overdue(0.85)) == ["a"]


@given(st.floats(0, 1e9), st.sampled_from([0.01, 0.5, 1.0, 10.0]), st.integers(0, 7))
def test_snapshots_take_turns(now: float, every_s: float, turn: int) -> None:
    """Each is due within a period, and a period after it again; each turn is an eighth of a period after the one before."""
    due = next_turn(now, every_s, turn / 8)
    slack = 1e-6 + now * 1e-15
    assert now - slack <= due <= now + every_s + slack
    assert next_turn(due + slack, every_s, turn / 8) == pytest.approx(due + every_s, abs=3 * slack)
    after = next_turn(due + slack, every_s, (turn + 1) / 8 % 1)
    assert after == pytest.approx(due + every_s / 8, abs=3 * slack)


class Quiet(Feed):
    """Nothing comes of itself."""

    def open(self, selector: selectors.BaseSelector) -> None:
        """Nothing is to be opened."""

    def hold(self, held: bool) -> None:
        """Nobody has to wait."""

    def close(self) -> None:
        """Nothing is to be closed."""


@pytest.mark.parametrize("turn", [0.0, 0.5])
def test_a_station_saves_in_the_turn_of_its_feed(tmp_path: Path, turn: float) -> None:
    """After a line it waits until then; periods are long, so that a busy machine changes nothing."""
    feed, selector, period_s = Quiet(), selectors.PollSelector(), 1_000.0
    feed.save_turn = turn
    fleet, journal = Fleet(trusting(), FleetSettings(100)), Journal(nowhere())
    station = Station(Parts(feed, Stdout(selector), fleet, journal, Saver(tmp_path / "kept"), period_s))
    assert station.patience_s() is None
    station.take(iter([Arrived("", Line(1, b"no line at all", ""), "")]))
    left_s = station.patience_s()
    assert left_s is not None
    assert 0.0 < left_s <= period_s
    early_s = (turn * period_s - (time.monotonic() + left_s)) % period_s
    assert min(early_s, period_s - early_s) < 60.0
