"""packaging/: the command lines that stand there are run, fenced in as they say, and what docs/hosting.md says of them is so."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from safeloc.cli.commands import loaded
from tests.runtime.service.processes import (
    PATIENCE_S,
    ROOT,
    SAFELOC,
    TRUSTING,
    numbered,
    read,
    reports,
    run_to_its_end,
    started,
    wait_for,
)  # fmt: skip
from tests.runtime.service.test_supervised import CONTAINER, UNIT, settings

HOSTING = (ROOT / "docs" / "hosting.md").read_text(encoding="utf-8")
PROGRAM = "/opt/safeloc/bin/safeloc"
ANY_PORT = ("tcp:9000", "tcp:0")


def here(word: str, folder: Path) -> str:
    """A word of a command line with the paths and the port of this test."""
    places = {"/etc/safeloc": "etc", "/var/lib/safeloc": "state", "/run/safeloc": "run"}
    for theirs, ours in places.items():
        (folder / ours).mkdir(exist_ok=True)
        word = word.replace(theirs, str(folder / ours))
    return word.replace(*ANY_PORT)


# ------------------------------------------------------------------ the unit


def options_shown() -> list[str]:
    """SAFELOC_OPTIONS as the unit and the docs show them."""
    return re.findall(r"SAFELOC_OPTIONS=([^`\n]+)", UNIT.read_text(encoding="utf-8") + HOSTING)


def unit_command(options: str = "", instance: str = "odometry") -> list[str]:
    """ExecStart as systemd takes it apart: a variable without braces is cut at blanks."""
    (line,) = settings()["ExecStart"]
    words = [
        shlex.split(options) if word == "$SAFELOC_OPTIONS" else [word.replace("%i", instance)] for word in line.split()
    ]
    return [word for part in words for word in part]


def unit_environment() -> dict[str, str]:
    """What the unit sets, beside what finds this checkout."""
    told = dict(one.split("=", 1) for one in settings()["Environment"])
    return {**os.environ, **told}


@pytest.fixture
def unit(tmp_path: Path) -> list[str]:
    """Its command line, with the first options that it shows."""
    program, *arguments = [here(word, tmp_path) for word in unit_command(options_shown()[0])]
    assert program == PROGRAM
    (tmp_path / "etc" / "odometry.toml").write_text(TRUSTING, encoding="utf-8")
    return [*SAFELOC, *arguments]


@pytest.fixture
def manager(tmp_path: Path) -> Iterator[socket.socket]:
    """Where systemd would listen."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as made:
        made.bind(str(tmp_path / "notify"))
        made.settimeout(PATIENCE_S)
        yield made


def notifying(manager: socket.socket) -> dict[str, str]:
    """What systemd sets for Type=notify and WatchdogSec=."""
    (seconds,) = settings()["WatchdogSec"]
    return {"NOTIFY_SOCKET": manager.getsockname(), "WATCHDOG_USEC": f"{int(seconds)}000000"}


def test_the_unit_runs(tmp_path: Path, unit: list[str], manager: socket.socket) -> None:
    """It is ready, gives signs, says that it stops, keeps its snapshot in its state folder, and ends as the unit takes
    for good; the next start goes on from there."""
    with started(unit, env=unit_environment() | notifying(manager)) as run:
        assert [manager.recv(100), manager.recv(100)] == [b"READY=1", b"WATCHDOG=1"]
        assert drive(run.port(), 3) is not None
        assert len(os.listdir(f"/proc/{run.process.pid}/task")) == 2  # the loop, and who writes snapshots
        run.process.send_signal(signal.Signals[settings()["KillSignal"][0]])
        told = manager.recv(100)
        while told == b"WATCHDOG=1":
            told = manager.recv(100)
        assert told == b"STOPPING=1"
        assert run.end() == 0
    assert (tmp_path / settings()["StateDirectory"][0].replace("safeloc", "state") / "odometry.snapshot").exists()
    with started(unit, env=unit_environment() | notifying(manager)) as again:
        assert again.logged("resumed")["vehicles"] == 1
        again.logged("started")
        assert again.end(signal.SIGTERM) == 3
    assert settings()["SuccessExitStatus"] == ["3 141"]


def drive(port: int, cycles: int) -> object:
    """The place that a vehicle has after these cycles."""
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as peer:
        peer.sendall("".join(numbered(cycles)).encode())
        heard = b""
        while heard.count(b"\n") < cycles:
            heard += peer.recv(65_536)
    return reports(read(heard))[-1]["interval_mm"]


