"""The broker as docs/fleet.md says it: its commands, packaging/mosquitto.conf and .acl, certificates and passwords."""

from __future__ import annotations

import getpass
import re
import selectors
import shutil
import ssl
import subprocess
import threading
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from paho.mqtt import client as mqtt

from safeloc.errors import InputError
from safeloc.runtime.service.broker.connection import Connection
from safeloc.runtime.service.broker.settings import read_broker
from safeloc.runtime.service.broker.topics import partition_of
from tests.free_port import free_port
from tests.runtime.service.broker.mosquitto import (
    PLAIN,
    Broker,
    broker,
    broker_file,
    messages,
    needs_mosquitto,
)
from tests.runtime.service.broker.workers import Worker, turn_for, turn_until
from tests.runtime.service.processes import PATIENCE_S, ROOT, numbered, wait_for

PAGE = ROOT / "docs" / "fleet.md"
pytestmark = [
    needs_mosquitto,
    pytest.mark.skipif(shutil.which("openssl") is None, reason="not installed: openssl"),
]


@dataclass(frozen=True)
class Site:
    """A broker with its files, and the port for processes."""

    broker: Broker
    folder: Path
    for_processes: int

    @property
    def url(self) -> str:
        """For the processes."""
        return f"mqtts://localhost:{self.for_processes}/fleet"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """Made by the page's commands, for the vehicles 12 and 13."""
    folder = tmp_path_factory.mktemp("site")
    shutil.copy(ROOT / "packaging" / "vehicles-ca.cnf", folder)
    for command in re.findall(r"```sh\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL):
        do(folder, command.replace("broker.example", "localhost"))
    do(folder, _vehicle(PAGE).replace("12", "13"))
    (folder / "safeloc.acl").write_text((ROOT / "packaging" / "mosquitto.acl").read_text(encoding="utf-8"))
    port = free_port()
    conf = (ROOT / "packaging" / "mosquitto.conf").read_text(encoding="utf-8")
    conf = conf.replace("/etc/mosquitto/safeloc/", f"{folder}/").replace(
        "/etc/mosquitto/safeloc.acl", f"{folder}/safeloc.acl"
    )
    conf = conf.replace("/var/lib/mosquitto/", f"{folder}/").replace("listener 8883", "listener {port} 127.0.0.1")
    conf = conf.replace("listener 8884", f"listener {port} 127.0.0.1")
    with broker(folder / "broker", f"user {getpass.getuser()}\n{conf}") as made:
        yield Site(made, folder, port)


def _vehicle(page: Path) -> str:
    """The command for the certificate of a vehicle."""
    found = re.findall(r"```sh\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    return next(one for one in found if "-keyout 12.key" in one)


def do(folder: Path, command: str) -> None:
    """In a shell there."""
    done = subprocess.run(["sh", "-ec", command], cwd=folder, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, f"{command}\n{done.stderr}"


class Vehicle:
    """A vehicle with its certificate."""

    def __init__(self, site: Site, name: str, session: str = "", certificate: str | None = None) -> None:
        self.heard: list[str] = []
        self.ended = threading.Event()
        self._connected = threading.Event()
        self.client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2, session, reconnect_on_failure=False)
        context = ssl.create_default_context(cafile=site.folder / "broker-cert.pem")
        certificate = name if certificate is None else certificate
        if certificate:
            context.load_cert_chain(site.folder / f"{certificate}.pem", site.folder / f"{certificate}.key")
        self.client.tls_set_context(context)
        self.client.on_connect = lambda *_: self._connected.set()
        self.client.on_disconnect = lambda *_: self.ended.set()
        self.client.on_message = lambda _client, _data, message: self.heard.append(message.topic)
        self.client.connect("localhost", site.broker.port)
        self.client.loop_start()

    def there(self) -> bool:
        """Whether the broker let it in."""
        wait_for(lambda: self._connected.is_set() or self.ended.is_set(), "an answer to the connection")
        return self._connected.is_set()

    def say(self, topic: str, payload: bytes) -> None:
        """Until the broker has it."""
        self.client.publish(topic, payload, 1).wait_for_publish(PATIENCE_S)

    def close(self) -> None:
        """Go."""
        self.client.disconnect()
        self.client.loop_stop()


def worker(site: Site, folder: Path) -> Worker:
    """A process with the certificate of the page."""
    files = {
        "authority_file": str(site.folder / "broker-cert.pem"),
        "certificate_file": str(site.folder / "safeloc.pem"),
        "key_file": str(site.folder / "safeloc.key"),
    }
    return Worker(site, folder, lease_ms=3_000, **files)


def test_each_vehicle_speaks_for_itself(site: Site, tmp_path: Path) -> None:
    """A vehicle with its certificate is heard and hears its reports. What it says for another one, or as a process, reaches
    nobody, and it hears nothing that is not its own."""
    process = worker(site, tmp_path / "one")
    turn_until(lambda: len(process.running) == 4, "owners", process)
    own = partition_of("12", 4)
    said = messages(numbered(6, "12"))
    attempt(site, f"fleet/records/{own}/12", said[0].replace(b"1200", b"9999"))
    attempt(site, f"fleet/leases/{own}", b'{"owner": ""}')
    attempt(site, f"fleet/reports/{own}/12", b"{}")
    vehicle, thief = Vehicle(site, "12"), Vehicle(site, "13")
    assert vehicle.there() and thief.there()
    for one in (vehicle, thief):
        one.client.subscribe("fleet/#", 1)
        one.client.subscribe(f"fleet/reports/{own}/12", 1)
    turn_for(0.2, process)
    for one in said:
        vehicle.say(f"fleet/records/{own}/12", one)
    turn_until(lambda: vehicle.heard.count(f"fleet/reports/{own}/12") >= 6, "reports", process)
    assert len(process.running) == 4
    assert not [one for one in thief.heard if not one.endswith("/13")]
    for gone in (vehicle, thief):
        gone.close()
    process.stop()


def attempt(site: Site, topic: str, payload: bytes) -> None:
    """Vehicle 13 says what it has no right to; the broker leaves it out, or ends the connection as well."""
    thief = Vehicle(site, "13")
    assert thief.there()
    info = thief.client.publish(topic, payload, 1)
    wait_for(lambda: thief.ended.is_set() or info.is_published(), "an answer")
    thief.close()


def test_a_vehicle_cannot_take_the_session_of_a_partition(site: Site, tmp_path: Path) -> None:
    """Its client identifier is its name, whatever it asks for."""
    process = worker(site, tmp_path / "one")
    turn_until(lambda: len(process.running) == 4, "owners", process)
    thief = Vehicle(site, "13", session="fleet/0")
    assert thief.there()
    turn_for(0.3, process)
    assert len(process.running) == 4
    assert not process.logged("partition lost")
    thief.close()
    process.stop()


@pytest.mark.parametrize("certificate", ["", "safeloc"])
def test_without_a_vehicles_certificate_nobody_is_heard(site: Site, certificate: str) -> None:
    """None, or one of another authority."""
    with suppress(OSError):  # refused within the handshake
        assert not Vehicle(site, "12", certificate=certificate).there()


@pytest.mark.parametrize("which", ["broker", "process"])
def test_a_process_and_its_broker_know_each_other(site: Site, tmp_path: Path, which: str) -> None:
    """A broker that the authority does not vouch for gets no password and no record; a process without a certificate of the
    processes' authority is not let in."""
    files = {
        "authority_file": str(site.folder / ("broker-cert.pem" if which == "process" else "vehicles-ca.pem")),
        "certificate_file": str(site.folder / ("12.pem" if which == "process" else "safeloc.pem")),
        "key_file": str(site.folder / ("12.key" if which == "process" else "safeloc.key")),
    }
    process = Worker(site, tmp_path / "one", **files)
    turn_until(lambda: len(process.logged("connecting")) > 1, "refused", process)
    assert not process.running
    process.stop()


def test_passwords(tmp_path: Path) -> None:
    """From a file, or from the environment; a wrong one is refused."""
    folder = tmp_path / "broker"
    folder.mkdir()
    do(folder, "mosquitto_passwd -b -c passwords safeloc right && chmod 600 passwords")
    conf = PLAIN.replace("allow_anonymous true", "allow_anonymous false\npassword_file {folder}/passwords")
    (tmp_path / "password").write_text("right\n", encoding="utf-8")
    with broker(folder, conf) as there:
        for given, environment, let_in in (
            ({"password_file": "password"}, {}, True),
            ({}, {"SAFELOC_BROKER_PASSWORD": "right"}, True),
            ({}, {"SAFELOC_BROKER_PASSWORD": "wrong"}, False),
            ({}, {}, False),
        ):
            settings = read_broker(there.url, broker_file(tmp_path, user="safeloc", **given), environment)
            assert "right" not in repr(settings)
            assert connected(Connection(settings, "x", ("will", b""), lasting=False)) is let_in


def connected(one: Connection) -> bool:
    """Whether the broker accepts it."""
    selector = selectors.PollSelector()
    one.open(selector)

    def done() -> Any:
        for key, mask in selector.select(0.01):
            list(key.data(mask))
        return one.ready or one.lost

    wait_for(done, "an answer")
    ready = one.ready
    one.close(politely=True)
    return ready


@pytest.mark.parametrize(
    ("url", "why"),
    [
        ("mqtts://user:secret@broker/fleet", "user or a password"),
        ("mqtt://broker.example/fleet", "only loopback"),
        ("mqtt://localhost:99999/fleet", "no port"),
        ("mqtt://localhost:0/fleet", "no port"),
        ("amqp://localhost/fleet", "no broker"),
        ("mqtt://localhost/fleet/+", "no broker"),
        ("mqtt://localhost/#", "no broker"),
        ("mqtt://localhost", "no broker"),
        ("mqtt://localhost/a//b", "no broker"),
        ("mqtt:///fleet", "no broker"),
    ],
)
def test_addresses_that_are_refused(url: str, why: str) -> None:
    """Before anything is sent. A password in the address is not repeated."""
    with pytest.raises(InputError, match=why) as refused:
        read_broker(url, None, {})
    assert "secret" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("partitions = 0", "partitions: Input should be greater than or equal to 1"),
        ("partitions = 1025", "partitions: Input should be less than or equal to 1024"),
        ("partitions = '16'", "partitions: Input should be a valid integer"),
        ("lease_ms = 1.5", "lease_ms: Input should be a valid integer"),
        ("lease_ms = 499", "lease_ms: Input should be greater than or equal to 500"),
        ("lease_ms = 600_001", "lease_ms: Input should be less than or equal to 600000"),
        ("user = ''", "user: String should have at least 1 character"),
        (f"user = '{'x' * 1_001}'", "user: String should have at most 1000 characters"),
        ("user = 3", "user: Input should be a valid string"),
        ("password = 'x'", "password: Extra inputs are not permitted"),
        ("partitions = [", "not TOML"),
        ("user = 'x'\npassword_file = 'none'", "none: cannot be read: No such file or directory"),
        ("user = 'x'\npassword_file = 'long'", "long: longer than 65536 bytes"),
        ("user = 'x'\npassword_file = 'latin'", "latin: not UTF-8"),
        ("password_file = 'word'", "a password without a user"),
        ("password_file = 1", "password_file: Input should be a valid string"),
        ("certificate_file = 'x'", "belong together"),
        ("key_file = 'x'", "belong together"),
        ("certificate_file = 'word'\nkey_file = 'word'", "word, word: no certificate or key"),
        ("authority_file = 'none'", "none: no certificate or key that can be used: No such file or directory"),
        ("authority_file = 'word'", "word: no certificate or key"),
        ("authority_file = true", "authority_file: Input should be a valid string"),
    ],
)
def test_files_that_are_refused(tmp_path: Path, text: str, why: str) -> None:
    """With the name of what is wrong."""
    path = tmp_path / "broker.toml"
    path.write_text(text, encoding="utf-8")
    for name, data in (("word", b"secret"), ("long", b"x" * 65_537), ("latin", b"\xe9")):
        (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=why) as refused:
        read_broker("mqtts://broker/fleet", path, {})
    assert "secret" not in str(refused.value)


