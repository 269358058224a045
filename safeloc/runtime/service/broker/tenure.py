"""A tenure: the time in which this process owns a partition, from the connection to its end.

It connects as the partition, which ends the connection of whoever owned it before; claims an epoch; asks the broker to
confirm that the session is still its own; goes on from the last snapshot of the owners before; and renews the lease until
the partition is released, or lost.
"""

from __future__ import annotations

import selectors
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from safeloc.errors import SafelocError
from safeloc.runtime.service.broker.connection import Connection
from safeloc.runtime.service.broker.epochs import Epochs
from safeloc.runtime.service.broker.leases import RENEW_SHARE, STOP_SHARE, lease_text
from safeloc.runtime.service.broker.port import Beside, PartitionPort
from safeloc.runtime.service.broker.settings import Broker
from safeloc.runtime.service.broker.topics import Topics
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.station import Station

_LONGEST_S = 0.5
"""Most seconds between two turns of a station to which nothing comes."""

Left = tuple[int, Mapping[str, Any]]
"""The epoch of a tenure that ended with its connection, and what was in memory then."""

MakeStation = Callable[[PartitionPort, Path], Station]
"""Port and file for snapshots -> station with new vehicles."""


class Tenure:
    """One partition that this process owns, or is about to.

    lost      why it is over; "" as long as it is not
    station   its vehicles; None until they are restored
    left      what was in memory when the connection broke, of this tenure or of the one of this process before: a broker
              that has lost the session brings nothing again that is in no snapshot
    """

    def __init__(
        self, broker: Broker, topics: Topics, me: str, partition: int, folder: Path, make: MakeStation, journal: Journal,
        last_will: bytes, left: Left | None = None, beside: Beside | None = None,
    ) -> None:  # fmt: skip
        self.lost = ""
        self.left = left
        self.station: Station | None = None
        self.partition = partition
        self._topics, self._me, self._make, self._journal = topics, me, make, journal
        self._lease_s = broker.lease_s
        self._epochs, self._epoch = Epochs(folder, partition), 0
        will = (topics.lease(partition), last_will)
        self._connection = Connection(broker, topics.session(partition), will, lasting=True)
        self._beside = beside
        self._port = PartitionPort(self._connection, topics, partition, journal, broker.codes, beside)
        self._renewal: Any = None
        self._sent_at = self._valid_from = time.monotonic()
        self._saved = False
        self._turn_at = 0.0

    def open(self, selector: selectors.BaseSelector) -> None:
        """Connect as the partition: from here on its owner before hears and says nothing more."""
        self._selector = selector
        self._connection.open(selector)

    def turn(self, stop_by: float) -> None:
        """Do what is due. Before anything is said, look whether the lease still holds."""
        now = time.monotonic()
        self._connection.look()
        if not self._holds(now):
            return
        if self._connection.ready and not self._epoch:
            self._claim()
        self._see_renewal()
        if self.station is not None:
            if self._connection.came or now >= self._turn_at or self._port.waiting:
                self._turn(self.station, stop_by)
            if now >= self._sent_at + RENEW_SHARE * self._lease_s and self._renewal is None:
                self._renew()
        self._connection.flush()

    def patience_s(self) -> float | None:
        """Return the time until the next turn."""
        return None if self.station is None else max(0.0, self._turn_at - time.monotonic())

    def _turn(self, station: Station, stop_by: float) -> None:
        station.stop_by = stop_by
        station.turn()
        patience_s = station.patience_s()
        self._turn_at = time.monotonic() + (_LONGEST_S if patience_s is None else min(patience_s, _LONGEST_S))
        self._forget_others()

    def release(self) -> None:
        """Save, give the partition up and end the connection, so that another process may take it at once."""
        self.lost = "released"
        if self.station is not None:
            self.station.end(failed=False)
            self._port.flush()
            self._connection.publish(self._topics.lease(self.partition), lease_text(""), qos=1, retained=True)
        self._connection.close(politely=True)
        self._journal.info("partition released", partition=self.partition, epoch=self._epoch)

    def drop(self, why: str) -> None:
        """Let go of everything, without saving: another process may own the partition by now."""
        self.lost = why
        self._connection.close(politely=False)
        if self.station is not None:
            self.left = (self._epoch, self.station.memory())
            self.station.end(failed=True)
        self._journal.warning("partition lost", partition=self.partition, epoch=self._epoch, why=why)

    def sums(self) -> Mapping[str, int]:
        """Return the counts of its vehicles."""
        return {} if self.station is None else self.station.sums()

    # ------------------------------------------------------------------ the lease

    def _holds(self, now: float) -> bool:
        if self._connection.lost:
            self.drop(self._connection.lost)
        elif now > self._valid_from + STOP_SHARE * self._lease_s:
            self._see_renewal()
            if now > self._valid_from + STOP_SHARE * self._lease_s:
                self.drop(f"the broker confirmed no lease for {STOP_SHARE * self._lease_s:g} s")
        return not self.lost

    def _claim(self) -> None:
        """Claim an epoch, then ask the broker whether the session is still one's own."""
        self._epoch = self._epochs.claim()
        self._connection.subscribe(self._topics.records(self.partition))
        for topic in () if self._beside is None else self._beside.topics(self.partition):
            self._connection.subscribe(topic)
        self._renew()

    def _renew(self) -> None:
        self._sent_at = time.monotonic()
        text = lease_text(self._me, self._epoch)
        self._renewal = self._connection.publish(self._topics.lease(self.partition), text, qos=1, retained=True)

    def _see_renewal(self) -> None:
        if self._renewal is None or not self._renewal.is_published():
            return
        self._renewal, self._valid_from = None, self._sent_at
        if self.station is None:
            try:
                self.station = self._restored()
            except SafelocError as error:
                self.drop(f"its vehicles cannot be restored: {error}")

    def _restored(self) -> Station:
        """Return the vehicles as the owners before left them."""
        saved = self._from_memory() or self._epochs.last(self._epoch)
        station = self._make(self._port, self._epochs.path(self._epoch))
        if saved is not None:
            station.restore(saved)
        station.open(self._selector)
        self._port.running = True
        self._journal.info(
            "partition taken", partition=self.partition, epoch=self._epoch, session=self._connection.resumed
        )
        return station

    def _from_memory(self) -> Mapping[str, Any] | None:
        """Return what this process still knows, if nobody owned the partition since and the broker brings nothing again."""
        left, self.left = self.left, None
        if left is None or self._connection.resumed or not self._epochs.alone_between(left[0], self._epoch):
            return None
        return left[1]

    def _forget_others(self) -> None:
        """Remove the snapshots of owners before, as soon as there is one of this epoch."""
        if not self._saved and self._epochs.path(self._epoch).exists():
            self._saved = True
            self._epochs.forget_before(self._epoch)