def test_a_machine_without_its_files_is_not_started_for_ever(tmp_path: Path, unit: list[str]) -> None:
    """Without a configuration the exit code is one that is started again, and the unit bounds how often."""
    (tmp_path / "etc" / "odometry.toml").unlink()
    done = run_to_its_end(unit)
    told = settings()
    assert done.returncode == 2
    assert (
        str(done.returncode) not in told["SuccessExitStatus"][0].split() + told["RestartPreventExitStatus"][0].split()
    )
    assert (told["Restart"], told["StartLimitBurst"], told["StartLimitIntervalSec"]) == (["on-failure"], ["5"], ["300"])
    assert int(told["StartLimitBurst"][0]) * int(told["RestartSec"][0]) < int(told["StartLimitIntervalSec"][0])


def system_calls(*groups: str) -> set[str]:
    """Those of systemd's groups."""
    found: set[str] = set()
    told = subprocess.run(["systemd-analyze", "syscall-filter", *groups], capture_output=True, text=True, check=True)
    for line in told.stdout.splitlines():
        name = line.strip()
        if name.startswith("@") and line.startswith(" "):
            found |= system_calls(name)
        elif name and name[0] not in "@#":
            found.add(name)
    return found


def filters() -> tuple[set[str], set[str]]:
    """What SystemCallFilter lets pass, and what it takes away from that."""
    allowed, denied = settings()["SystemCallFilter"]
    assert denied.startswith("~")
    away = system_calls(*denied[1:].split())
    return system_calls(*allowed.split()) - away, away


@pytest.mark.thorough
@pytest.mark.skipif(
    not (shutil.which("strace") and shutil.which("systemd-analyze")), reason="not installed: strace, systemd-analyze"
)
def test_the_unit_runs_within_its_fences(tmp_path: Path, unit: list[str]) -> None:
    """What it asks of the system is let pass, or it does without; it makes no second thread, as on a machine with more
    cores than TasksMax; it writes to its state folder only; it opens no socket but on loopback."""
    allowed, denied = filters()
    trace = tmp_path / "trace"
    refused = ",".join(f"?{name}" for name in sorted(denied))
    fences = ["-e", f"inject={refused}:error=EPERM", "-e", "inject=?clone,?clone3:error=EAGAIN:when=2+"]
    with started(["strace", "-f", "-y", "-o", str(trace), *fences, *unit], env=unit_environment()) as run:
        try:
            port = run.port()
        except TimeoutError:
            pytest.skip(f"strace may not trace here: {trace.read_text(encoding='utf-8')[:200]}")
        assert drive(port, 3) is not None
        pid = int(run.logged("started")["pid"])
        os.kill(pid, signal.SIGTERM)
        assert run.end() == 0
    text = trace.read_text(encoding="utf-8", errors="replace")
    calls = set(re.findall(r"^\d+ +(\w+)\(", text, re.MULTILINE))
    assert {"openat", "bind", "futex"} < calls
    assert calls - denied <= allowed
    written = re.findall(r'openat\([^,]+, "([^"]+)", [^,)]*(?:O_WRONLY|O_RDWR|O_CREAT)[^)]*\) = \d', text)
    assert any(path.startswith(str(tmp_path / "state")) for path in written)
    assert {path for path in written if not path.startswith(str(tmp_path / "state"))} <= {"/dev/null"}
    addresses = re.findall(r"^\d+ +(?:bind|connect)\((.*)", text, re.MULTILINE)
    assert addresses
    assert [one for one in addresses if 'inet_addr("127.0.0.1")' not in one] == []


@pytest.mark.parametrize("options", options_shown())
def test_options_that_are_shown_are_taken(options: str) -> None:
    """By the command line itself, with types and ranges."""
    program, command, *arguments = unit_command(options)
    assert program == PROGRAM
    taken(command, arguments)


def taken(command: str, arguments: list[str]) -> Mapping[str, object]:
    """What the command line makes of it; an error where it does not know an option."""
    return loaded(command).make_context(command, arguments).params


@pytest.mark.parametrize(
    ("said", "name", "value"),
    [
        ("a user of its own", "DynamicUser", "yes"),
        ("no network but loopback", "IPAddressDeny", "any"),
        ("private files", "StateDirectoryMode", "0700"),
        ("private files", "UMask", "0077"),
        ("no rights", "CapabilityBoundingSet", ""),
        ("a bound of memory", "MemoryMax", "1G"),
        ("an end to restarts (five in five\nminutes)", "StartLimitBurst", "5"),
        ("an end to restarts (five in five\nminutes)", "StartLimitIntervalSec", "300"),
        ("`Type=notify`", "Type", "notify"),
        ("one that hangs for 10 s is killed", "WatchdogSec", "10"),
        ("one that hangs for 10 s is killed", "WatchdogSignal", "SIGKILL"),
        ("`systemctl stop` is SIGTERM", "KillSignal", "SIGTERM"),
        ("`/etc/safeloc/odometry.env`", "EnvironmentFile", "/etc/safeloc/%i.env"),
        ("one thread for arithmetic", "Environment", "OPENBLAS_NUM_THREADS=1"),
    ],
)
def test_what_the_docs_say_of_the_unit(said: str, name: str, value: str) -> None:
    """Stands in it."""
    assert said in HOSTING
    assert settings()[name] == [value]