def test_keys_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    """A key of another certificate, and one with a pass phrase, which no process that starts by itself could be asked for."""
    new = ("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-days", "1", "-subj", "/CN=a")
    for name in ("own", "other"):
        made = ("-noenc", "-keyout", f"{name}.key", "-out", f"{name}.pem")
        subprocess.run(["openssl", *new, *made], cwd=tmp_path, check=True, capture_output=True)
    hidden = ("ec", "-in", "own.key", "-aes256", "-passout", "pass:secret", "-out", "hidden.key")
    subprocess.run(["openssl", *hidden], cwd=tmp_path, check=True, capture_output=True)
    path = tmp_path / "broker.toml"
    for key, why in (("other", "own.pem, other.key: no certificate or key"), ("hidden", "the key is encrypted")):
        path.write_text(f"certificate_file = 'own.pem'\nkey_file = '{key}.key'\n", encoding="utf-8")
        with pytest.raises(InputError, match=why):
            read_broker("mqtts://broker/fleet", path, {})
    path.write_text("certificate_file = 'own.pem'\nkey_file = 'own.key'\n", encoding="utf-8")
    assert read_broker("mqtts://broker/fleet", path, {}).tls is not None


def test_a_password_of_the_environment_needs_a_user() -> None:
    """As one of a file; alone it would be sent to nobody, in silence."""
    with pytest.raises(InputError, match="a password without a user"):
        read_broker("mqtts://broker/fleet", None, {"SAFELOC_BROKER_PASSWORD": "x"})
