"""Vehicles over a network, as docs/hosting.md says it: its commands, packaging/haproxy.cfg, and real connections."""

from __future__ import annotations

import json
import re
import shutil
import socket
import ssl
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.free_port import free_port
from tests.runtime.service.processes import PATIENCE_S, ROOT, Data, Running, numbered, reports, running, wait_for

DOCS = ROOT / "docs" / "hosting.md"
SETTINGS = ROOT / "packaging" / "haproxy.cfg"
AUTHORITY = ROOT / "packaging" / "vehicles-ca.cnf"
GATEWAY = "safeloc.example"
MISSING = [name for name in ("haproxy", "openssl") if shutil.which(name) is None]

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}")


def commands() -> list[str]:
    """Those of docs/hosting.md in their order: authority, vehicle 12, list of what was revoked, gateway."""
    return re.findall(r"```sh\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL)


def do(folder: Path, command: str) -> None:
    """In a shell there; what it says is shown where it fails."""
    done = subprocess.run(["sh", "-ec", command], cwd=folder, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, f"{command}\n{done.stderr}"


def authority(folder: Path, *vehicles: str) -> Path:
    """With certificates for these vehicles; the last one's is revoked."""
    begin, vehicle, revoked, _gateway = commands()
    folder.mkdir()
    shutil.copy(AUTHORITY, folder)
    do(folder, begin)
    for name in vehicles:
        do(folder, vehicle.replace("12", name))
    do(folder, f"openssl ca -config vehicles-ca.cnf -revoke {vehicles[-1]}.pem")
    do(folder, revoked)
    return folder


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Our vehicles, one with a name that is none, 99 whose certificate is revoked, and the gateway."""
    folder = authority(tmp_path_factory.mktemp("ca") / "ours", "12", "13", "22", "23", "32", "42", "train@12", "99")
    do(folder, commands()[-1])
    return folder


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Somebody else's authority, which has a vehicle 12 too."""
    return authority(tmp_path_factory.mktemp("ca") / "theirs", "12", "99")


@dataclass
class Proxy:
    """HAProxy in front of a process; `behind` is the process's own port."""

    port: int
    behind: int
    ours: Path
    run: Running

    def drive(self, name: str | None, folder: Path | None) -> list[Data]:
        """A report, of a vehicle that drives."""
        with self.call(name, folder) as peer:
            say(peer, *numbered(3, "12"))
            return hear(peer, 1)

    def came(self) -> int:
        """How many connections the process has taken, ours being the last of them."""
        with self.call("32") as peer:
            say(peer, "nothing\n")
            hear(peer, 1)
        return sum(one["event"] == "peer came" for one in self.run.caught_up())

    def call(self, name: str | None, folder: Path | None = None, host: str = GATEWAY) -> ssl.SSLSocket:
        """A connection with the certificate of that name."""
        folder = folder or self.ours
        context = ssl.create_default_context(cafile=self.ours / "gateway-cert.pem")
        if name is not None:
            context.load_cert_chain(folder / f"{name}.pem", folder / f"{name}.key")
        plain = socket.create_connection(("127.0.0.1", self.port), PATIENCE_S)
        return context.wrap_socket(plain, server_hostname=host)


def settings(folder: Path, port: int, behind: int) -> Path:
    """Our file, with the ports and the folder of this test; users and daemons are the system's."""
    text = SETTINGS.read_text(encoding="utf-8")
    for old, new in (
        ("bind :8883", f"bind 127.0.0.1:{port}"), ("127.0.0.1:9000", f"127.0.0.1:{behind}"),
        ("/etc/haproxy/safeloc", str(folder)), ("    user haproxy\n    group haproxy\n", ""),
    ):  # fmt: skip
        assert old in text
        text = text.replace(old, new)
    path = folder / "haproxy.cfg"
    path.write_text(text, encoding="utf-8")
    return path


@contextmanager
def proxied(path: Path, port: int) -> Iterator[None]:
    """The proxy, once it listens."""
    haproxy = str(shutil.which("haproxy"))
    checked = subprocess.run([haproxy, "-c", "-f", str(path)], capture_output=True, text=True, check=False, timeout=60)
    assert checked.returncode == 0, checked.stderr
    assert "WARNING" not in checked.stderr
    with (path.parent / "haproxy.log").open("wb") as log:
        process = subprocess.Popen([haproxy, "-db", "-f", str(path)], stdout=log, stderr=log)
    try:
        wait_for(lambda: process.poll() is not None or listens(port), "the proxy does not listen")
        assert process.poll() is None, (path.parent / "haproxy.log").read_text()
        yield
    finally:
        process.kill()
        process.wait()


def listens(port: int) -> bool:
    """Whether somebody does."""
    with socket.socket() as made:
        return made.connect_ex(("127.0.0.1", port)) == 0


@pytest.fixture(scope="module")
def proxy(tmp_path_factory: pytest.TempPathFactory, ours: Path) -> Iterator[Proxy]:
    """In front of a process for odometry."""
    with running(tmp_path_factory.mktemp("run"), "--from", "proxy:0") as run:
        port, behind = free_port(), run.port()
        with proxied(settings(ours, port, behind), port):
            yield Proxy(port, behind, ours, run)


def say(peer: socket.socket, *said: str) -> None:
    """Lines."""
    peer.sendall("".join(said).encode())


def hear(peer: socket.socket, count: int) -> list[Data]:
    """So many lines; EOFError where it is closed before."""
    heard = b""
    while heard.count(b"\n") < count:
        data = peer.recv(65_536)
        if not data:
            raise EOFError(heard)
        heard += data
    return [json.loads(one) for one in heard.splitlines()]


def why_left(run: Running) -> str:
    """What the log says of the peer that left last."""
    return next((str(one["why"]) for one in reversed(run.caught_up()) if one["event"] == "peer left"), "")


def test_two_vehicles_each_with_its_certificate(proxy: Proxy) -> None:
    """Each hears the reports of itself, and the log says who came."""
    with proxy.call("12") as one, proxy.call("13") as other:
        for name, peer in (("12", one), ("13", other)):
            say(peer, *numbered(3, name))
            told = hear(peer, 3)
            assert [(report["vehicle"], report["cycle"]) for report in told] == [(name, 1), (name, 2), (name, 3)]
            assert told[-1]["interval_mm"] is not None
    introduced = [entry["vehicle"] for entry in proxy.run.caught_up() if entry["event"] == "peer introduced"]
    assert introduced[-2:] == ["12", "13"]


def test_a_certificate_cannot_speak_as_another_vehicle(proxy: Proxy) -> None:
    """What vehicle 22 says as 23 is refused to it; 23 hears nothing of it, and keeps its place."""
    drive = numbered(4, "23")
    fourth = drive[len(numbered(3)) :]
    with proxy.call("22") as one, proxy.call("23") as other:
        say(other, *drive[: -len(fourth)])
        assert hear(other, 3)[-1]["interval_mm"] is not None
        say(one, *fourth)
        refused = hear(one, len(fourth))
        assert {answer["event"] for answer in refused} == {"refused"}
        assert {answer["reason"].split(";")[0] for answer in refused} == {"a line of vehicle 23"}
        say(other, *fourth)
        (report,) = hear(other, 1)
    assert report["cycle"] == 4
    assert "rejections" not in report
    assert report["interval_mm"] is not None


@pytest.mark.parametrize("who", ["nobody", "a stranger", "one who was revoked"])
def test_without_a_good_certificate_nobody_is_heard(proxy: Proxy, theirs: Path, who: str) -> None:
    """The proxy ends the connection, and the process does not come to know of it."""
    name, folder = {"nobody": (None, None), "a stranger": ("12", theirs), "one who was revoked": ("99", None)}[who]
    before = proxy.came()
    with pytest.raises((ssl.SSLError, ConnectionError, EOFError)):
        proxy.drive(name, folder)
    assert proxy.came() == before + 1


def test_a_certificate_whose_name_is_none(proxy: Proxy) -> None:
    """It is good, and of no vehicle: the connection is closed, and the log says why."""
    with proxy.call("train@12") as peer:
        say(peer, *numbered(3, "12"))
        with pytest.raises((EOFError, ConnectionError)):
            hear(peer, 1)
    wait_for(lambda: "the certificate is of 'train@12'" in why_left(proxy.run), "no reason in the log")


def test_a_vehicle_knows_the_gateway(proxy: Proxy) -> None:
    """One that answers under another name is not it."""
    with pytest.raises(ssl.SSLCertVerificationError, match="Hostname mismatch"):
        proxy.call("12", host="elsewhere.example")


def test_who_passes_the_proxy_by(proxy: Proxy) -> None:
    """Is not heard, for nobody says who it is."""
    with socket.create_connection(("127.0.0.1", proxy.behind), PATIENCE_S) as peer:
        say(peer, *numbered(3, "12"))
        with pytest.raises((EOFError, ConnectionError)):
            hear(peer, 1)
    wait_for(lambda: "no PROXY header of version 2" in why_left(proxy.run), "no reason in the log")


def test_the_vehicles_own_command(proxy: Proxy) -> None:
    """`openssl s_client` as the docs show it speaks and hears."""
    text = DOCS.read_text(encoding="utf-8")
    match = re.search(r"openssl s_client .*?12\.key", text, re.DOTALL)
    assert match is not None
    command = match[0].replace("safeloc.example:8883", f"127.0.0.1:{proxy.port}").replace("12.", "42.")
    with subprocess.Popen(
        ["sh", "-ec", f"exec {command}"], cwd=proxy.ours, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    ) as process:  # fmt: skip
        assert process.stdin is not None is not process.stdout
        process.stdin.write("".join(numbered(3, "42")).encode())
        process.stdin.flush()
        told = [json.loads(process.stdout.readline()) for _ in range(3)]
        process.kill()
    assert [report["cycle"] for report in reports(told)] == [1, 2, 3]
