"""The process as it runs: sockets, signals, readers that do not read, files that are replaced, and the wall clock."""

from __future__ import annotations

import gzip
import json
import os
import signal
import socket
import subprocess
import time
from pathlib import Path

import pytest

from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Controller
from safeloc.runtime.streams.records import TruthRecord
from safeloc.shipped_machines import ENTRIES
from tests.cli.calling import Call, caller
from tests.runtime.embedding.driving import drive, trusting
from tests.runtime.service.processes import (
    PATIENCE_S,
    SAFELOC,
    STARTED,
    Data,
    command,
    line,
    lines,
    numbered,
    ran,
    read,
    reports,
    run_to_its_end,
    running,
    wait_for,
)
from tests.runtime.service.test_killing import Talk


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs `safeloc ARGUMENTS` in this process."""
    return caller(monkeypatch, capsys)


STREAM = ENTRIES["odometry"].make(OdometryConfig()).streams[0]


def by_hand(cycles: int) -> list[Data]:
    """Reports of a controller that was given the drive."""
    controller = Controller(trusting())
    return [{"vehicle": "1", **controller.step(records).as_data()} for records in drive(cycles)]


def test_records_in_reports_out(tmp_path: Path) -> None:
    """A whole run over pipes, to its end, started as a shell would; the log says how it went."""
    done = run_to_its_end([*STARTED, *command(tmp_path)[len(SAFELOC) :]], input="".join(lines(30)).encode())
    assert done.returncode == 0
    assert read(done.stdout) == by_hand(30)
    log = read(done.stderr)
    assert [one["event"] for one in log] == ["started", "stopped"]
    assert {"lines": 121, "cycles": 30, "refused": 0, "rejections": 0, "wrong": 0}.items() <= log[-1].items()


def test_a_shipped_step_stream_is_read_as_it_is(tmp_path: Path, call: Call) -> None:
    """Its header, its ghosts and its truth: the reports are compared with the truth, and hold it."""
    text = gzip.decompress(STREAM.read_bytes()).decode()
    source, sink = tmp_path / "steps.jsonl", tmp_path / "reports.jsonl"
    source.write_text(text, encoding="utf-8")
    arguments = ("--inputs", "--from", f"file:{source}", "--until-end", "--to", f"file:{sink}")
    done = call(*command(tmp_path, *arguments, config="")[len(SAFELOC) :])
    assert done.code == 0, done.err
    found = reports(read(sink.read_bytes()))
    assert len(found) == len(text.splitlines()) - 1
    assert {one["truth"] for one in found} == {"contained", "INVALID"}


def code_of(call: Call, folder: Path, said: str) -> int:
    """The exit code of a whole run over a file, in this process."""
    source = folder / "said.jsonl"
    source.write_text(said, encoding="utf-8")
    arguments = ("--from", f"file:{source}", "--until-end", "--to", f"file:{folder / 'reports.jsonl'}")
    return call(*command(folder, *arguments)[len(SAFELOC) :]).code


@pytest.mark.parametrize(("metres", "code"), [(252, 0), (900, 1)])
def test_the_exit_code_is_that_of_the_truth(tmp_path: Path, call: Call, metres: int, code: int) -> None:
    """1 where a report misses the truth beside it, 0 where none does."""
    truth = line(TruthRecord(time_ms=300, position_nm=metres * 10**9))
    assert code_of(call, tmp_path, "".join([*lines(3), truth])) == code


def test_nothing_decided(tmp_path: Path, call: Call) -> None:
    """Exit code 3 where no cycle ended."""
    assert code_of(call, tmp_path, "{\n") == 3


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--from", "tcp:99999"), "is no port"),
        (("--from", "tcp:8.8.8.8:9000"), "8.8.8.8 is not on this computer"),
        (("--from", "udp:host:9000"), "is no address"),
        (("--from", "mail"), "choose stdin, file:PATH, tcp:PORT, udp:PORT, proxy:PORT or mqtts://HOST/PREFIX"),
        (("--to", "back"), "choose stdout, file:PATH, or back where"),
        (("--until-end",), "--until-end is for --from file:PATH"),
        (("--expect", "front_wheel"), "give CHANNEL=N"),
        (("--vehicle", "12"), "give ID=FILE"),
        (("--first", "mode=FRONT"), "give NAME=VALUE"),
        (("--first", "mode=1"), "mode starts at 0 by declaration"),
        (("--period-ms", "50"), "configured for cycles of 100 ms, not 50 ms"),
        (("--from", "file:absent", "--until-end"), "absent: no such file"),
        (("--from", "file:run.jsonl.gz"), "run.jsonl.gz: a compressed file cannot be followed line by line; unpack it"),
        (("--to", "file:absent/there"), "cannot be written"),
        (("--snapshot", "absent/there"), "snapshots cannot be written there"),
        (("--snapshot", "."), "a folder; name a file"),
        (("--from", "file:one", "--to", "file:./one"), "one: given for --from and for --to; give each its own file"),
        (("--from", "file:one", "--snapshot", "one", "--fresh"), "given for --from and for --snapshot"),
        (("--to", "file:one", "--snapshot", "one"), "given for --to and for --snapshot"),
    ],
)
def test_wrong_usage(
    tmp_path: Path, arguments: tuple[str, ...], told: str, monkeypatch: pytest.MonkeyPatch, call: Call
) -> None:
    """Exit code 2, and what to do."""
    monkeypatch.chdir(tmp_path)
    done = call("run", "odometry", *arguments)
    assert done.code == 2
    assert told in " ".join(done.err.replace("│", " ").split())


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_told_to_stop(tmp_path: Path, number: int) -> None:
    """It ends in order: exit code 0, what was ready is handed over, the open cycle is kept and not reported."""
    snapshot = tmp_path / "snapshot.json"
    arguments = ("--snapshot", str(snapshot))
    with running(tmp_path, *arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as run:
        run.logged("started")
        assert run.process.stdin is not None
        assert run.process.stdout is not None
        run.process.stdin.write("".join(lines(5)).encode())
        heard = b""
        while heard.count(b"\n") < 4:
            heard += run.process.stdout.read(65_536)
        assert run.end(number) == 0
        assert run.log[-1]["why"] == signal.Signals(number).name
    assert reports(read(heard)) == by_hand(4)
    kept = json.loads(snapshot.read_text(encoding="utf-8"))["vehicles"]["1"]
    assert [number for number, _ in kept["pending"]] == [18, 19, 20, 21]


def test_a_reader_that_went_away(tmp_path: Path) -> None:
    """Exit code 141, as every command; a snapshot was kept."""
    snapshot = tmp_path / "snapshot.json"
    arguments = ("--snapshot", str(snapshot))
    with running(tmp_path, *arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as run:
        run.logged("started")
        assert run.process.stdin is not None
        assert run.process.stdout is not None
        run.process.stdout.close()
        run.process.stdout = None
        run.process.stdin.write("".join(lines(5)).encode())
        assert run.process.wait(PATIENCE_S) == 141
    assert snapshot.exists()


def resident(pid: int) -> int:
    """Bytes of memory of a process."""
    return int(Path(f"/proc/{pid}/statm").read_text(encoding="utf-8").split()[1]) * 4_096


@pytest.mark.thorough
def test_a_reader_that_is_slow_makes_the_writer_wait(tmp_path: Path) -> None:
    """Nothing is lost and nothing piles up: the sender of lines is held until reports are read."""
    text = "".join(lines(12_000)).encode()
    with running(tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as run:
        run.logged("started")
        assert run.process.stdin is not None
        assert run.process.stdout is not None
        fd, at_first = run.process.stdin.fileno(), resident(run.process.pid)
        os.set_blocking(fd, False)
        sent, until = 0, time.monotonic() + 3
        while time.monotonic() < until:
            try:
                sent += os.write(fd, text[sent : sent + 65_536])
            except BlockingIOError:
                time.sleep(0.01)
        assert 100_000 < sent < len(text)
        assert resident(run.process.pid) - at_first < 250_000_000
        heard = bytearray()
        os.set_blocking(run.process.stdout.fileno(), False)
        until = time.monotonic() + PATIENCE_S
        while sent < len(text) and time.monotonic() < until:
            heard += run.process.stdout.read(1 << 20) or b""
            try:
                sent += os.write(fd, text[sent : sent + 65_536])
            except BlockingIOError:
                time.sleep(0.001)
        run.process.stdin.close()
        run.process.stdin = None
        os.set_blocking(run.process.stdout.fileno(), True)
        while data := run.process.stdout.read(1 << 20):
            heard += data
        assert run.end() == 0
    found = read(bytes(heard))
    assert [one["cycle"] for one in found] == list(range(1, 12_001))


def test_peers_come_and_go(tmp_path: Path) -> None:
    """Several vehicles over connections of their own; one breaks off within a line and comes back by number."""
    with running(tmp_path, "--from", "tcp:0") as run:
        port = run.port()
        one, other = Talk(port), Talk(port)
        first, second = numbered(8, "a"), numbered(8, "b")
        one.say(*first[:16])
        other.say(*second[:16])
        heard = [one.hear() for _ in range(3)] + [other.hear() for _ in range(3)]
        assert [(told["vehicle"], told["cycle"]) for told in heard] == [(name, n) for name in "ab" for n in (1, 2, 3)]
        one.say(first[16][:20])
        one.close()
        run.logged("peer left")
        again = Talk(port)
        again.say(*first[16:26])
        told = [again.hear() for _ in range(2)]
        assert [(report["cycle"], "rejections" in report) for report in told] == [(4, False), (5, False)]
        other.say(*second[16:21])
        assert other.hear()["cycle"] == 4
        assert run.end(signal.SIGTERM) == 0
        assert any(entry["event"] == "refused" for entry in run.log)
        again.close()
        other.close()


@pytest.mark.thorough
def test_a_peer_that_does_not_read_holds_up_nobody_else(tmp_path: Path) -> None:
    """Its own lines wait; another vehicle has its reports at once."""
    with running(tmp_path, "--from", "tcp:0") as run:
        port = run.port()
        deaf = socket.socket()
        for buffer in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            deaf.setsockopt(socket.SOL_SOCKET, buffer, 65_536)
        deaf.connect(("127.0.0.1", port))
        deaf.setblocking(False)
        text, sent, until = "".join(lines(20_000, vehicle="deaf")).encode(), 0, time.monotonic() + 3
        while time.monotonic() < until:
            try:
                sent += deaf.send(text[sent : sent + 65_536])
            except BlockingIOError:
                time.sleep(0.01)
        assert sent < len(text)
        talk = Talk(port)
        talk.say(*numbered(3, "b"))
        assert [talk.hear()["cycle"] for _ in range(3)] == [1, 2, 3]
        talk.close()
        deaf.close()
        assert run.end(signal.SIGTERM) == 0


def test_datagrams(tmp_path: Path) -> None:
    """Each report comes back to where its vehicle's line came from; a lost one shows; a line without number is refused."""
    with running(tmp_path, "--from", "udp:0") as run:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
            peer.settimeout(PATIENCE_S)
            peer.connect(("127.0.0.1", run.port()))
            made = numbered(5)
            cycles = [made[:5], made[5:11], made[11:16], made[16:21], made[21:26]]
            heard = []
            for number, cycle in enumerate(cycles):
                for text in cycle[1:] if number == 3 else cycle:
                    peer.send(text.encode())
                heard.append(json.loads(peer.recv(65_536)))
            assert ["rejections" in report for report in heard] == [False, False, False, True, False]
            peer.send(line(next(drive(1))[0]).encode())
            assert json.loads(peer.recv(65_536))["reason"].startswith("no number")
        assert run.end(signal.SIGTERM) == 0


