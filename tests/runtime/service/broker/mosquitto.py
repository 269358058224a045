"""Debian's mosquitto on a port of its own, and a vehicle's computer that speaks to it."""

from __future__ import annotations

import getpass
import json
import shutil
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from paho.mqtt import client as mqtt

from safeloc.runtime.service.broker.leases import read_lease
from safeloc.runtime.service.broker.topics import Topics, partition_of
from tests.free_port import free_port
from tests.runtime.service.processes import PATIENCE_S, Data, wait_for

PROGRAM = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin:/usr/local/sbin")
needs_mosquitto = pytest.mark.skipif(PROGRAM is None, reason="not installed: mosquitto")

PREFIX = "fleet"
PLAIN = """
user {user}
listener {port} 127.0.0.1
allow_anonymous true
persistence true
persistence_location {folder}/
max_inflight_messages 20000
max_queued_messages 0
message_size_limit 1000000
set_tcp_nodelay true
"""


class Broker:
    """A broker that can be stopped, killed and started again with what it has kept."""

    def __init__(self, folder: Path, settings: str = PLAIN) -> None:
        self.port, self._folder = free_port(), folder
        folder.mkdir(exist_ok=True)
        self._conf = folder / "mosquitto.conf"
        self._conf.write_text(settings.format(port=self.port, folder=folder, user=getpass.getuser()), encoding="utf-8")
        self.process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        """For --from."""
        return f"mqtt://127.0.0.1:{self.port}/{PREFIX}"

    def start(self) -> None:
        """Until it listens."""
        assert PROGRAM is not None
        with (self._folder / "log").open("ab") as log:
            self.process = subprocess.Popen([PROGRAM, "-c", str(self._conf)], stdout=log, stderr=log)
        wait_for(self._listens, "no broker")

    def _listens(self) -> bool:
        assert self.process is not None
        assert self.process.poll() is None, (self._folder / "log").read_text(encoding="utf-8")
        with socket.socket() as one:
            return one.connect_ex(("127.0.0.1", self.port)) == 0

    def end(self, number: int = signal.SIGTERM) -> None:
        """By a signal."""
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(number)
            self.process.wait(PATIENCE_S)


@contextmanager
def broker(folder: Path, settings: str = PLAIN) -> Iterator[Broker]:
    """A broker that does not outlive the test."""
    made = Broker(folder, settings)
    made.start()
    try:
        yield made
    finally:
        made.end(signal.SIGKILL)


class Gateway:
    """A client that sends for vehicles and hears everything that is said to them."""

    def __init__(self, port: int, partitions: int = 4, name: str = "gateway", prefix: str = PREFIX) -> None:
        self.topics = Topics(prefix, partitions)
        self.reports: list[Data] = []
        self.events: list[Data] = []
        self.leases: list[tuple[int, str]] = []
        self.client = mqtt.Client(
            mqtt.CallbackAPIVersion.VERSION2, name, clean_session=False, reconnect_on_failure=True
        )
        self.client.reconnect_delay_set(0.1, 0.2)  # type: ignore[arg-type]
        self.client.on_message = self._came
        self.client.on_connect = lambda *_: self._subscribe()
        self._subscribed = threading.Event()
        self.client.on_subscribe = lambda *_: self._subscribed.set()
        self.client.connect("127.0.0.1", port, 60)
        self.client.loop_start()
        assert self._subscribed.wait(PATIENCE_S)

    def _subscribe(self) -> None:
        self.client.subscribe([(f"{self.topics.prefix}/{kind}/#", 1) for kind in ("reports", "events", "leases")])

    def _came(self, _client: Any, _data: Any, message: mqtt.MQTTMessage) -> None:
        kind = message.topic.removeprefix(f"{self.topics.prefix}/").partition("/")[0]
        if kind == "leases":
            lease = read_lease(message.payload)
            if lease is not None:
                self.leases.append((int(message.topic.rpartition("/")[2]), lease.owner))
        else:
            (self.reports if kind == "reports" else self.events).append(json.loads(message.payload))

    def send(self, vehicle: str, payload: bytes, *, retained: bool = False) -> mqtt.MQTTMessageInfo:
        """A message of a vehicle."""
        partition = partition_of(vehicle, self.topics.partitions)
        return self.say(f"{self.topics.prefix}/records/{partition}/{vehicle}", payload, retained=retained)

    def say(self, topic: str, payload: bytes, *, retained: bool = False) -> mqtt.MQTTMessageInfo:
        """Any message."""
        return self.client.publish(topic, payload, 1, retained)

    def owners(self) -> dict[int, str]:
        """Who owns what, as the broker told it last."""
        return dict(self.leases)

    def by_cycle(self, vehicle: str) -> dict[int, Data]:
        """The reports of a vehicle; a cycle that was reported twice has to be reported alike."""
        found: dict[int, Data] = {}
        for one in [one for one in self.reports if one["vehicle"] == vehicle]:
            known = found.setdefault(one["cycle"], one)
            assert without_lines(known) == without_lines(one)
        return found

    def close(self) -> None:
        """Go."""
        self.client.loop_stop()
        self.client.disconnect()


def without_lines(report: Data) -> Data:
    """A report without the numbers of its refused lines, which each process counts for itself."""
    rejections = [{**one, "line": 0} for one in report.get("rejections", ())]
    return {**report, "rejections": rejections}


@contextmanager
def gateway(port: int, **settings: Any) -> Iterator[Gateway]:
    """A gateway that ends with the test."""
    made = Gateway(port, **settings)
    try:
        yield made
    finally:
        made.close()


def broker_file(folder: Path, partitions: int = 4, lease_ms: int = 1_000, **more: object) -> Path:
    """For --broker."""
    path = folder / "broker.toml"
    fields: dict[str, object] = {"partitions": partitions, "lease_ms": lease_ms, **more}
    path.write_text("".join(f"{name} = {json.dumps(value)}\n" for name, value in fields.items()), encoding="utf-8")
    return path


def messages(lines: Sequence[str]) -> list[bytes]:
    """The lines of a drive, a message for each cycle."""
    found: list[bytes] = []
    said: list[str] = []
    for line in lines:
        said.append(line)
        if '"cycle"' in line:
            found.append("".join(said).encode())
            said = []
    return [*found, "".join(said).encode()] if said else found


def paced(gateway: Gateway, vehicle: str, said: Sequence[bytes], seconds: float) -> None:
    """One message after the other, with a pause."""
    for one in said:
        gateway.send(vehicle, one)
        time.sleep(seconds)
