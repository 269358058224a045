"""`safeloc run` on files, devices and pipes that cannot be used: a message and exit code 2, never a traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from safeloc.runtime.service import station
from tests.cli.calling import Call, caller
from tests.runtime.service.processes import lines, ran, read, running, wait_for


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs `safeloc ARGUMENTS` in this process."""
    return caller(monkeypatch, capsys)


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--to", "file:/dev/null"), "/dev/null: a device or a pipe; reports go to a file, or to standard output"),
        (("--to", "file:/dev/full"), "/dev/full: a device or a pipe"),
        (("--to", "file:fifo"), "fifo: a device or a pipe"),
        (("--to", "file:."), "cannot be written: Is a directory"),
        (("--from", "file:fifo"), "fifo: a device or a pipe; give it as standard input"),
        (("--from", "file:/dev/zero"), "/dev/zero: a device or a pipe"),
        (("--from", "file:/proc/self/mem"), "/proc/self/mem: cannot be read: Input/output error"),
        (("--from", "file:."), "cannot be read: Is a directory"),
        (("--snapshot", "/dev/full"), "/dev/full: a device or a pipe; name a file for the snapshots"),
        (("--snapshot", "fifo"), "fifo: a device or a pipe"),
        (("--from", "file:one", "--alive", "one"), "one: given for --from and for --alive"),
        (("--from", "file:one", "--until-end", "--alive", "absent/there"), "absent/there: cannot be written"),
    ],
)
def test_what_is_no_file(
    tmp_path: Path, arguments: tuple[str, ...], told: str, monkeypatch: pytest.MonkeyPatch, call: Call
) -> None:
    """Said in words, and nothing is left beside it."""
    monkeypatch.chdir(tmp_path)
    os.mkfifo("fifo")
    Path("one").touch()
    done = call("run", "odometry", *arguments)
    assert done.code == 2
    assert told in " ".join(done.err.replace("│", " ").split())
    assert "Traceback" not in done.err
    assert not Path("/dev/full.lock").exists()
    assert not Path("fifo.lock").exists()


FROM = ("--from", "mqtt://localhost/fleet")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((*FROM,), "--snapshot FOLDER is needed with a broker: records are acknowledged when they are saved"),
        ((*FROM, "--snapshot", "one"), "one: no folder; with a broker each partition has its own snapshot in a folder"),
        ((*FROM, "--snapshot", "new", "--to", "file:out"), "--to 'file:out': with a broker, reports go back to it"),
        (
            (*FROM, "--snapshot", "new", "--fresh"),
            "--fresh is not for a broker: stop all processes and give them a new folder",
        ),
        ((*FROM, "--snapshot", "new", "--until-end"), "--until-end is for --from file:PATH"),
        ((*FROM, "--snapshot", "new", "--broker", "none"), "none: no such file"),
        ((*FROM, "--snapshot", "new", "--broker", "one"), "one:1: user: Input should be a valid string"),
        (("--from", "mqtt://broker.example/fleet", "--snapshot", "new"), "without TLS only loopback is allowed"),
        (("--from", "file:one", "--broker", "one"), "--broker is for --from mqtt://... or mqtts://..."),
        (("--from", "file:one", "--processes", "2"), "--processes is for --from mqtt://... or mqtts://..."),
        ((*FROM, "--snapshot", "new", "--processes", "17"), "--processes 17: more than the 16 partitions of the fleet"),
        (
            (*FROM, "--snapshot", "new", "--processes", "2", "--metrics", "65535"),
            "--metrics 65535: worker 1 would have port 65536; give a lower one",
        ),
    ],
)
def test_options_that_mean_nothing_with_a_broker(
    tmp_path: Path, arguments: tuple[str, ...], told: str, monkeypatch: pytest.MonkeyPatch, call: Call
) -> None:
    """Each is refused in words before anything is sent, and no folder is made."""
    monkeypatch.chdir(tmp_path)
    Path("one").write_text("user = 3", encoding="utf-8")
    done = call("run", "odometry", *arguments)
    assert done.code == 2
    assert told in " ".join(done.err.replace("│", " ").split())
    assert "Traceback" not in done.err
    assert [path.name for path in tmp_path.iterdir()] == ["one"]


AREAS = """fleet = "fleet"
clock_error_ms = 5
[vehicles.12]
length_mm = 100_000
faces_upwards = true
[areas.west]
low_end_mm = 0
high_end_mm = 900_000
sections_mm = [[0, 900_000]]
"""