def test_the_watchdog_ends_a_silent_cycle(tmp_path: Path) -> None:
    """A vehicle that falls silent gets its missing cycles, one a period, until its place is lost; when it speaks again in
    time it is heard."""
    with running(tmp_path, "--from", "tcp:0", "--watchdog-ms", "200") as run:
        talk = Talk(run.port())
        begun = time.monotonic()
        talk.say(*numbered(3))
        heard = [talk.hear() for _ in range(12)]
        took = time.monotonic() - begun
        talk.close()
        assert run.end(signal.SIGTERM) == 0
    assert [report["cycle"] for report in heard] == list(range(1, 13))
    assert heard[2]["interval_mm"] is not None
    assert heard[-1]["interval_mm"] is None
    assert heard[-1]["outputs"]["reason"] == "SENSOR_FAILURE"
    assert took > 0.9


@pytest.mark.thorough
def test_a_vehicle_that_never_speaks_again_is_missed(tmp_path: Path) -> None:
    """The watchdog knows it from the snapshot: its cycles go on, and are handed to whoever reads the reports."""
    source, sink = tmp_path / "lines.jsonl", tmp_path / "reports.jsonl"
    source.write_text("".join(lines(3)), encoding="utf-8")
    arguments = ("--from", f"file:{source}", "--to", f"file:{sink}", "--snapshot", str(tmp_path / "snapshot.json"))
    assert ran(tmp_path, *arguments, "--until-end").returncode == 0
    with running(tmp_path, *arguments, "--watchdog-ms", "100") as run:
        wait_for(lambda: len(read(sink.read_bytes())) > 12, "no reports")
        assert run.end(signal.SIGTERM) == 0
    told = read(sink.read_bytes())
    assert [report["cycle"] for report in told] == list(range(1, len(told) + 1))
    assert told[2]["interval_mm"] is not None
    assert told[-1]["interval_mm"] is None


