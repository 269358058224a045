"""Processes of a fleet inside the test: each is turned by hand, and may be killed or hang at any moment."""

from __future__ import annotations

import json
import os
import selectors
import socket
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol

from safeloc.runtime.service.broker.division import Division
from safeloc.runtime.service.broker.port import PartitionPort
from safeloc.runtime.service.broker.settings import Broker, read_broker
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.lines import Line
from safeloc.runtime.service.saving import Saver
from safeloc.runtime.service.station import Parts, Station
from tests.runtime.embedding.driving import trusting
from tests.runtime.service.broker.mosquitto import broker_file, without_lines
from tests.runtime.service.processes import PATIENCE_S, Data, read

SETTINGS = FleetSettings(100, numbered=True)


class Addressed(Protocol):
    """A broker that can be named."""

    @property
    def url(self) -> str:
        """For --from."""


class Worker:
    """What `safeloc run --from mqtt://...` does, turn by turn."""

    def __init__(
        self, there: Addressed, folder: Path, *, save_every_s: float = 0.05, worker: str | None = None, **settings: Any
    ) -> None:
        trusting()  # compiled once, and not while a lease runs
        folder.mkdir(exist_ok=True)
        self._log = folder / f"log-{id(self)}"
        self._fd = os.open(self._log, os.O_WRONLY | os.O_CREAT)
        self.journal = Journal(self._fd)
        self.stations: list[Station] = []
        self._save_every_s, self._worker = save_every_s, worker
        broker = read_broker(there.url, broker_file(folder, **settings), {})
        self.division = self._divided(broker, folder / "kept")
        self.selector = selectors.PollSelector()
        self.division.open(self.selector)

    @property
    def name(self) -> str:
        """What it calls itself."""
        return self.division.name

    def _divided(self, broker: Broker, folder: Path) -> Division:
        return Division(broker, folder, "odometry", self._station, self.journal, worker=self._worker)

    def _fleet(self) -> Fleet:
        return Fleet(trusting(), SETTINGS)

    def _station(self, port: PartitionPort, path: Path) -> Station:
        fleet = self._fleet()
        self.stations.append(Station(Parts(port, port, fleet, self.journal, Saver(path), self._save_every_s)))
        return self.stations[-1]

    @property
    def running(self) -> set[int]:
        """The partitions whose vehicles it steps."""
        return {number for number, one in self.division.tenures.items() if one.station is not None}

    def turn(self) -> None:
        """One turn of its loop."""
        for key, mask in self.selector.select(0.002):
            self.division.take(key.data(mask))
        self.division.turn()

    def kill(self) -> None:
        """As kill -9: the system closes its sockets, and nothing is saved or said."""
        for key in list(self.selector.get_map().values()):
            with socket.socket(fileno=os.dup(key.fd)) as sock:
                sock.shutdown(socket.SHUT_RDWR)
        os.close(self._fd)

    def stop(self) -> None:
        """As SIGTERM."""
        self.division.end(failed=False)
        os.close(self._fd)

    def logged(self, event: str) -> list[Data]:
        """What it said of it."""
        return [one for one in read(self._log.read_bytes()) if one["event"] == event]


def turn_until(condition: Callable[[], bool], what: str, *workers: Worker) -> None:
    """All of them in turn, until it holds."""
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, what
        for one in workers:
            one.turn()


def turn_for(seconds: float, *workers: Worker) -> None:
    """All of them in turn, for so long."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        for one in workers:
            one.turn()


def alone(vehicle: str, said: Sequence[str]) -> list[Data]:
    """The reports of a vehicle whose lines reach one process, each once and in order."""
    fleet = Fleet(trusting(), SETTINGS)
    told = [
        one
        for number, text in enumerate(said, 1)
        for one in fleet.handle(vehicle, Line(number, text.strip().encode()), from_start=False)
    ]
    return [without_lines(json.loads(json.dumps(one))) for one in told if "mode" in one]
