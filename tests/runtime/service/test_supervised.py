"""Signs of life, and the files by which the process is supervised."""

from __future__ import annotations

import configparser
import os
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from safeloc.runtime.service.supervised import Supervised
from tests.runtime.service.processes import PATIENCE_S, ROOT, running, wait_for

UNIT = ROOT / "packaging" / "safeloc@.service"
CONTAINER = ROOT / "packaging" / "Containerfile"


@pytest.fixture
def manager(tmp_path: Path) -> socket.socket:
    """The socket that systemd would listen on."""
    made = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    made.bind(str(tmp_path / "notify"))
    made.settimeout(PATIENCE_S)
    return made


def test_the_manager_hears_of_it(tmp_path: Path, manager: socket.socket, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ready once lines are heard, living while the loop turns, though nothing comes, and ending; one that hangs gives no
    sign."""
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
    monkeypatch.setenv("WATCHDOG_USEC", "300000")
    monkeypatch.delenv("WATCHDOG_PID", raising=False)
    with running(tmp_path, "--from", "tcp:0") as run:
        assert manager.recv(100) == b"READY=1"
        assert [manager.recv(100) for _ in range(5)] == [b"WATCHDOG=1"] * 5
        run.process.send_signal(signal.SIGSTOP)
        time.sleep(0.5)
        while select.select([manager], [], [], 0.7)[0]:
            assert manager.recv(100) == b"WATCHDOG=1"  # said before it was stopped
        run.process.send_signal(signal.SIGCONT)
        assert manager.recv(100) == b"WATCHDOG=1"
        run.process.send_signal(signal.SIGTERM)
        said = b"WATCHDOG=1"
        while said == b"WATCHDOG=1":
            said = manager.recv(100)
        assert said == b"STOPPING=1"
    manager.close()


def test_the_file_is_touched_while_it_lives(tmp_path: Path) -> None:
    """And taken away when it ends in order; after kill -9 it stays, and grows old."""
    alive = tmp_path / "alive"
    with running(tmp_path, "--from", "tcp:0", "--alive", str(alive)) as run:
        wait_for(alive.exists, "no sign of life")
        first = alive.stat().st_mtime_ns
        wait_for(lambda: alive.stat().st_mtime_ns > first, "no second sign")
        run.end(signal.SIGTERM)
    assert not alive.exists()


@pytest.mark.parametrize(
    ("environment", "every_s"),
    [
        ({}, None),
        ({"WATCHDOG_USEC": "3000000"}, 1.0),
        ({"WATCHDOG_USEC": "3000000", "WATCHDOG_PID": str(os.getpid())}, 1.0),
        ({"WATCHDOG_USEC": "3000000", "WATCHDOG_PID": "1"}, None),
        ({"WATCHDOG_USEC": "soon"}, None),
        ({"WATCHDOG_USEC": "0"}, None),
    ],
)
def test_how_often(environment: dict[str, str], every_s: float | None) -> None:
    """Three times in what the manager allows this process; else never."""
    assert Supervised(None, environment).every_s == every_s


@pytest.mark.parametrize("address", ["", "relative", "/nobody/there", "@nobody-there"])
def test_a_manager_that_is_not_there(address: str) -> None:
    """Costs nothing."""
    supervised = Supervised(None, {"NOTIFY_SOCKET": address, "WATCHDOG_USEC": "1000000"})
    supervised.ready()
    supervised.living()
    supervised.ending()


# ------------------------------------------------------------------ the files


def settings() -> dict[str, list[str]]:
    """Every setting of the unit with its values, whatever its section."""
    found: dict[str, list[str]] = {}
    for line in UNIT.read_text(encoding="utf-8").splitlines():
        if match := re.fullmatch(r"(\w+)=(.*)", line):
            found.setdefault(match[1], []).append(match[2])
    return found


def test_the_unit_is_hardened() -> None:
    """No network but loopback, private files, no rights, a watchdog, and an end to restarting."""
    told = settings()
    assert told["IPAddressDeny"] == ["any"]
    assert told["IPAddressAllow"] == ["localhost"]
    assert told["ProtectSystem"] == ["strict"]
    assert told["CapabilityBoundingSet"] == [""]
    assert told["Type"] == ["notify"]
    yes = ("DynamicUser", "NoNewPrivileges", "ProtectHome", "PrivateTmp", "PrivateDevices", "RestrictNamespaces")
    assert [told[name] for name in yes] == [["yes"]] * len(yes)
    assert int(told["WatchdogSec"][0]) > 0 < int(told["StartLimitBurst"][0])
    parser = configparser.ConfigParser(strict=False, interpolation=None)
    parser.read(UNIT, encoding="utf-8")
    assert parser.sections() == ["Unit", "Service", "Install"]


def test_systemd_takes_the_unit(tmp_path: Path) -> None:
    """As `systemd-analyze verify` says, and its exposure is low; left out where there is no systemd."""
    analyze = shutil.which("systemd-analyze")
    if analyze is None:
        pytest.skip("no systemd here")
    unit = tmp_path / "safeloc@odometry.service"
    unit.write_text(UNIT.read_text(encoding="utf-8").replace("/opt/safeloc/bin/safeloc", sys.executable), "utf-8")
    done = subprocess.run([analyze, "verify", str(unit)], capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    command = [analyze, "security", "--offline=true", "--threshold=20", str(unit)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stdout[-300:]


def test_the_container_has_no_rights() -> None:
    """Its instructions: a user that is not root, a stop in order, a look at the sign of life; what it copies is there."""
    said = [line.split(maxsplit=1) for line in CONTAINER.read_text(encoding="utf-8").splitlines() if line[:1].isupper()]
    told = {name: rest for name, rest in said}
    assert told["USER"] == "10001"
    assert told["STOPSIGNAL"] == "SIGTERM"
    assert "--alive" in told["ENTRYPOINT"]
    copied = [rest.split() for name, rest in said if name == "COPY" and "--from" not in rest]
    assert copied
    assert all((ROOT / source).exists() for *sources, _ in copied for source in sources)


def test_the_health_check_sees_an_old_sign(tmp_path: Path) -> None:
    """A sign of now is health; one of a minute ago, or none, is not."""
    check = re.search(r"CMD (test .*) \|\|", CONTAINER.read_text(encoding="utf-8"))
    assert check is not None
    alive = tmp_path / "alive"
    command = check[1].replace("/run/safeloc/alive", str(alive))

    def well() -> bool:
        return subprocess.run(["sh", "-c", command], check=False, stderr=subprocess.DEVNULL).returncode == 0

    assert not well()
    alive.touch()
    assert well()
    os.utime(alive, (time.time() - 60,) * 2)
    assert not well()