def test_without_a_watchdog_time_is_that_of_the_records(tmp_path: Path) -> None:
    """However long nothing comes: no report."""
    with running(tmp_path, "--from", "tcp:0") as run:
        talk = Talk(run.port())
        talk.say(*numbered(3))
        assert [talk.hear()["cycle"] for _ in range(3)] == [1, 2, 3]
        talk.socket.settimeout(0.5)
        with pytest.raises(TimeoutError):
            talk.socket.recv(1)
        talk.close()
        assert run.end(signal.SIGTERM) == 0


def test_a_file_that_grows_and_is_replaced(tmp_path: Path) -> None:
    """It may come later; another file under its name is read from the beginning, and the vehicle's cycles between are
    doubtful."""
    source, sink = tmp_path / "lines.jsonl", tmp_path / "reports.jsonl"
    said = lines(12)

    def told() -> list[Data]:
        return read(sink.read_bytes()) if sink.exists() else []

    with running(tmp_path, "--from", f"file:{source}", "--to", f"file:{sink}") as run:
        run.logged("started")
        source.write_text("".join(said[:15]), encoding="utf-8")
        wait_for(lambda: len(told()) == 3, "no reports")
        with source.open("a", encoding="utf-8") as file:
            file.write("".join(said[15:19]))
        wait_for(lambda: len(told()) == 4, "no further report")
        other = tmp_path / "other.jsonl"
        other.write_text("".join(said[19:]), encoding="utf-8")
        other.replace(source)
        wait_for(lambda: len(told()) == 11, f"no reports of the other file: {told()}")
        assert run.end(signal.SIGTERM) == 0
    doubted = [report["cycle"] for report in told() if "rejections" in report]
    assert doubted == [5]


def test_half_a_report_of_a_killed_process_is_taken_away(tmp_path: Path) -> None:
    """A file of reports has whole lines only."""
    sink = tmp_path / "reports.jsonl"
    sink.write_bytes(b'{"vehicle": "1", "cycle": 1, "mode": {}}\n{"vehicle": "1", "cyc')
    assert ran(tmp_path, "--to", f"file:{sink}", said="".join(lines(2))).returncode == 0
    assert [one["cycle"] for one in read(sink.read_bytes())] == [1, 1, 2]
