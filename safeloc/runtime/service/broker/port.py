"""A partition's records and reports at the broker.

A record is acknowledged only when the vehicles that it changed are in a snapshot on disk, and after their reports: both go
over one connection, in order. What is not acknowledged comes again, to this process or to the next owner of the partition;
what came before is known by its content (`recent`).
"""

from __future__ import annotations

import selectors
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic_core import to_json

from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.connection import Connection
from safeloc.runtime.service.broker.packets import Came
from safeloc.runtime.service.broker.recent import Recent
from safeloc.runtime.service.broker.topics import Topics
from safeloc.runtime.service.feeds import Arrived, Event, Feed, Told
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.lines import LONGEST_LINE, Line
from safeloc.runtime.service.outlets import FULL, Outlet

MOST_LINES = 256
"""Most lines of one message; a vehicle sends a handful in a cycle. The rest is refused as one line."""

TURN_S = 0.005
"""Most seconds of a turn of one partition, up to the end of a message."""


class Beside(ABC):
    """Messages that a partition hears beside the records of its vehicles: not acknowledged, and of any age."""

    @abstractmethod
    def topics(self, partition: int) -> Iterable[str]:
        """Return the topics to subscribe to."""

    @abstractmethod
    def about(self, topic: str) -> str | None:
        """Return whom a message of this topic is about; None if it is none of these topics."""


class PartitionPort(Feed, Outlet):
    """The connection of a partition as a source of lines and a destination of reports. An origin is a vehicle.

    running   lines are handled: the vehicles are restored
    """

    def __init__(
        self, connection: Connection, topics: Topics, partition: int, journal: Journal, codes: Codes | None = None,
        beside: Beside | None = None,
    ) -> None:  # fmt: skip
        self._codes, self._beside = codes, beside
        self.running = False
        self.save_turn = partition / topics.partitions
        self._connection, self._topics, self._partition, self._journal = connection, topics, partition, journal
        self._recent = Recent()
        self.repeated = 0
        self._lines = 0
        self._held = False
        self._handled: deque[int] = deque()
        self._count = self._kept = self._acknowledged = 0
        self._waiting: deque[tuple[str, bytes, bool]] = deque()
        self._bytes = 0

    # ------------------------------------------------------------------ records

    def open(self, selector: selectors.BaseSelector) -> None:
        """Do nothing: the connection is opened before the partition is known to be one's own."""

    def resume(self, position: Mapping[str, Any]) -> str:
        """Continue, after the owner before: what it did not acknowledge comes again, and numbers show what is missing."""
        self._recent.resume(position)
        return "the partition came to another process, or its connection broke"

    def position(self) -> Mapping[str, Any]:
        """Return the last messages, for a snapshot: the next owner knows by them what comes again."""
        return {"recent": self._recent.position()}

    def hold(self, held: bool) -> None:
        """Stop handling records: what is not acknowledged waits, here up to the broker's limit, and else there."""
        self._held = held

    @property
    def live(self) -> bool:
        """Return whether silence counts: not while records wait."""
        return self.running and not self._connection.came

    @property
    def again_s(self) -> float | None:
        """Return 0 while there are records to handle."""
        return 0.0 if self.running and not self._held and self._connection.came else None

    def look(self) -> Iterator[Event]:
        """Yield the lines of messages that have come, for a short time."""
        until = time.monotonic() + TURN_S
        came = self._connection.came
        while self.running and not self._held and came and time.monotonic() < until:
            one = came.popleft()
            yield from self._of_one(one)
            self._count += 1
            self._handled.append(one.mid)

    def mark(self) -> int:
        """Return the number of messages that were handled."""
        return self._count

    def kept(self, mark: int) -> None:
        """Note that everything up to a mark is in a snapshot on disk: it is acknowledged behind the waiting reports."""
        self._kept = max(self._kept, mark)

    def _of_one(self, came: Came) -> Iterator[Event]:
        about = None if self._beside is None else self._beside.about(came.topic)
        if about is not None:
            yield Told(about, came.payload)
            return
        vehicle = self._topics.vehicle(came.topic, self._partition)
        if vehicle is None or came.retained:
            why = "a retained record is of any age" if vehicle else "no vehicle of this partition"
            self._journal.warning("message refused", topic=came.topic[:200], why=why)
            return
        if len(came.payload) > MOST_LINES * LONGEST_LINE:
            yield self._line(vehicle, b"", f"a message of {len(came.payload)} bytes")
            return
        if self._recent.came_before(vehicle, came.payload, again=came.again):
            self.repeated = (self.repeated or 0) + (came.payload.count(b"\n") or 1)
            return
        for number, text in enumerate(came.payload.split(b"\n", MOST_LINES)):
            if text or not came.payload:
                flaw = f"more than {MOST_LINES} lines in one message" if number == MOST_LINES else ""
                yield self._line(vehicle, text, flaw or _too_long(text))

    def _line(self, vehicle: str, text: bytes, flaw: str) -> Arrived:
        self._lines += 1
        return Arrived(vehicle, Line(self._lines, b"" if flaw else text, flaw), vehicle)

    # ------------------------------------------------------------------ reports

    def text(self, one: Mapping[str, Any]) -> bytes:
        """Return a report or an event without spaces between names and values, made in a third of the time."""
        try:
            return to_json(one) + b"\n"
        except ValueError:  # half a character, quoted from a line
            return super().text(one)

    def put(self, origin: str, data: bytes, *, event: bool = False) -> None:
        """Add a report or an event for the vehicle's topic."""
        self._waiting.append((origin, data, event))
        self._bytes += len(data)

    def flush(self) -> None:
        """Hand waiting lines to the connection; if the broker takes no more now, keep the rest."""
        while self._waiting and not self._connection.lost and not self._connection.waiting:
            self._some()
            self._connection.flush()
        if not self._waiting and not self._connection.lost and self._acknowledged < self._kept:
            self._acknowledge()
            self._connection.flush()

    def _acknowledge(self) -> None:
        """Acknowledge what is in a snapshot, in the order in which it came."""
        while self._acknowledged < self._kept:
            mid = self._handled.popleft()
            self._acknowledged += 1
            if mid:
                self._connection.acknowledge(mid)

    def _some(self) -> None:
        for _ in range(min(len(self._waiting), MOST_LINES)):
            vehicle, data, event = self._waiting.popleft()
            self._bytes -= len(data)
            topic = (self._topics.event if event else self._topics.report)(self._partition, vehicle)
            text = data[:-1]
            if self._codes is not None and not event:
                text = self._codes.added(topic, text)
            self._connection.publish(topic, text, retained=not event)

    @property
    def full(self) -> bool:
        """Return whether the broker is too slow."""
        return self._bytes > FULL

    @property
    def waiting(self) -> bool:
        """Return whether reports wait for the broker."""
        return not self._connection.lost and (bool(self._waiting) or self._connection.waiting)

    def close(self) -> None:
        """Handle no more records; the connection is closed by its owner."""
        self.running = False


def _too_long(text: bytes) -> str:
    return f"longer than {LONGEST_LINE} bytes" if len(text) > LONGEST_LINE else ""