def test_its_state_folder_is_what_it_may_write() -> None:
    """With ProtectSystem=strict, everything but StateDirectory is read only to it."""
    (folder,) = settings()["StateDirectory"]
    context = taken("run", unit_command()[2:])
    assert str(context["snapshot"]).startswith(f"/var/lib/{folder}/")
    assert context["alive"] is None


# ------------------------------------------------------------------ the container


def instructions() -> dict[str, list[str]]:
    """The last stage of the container file, instruction by instruction; lines that go on are joined."""
    text = CONTAINER.read_text(encoding="utf-8").replace("\\\n", " ")
    found: dict[str, list[str]] = {}
    for line in text[text.rindex("\nFROM") :].splitlines():
        if match := re.fullmatch(r"([A-Z]+) (.*)", line):
            found.setdefault(match[1], []).append(match[2])
    return found


def shown_arguments() -> list[str]:
    """What `docker run ... safeloc` is given in the first lines of the file."""
    match = re.search(r"^#     safeloc (.*)$", CONTAINER.read_text(encoding="utf-8"), re.MULTILINE)
    assert match is not None
    return match[1].split()


@pytest.fixture
def container(tmp_path: Path) -> list[str]:
    """Its entry with the arguments that are shown."""
    (entry,) = instructions()["ENTRYPOINT"]
    program, *arguments = [here(word, tmp_path) for word in [*json.loads(entry), *shown_arguments()]]
    assert program == PROGRAM
    return [*SAFELOC, *arguments]


def healthy(folder: Path) -> bool:
    """What its health check says."""
    (check,) = instructions()["HEALTHCHECK"]
    command = here(check[check.index("CMD ") + 4 :], folder)
    return subprocess.run(["sh", "-c", command], check=False, stderr=subprocess.DEVNULL).returncode == 0


def container_environment() -> dict[str, str]:
    """What the file sets."""
    return {**os.environ, **dict(one.split("=", 1) for one in instructions()["ENV"])}


@pytest.mark.thorough
def test_the_containers_health(tmp_path: Path, container: list[str]) -> None:
    """Well while it runs; not before, not ten seconds after it was killed, and not after an orderly end."""
    alive = tmp_path / "run" / "alive"
    assert not healthy(tmp_path)
    with started(container, env=container_environment()) as run:
        run.logged("started")
        wait_for(alive.exists, "no sign of life")
        assert healthy(tmp_path)
        assert run.end(signal.SIGKILL) == -signal.SIGKILL
    assert alive.exists()
    os.utime(alive, (time.time() - 11,) * 2)
    assert not healthy(tmp_path)
    with started(container, env=container_environment()) as run:
        wait_for(lambda: healthy(tmp_path), "no sign of life after the restart")
        run.logged("started")
        assert run.end(signal.Signals[instructions()["STOPSIGNAL"][0]]) == 3
    assert not healthy(tmp_path)


def test_one_that_hangs_is_not_well(tmp_path: Path, container: list[str]) -> None:
    """Its sign grows old though it is still there."""
    alive = tmp_path / "run" / "alive"
    with started(container, env=container_environment()) as run:
        wait_for(alive.exists, "no sign of life")
        run.logged("started")
        run.process.send_signal(signal.SIGSTOP)
        os.utime(alive, (time.time() - 11,) * 2)
        assert not healthy(tmp_path)
        run.process.send_signal(signal.SIGCONT)
        wait_for(lambda: healthy(tmp_path), "no sign of life when it goes on")
        assert run.end(signal.SIGTERM) == 3


def test_the_container_writes_where_it_may() -> None:
    """The folders that the first lines mount, and the user's own; the entry alone is a command, too."""
    text = CONTAINER.read_text(encoding="utf-8")
    (entry,), (usual,) = instructions()["ENTRYPOINT"], instructions()["CMD"]
    for arguments in (shown_arguments(), json.loads(usual)):
        context = taken("run", [*json.loads(entry)[2:], *arguments])
        assert context["alive"] == Path("/run/safeloc/alive")
        assert str(context["snapshot"] or "/var/lib/safeloc/").startswith("/var/lib/safeloc/")
    assert "--tmpfs /run/safeloc:uid=10001" in text
    assert "-v safeloc-state:/var/lib/safeloc" in text
    assert {"--read-only", "--network", "--cap-drop", "--pids-limit", "--memory"} < set(text.split())
    assert instructions()["USER"] == ["10001"]