@pytest.mark.parametrize(
    ("machine", "arguments", "told"),
    [
        ("sections", ("--trackside", "areas.toml"), "--trackside is for --from mqtts://HOST/PREFIX"),
        ("sections", (*FROM, "--trackside", "areas.toml"), "--trackside needs code_key_file in the file of --broker"),
        (
            "sections",
            (*FROM, "--broker", "broker.toml", "--trackside", "areas.toml"),
            "areas.toml:1: fleet: fleet is the prefix of the areas",
        ),
        ("sections", (*FROM, "--trackside", "flawed.toml"), "flawed.toml:9: areas.west.sections_mm.0: [0, 900001]"),
        ("sections", (*FROM, "--trackside", "areas.toml", "--first", "a=1"), "--first and --vehicle are not for areas"),
        ("odometry", (*FROM, "--trackside", "areas.toml"), "--trackside is for the machine sections, not for odometry"),
    ],
)
def test_areas_that_cannot_be_run(
    tmp_path: Path, machine: str, arguments: tuple[str, ...], told: str, monkeypatch: pytest.MonkeyPatch, call: Call
) -> None:
    """Each is refused in words before anything is sent."""
    monkeypatch.chdir(tmp_path)
    Path("areas.toml").write_text(AREAS, encoding="utf-8")
    Path("report.key").write_bytes(bytes(range(32)))
    Path("broker.toml").write_text('code_key_file = "report.key"\n', encoding="utf-8")
    Path("flawed.toml").write_text(AREAS.replace("[0, 900_000]", "[0, 900_001]"), encoding="utf-8")
    Path("config.toml").write_text('[area]\nborders = "occupancy"\n', encoding="utf-8")
    given = ("--config", "config.toml") if machine == "sections" else ("--period-ms", "100")
    done = call("run", machine, *given, *arguments)
    assert done.code == 2
    assert told in " ".join(done.err.replace("│", " ").split())
    assert "Traceback" not in done.err


def test_a_standard_output_that_is_full(tmp_path: Path) -> None:
    """As of a disk: exit code 2."""
    with Path("/dev/full").open("wb") as full, running(tmp_path, stdin=subprocess.PIPE, stdout=full) as run:
        assert run.process.stdin is not None
        run.process.stdin.write("".join(lines(3)).encode())
        run.process.stdin.close()
        run.process.stdin = None
        assert run.process.wait(90) == 2
        assert run.process.stderr is not None
        told = run.process.stderr.read().decode()
    assert "standard output cannot be written: No space left on device" in told
    assert "Traceback" not in told


def test_a_terminal_that_hangs_up(tmp_path: Path) -> None:
    """SIGHUP ends it in order, with a snapshot."""
    snapshot = tmp_path / "snapshot.json"
    with running(tmp_path, "--from", "tcp:0", "--snapshot", str(snapshot)) as run:
        run.port()
        run.logged("started")
        assert run.end(signal.SIGHUP) == 3  # no cycle ended
        assert run.log[-1]["why"] == "SIGHUP"
    assert snapshot.exists()


@pytest.mark.thorough
def test_a_terminal_that_hangs_up_under_nohup(tmp_path: Path) -> None:
    """It goes on."""
    ignoring = lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)  # noqa: E731 # what nohup does
    with running(tmp_path, "--from", "tcp:0", preexec_fn=ignoring) as run:
        run.logged("started")
        run.process.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        assert run.process.poll() is None
        assert run.end(signal.SIGTERM) == 3


@pytest.mark.thorough
def test_silence_withdraws_without_a_watchdog(tmp_path: Path) -> None:
    """After the longest gap, told once; behind a restart the place does not come back, though lines are read again."""
    source, sink, snapshot = (tmp_path / name for name in ("lines.jsonl", "reports.jsonl", "snapshot.json"))
    source.write_text("".join(lines(4)), encoding="utf-8")
    arguments = ("--from", f"file:{source}", "--to", f"file:{sink}", "--snapshot", str(snapshot))
    with running(tmp_path, *arguments, "--longest-gap-ms", "1000", "--snapshot-every-ms", "3600000") as run:
        wait_for(lambda: sink.exists() and b"anew" in sink.read_bytes(), "not withdrawn")
        run.end(signal.SIGKILL)
    told = read(sink.read_bytes())
    assert told[-1]["anew"] == "it ended no cycle for 1000 ms"
    assert [one["interval_mm"] is None for one in told[2:]] == [False, False, True]
    assert ran(tmp_path, *arguments, "--until-end", "--longest-gap-ms", "1000").returncode == 0
    assert read(sink.read_bytes())[-1]["interval_mm"] is None


def test_told_to_stop_within_a_turn() -> None:
    """A turn that takes too long is left: what was not read adds to the error like what came while nobody listened."""
    heard: list[int] = []

    class Fake(station.Station):
        """Only what a turn needs."""

        def __init__(self) -> None:
            self.stop_by = time.monotonic() - 1.0
            self._allowance = None
            self._parts = type("Parts", (), {"fleet": None, "feed": type("Feed", (), {"from_start": True})})  # type: ignore[assignment]

        def _tell(self, *_: object, **__: object) -> None:
            """Nothing."""

    def events() -> object:
        for number in range(100):
            heard.append(number)
            yield None

    Fake()._handle(events())  # type: ignore[arg-type]
    assert heard == [0]
