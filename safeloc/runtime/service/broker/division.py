"""The part of a fleet that this process works on: it takes partitions, releases them, and turns their stations.

The division follows from the leases (`leases.divided`). Two connections to the broker are of different kinds: one of the
process, over which it hears who is there and who owns what; and one for each partition, over which records come and
reports go.
"""

from __future__ import annotations

import secrets
import selectors
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

from safeloc.runtime.service.broker.connection import Connection
from safeloc.runtime.service.broker.epochs import require_layout
from safeloc.runtime.service.broker.leases import BACK_S, RENEW_SHARE, Lease, Leases, lease_text, read_lease
from safeloc.runtime.service.broker.packets import Came
from safeloc.runtime.service.broker.port import Beside
from safeloc.runtime.service.broker.settings import Broker
from safeloc.runtime.service.broker.tenure import Left, MakeStation, Tenure
from safeloc.runtime.service.broker.topics import Topics
from safeloc.runtime.service.feeds import Event
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.station import Work

_SETTLE_S = 0.3
"""Seconds after subscribing until the retained leases and processes count as heard; a worker for which partitions wait takes
them before."""

_DECIDE_S = 0.05
"""Seconds between two decisions about who owns what."""

_AGAIN_S = 0.2
"""Seconds between two attempts to connect."""

_AFTER_LOSS = 0.5
"""Share of the lease for which a partition that was lost is not taken again: another process may just have taken it."""


class Division(Work):
    """The partitions of this process.

    worker   its name, if a parent starts it again at once under this name when it ends; None: it has a name of its own, and
             nobody waits for it
    """

    def __init__(
        self, broker: Broker, folder: Path, machine: str, make: MakeStation, journal: Journal,
        beside: Beside | None = None, worker: str | None = None,
    ) -> None:  # fmt: skip
        require_layout(folder, broker.partitions)
        self.tenures: dict[int, Tenure] = {}
        self.name = secrets.token_hex(8) if worker is None else worker
        self._back_s = None if worker is None else BACK_S
        self.gather_s = broker.gather_s
        self._broker, self._folder, self._machine, self._make, self._journal = broker, folder, machine, make, journal
        self._beside = beside
        self._topics = Topics(broker.prefix, broker.partitions)
        self._leases = Leases(self.name, broker.partitions, broker.lease_s)
        self._control = self._new_control()
        self._subscribed_at: float | None = None
        self._connect_at = self._decide_at = self._renew_at = self._settled_at = 0.0
        self._turned_at = time.monotonic()
        self._not_before: dict[int, float] = {}
        self._left: dict[int, Left] = {}
        self._past: Counter[str] = Counter({"wrong": 0, "cycles": 0})

    @property
    def machine(self) -> str:
        """The machine's name."""
        return self._machine

    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin to connect; a broker that is not there yet is waited for."""
        self._selector = selector
        self._control.open(selector)

    def take(self, events: Iterator[Event]) -> None:
        """Let the connection read and write; what came is handled in `turn`."""
        for _ in events:
            pass

    def turn(self) -> None:
        """Hear who is there, turn each partition, and decide."""
        now = time.monotonic()
        if now > self._turned_at + self._broker.lease_s / 2:
            self._leases.pass_over(now)  # this process stood still, and heard nothing
        self._turned_at = now
        self._hear(now)
        for tenure in list(self.tenures.values()):
            tenure.turn(self.stop_by)
            if tenure.lost:
                self._ended(tenure, now)
        if now >= self._decide_at:
            self._decide_at = now + _DECIDE_S
            self._decide(now)
        self._control.flush()
        self.gather_s = 0.0 if self._taking(now) else self._broker.gather_s

    def _taking(self, now: float) -> bool:
        """Return whether partitions wait for answers of the broker: each of some ten would come a rest later."""
        heard = self._subscribed_at is not None and now >= self._settled_at
        return not heard or any(one.station is None for one in self.tenures.values())

    def patience_s(self) -> float | None:
        """Return the time until the next turn."""
        limits = [tenure.patience_s() for tenure in self.tenures.values()]
        return min((_DECIDE_S, *(limit for limit in limits if limit is not None)))

    def finish(self) -> None:
        """Do nothing: records never end."""

    def end(self, *, failed: bool) -> None:
        """Release all partitions; after a failure nothing is saved, and the broker publishes the last wills."""
        waiting = self._waiting_for_me()
        for tenure in self.tenures.values():
            if failed:
                tenure.drop("the process failed")
            else:
                tenure.release()
            self._past.update(tenure.sums())
        self.tenures.clear()
        if not failed and self._control.ready:
            for partition in waiting:
                self._control.publish(self._topics.lease(partition), lease_text(""), qos=1, retained=True)
            self._control.publish(self._topics.process(self.name), b"", qos=1, retained=True)
        self._control.close(politely=not failed)

    def _waiting_for_me(self) -> list[int]:
        """Return the partitions that wait for this worker, and that it does not own yet."""
        running = {number for number, tenure in self.tenures.items() if tenure.station is not None}
        return [one for one in self._leases.waiting_for_me(time.monotonic()) if one not in running]

    def sums(self) -> Mapping[str, int]:
        """Return the counts since the start, over all partitions that this process has owned."""
        found = Counter(self._past)
        for tenure in self.tenures.values():
            found.update(tenure.sums())
        return found

    def gauges(self) -> Mapping[str, int]:
        """Return what there is of each kind now, for metrics."""
        stations = [tenure.station for tenure in self.tenures.values() if tenure.station is not None]
        found: Counter[str] = Counter({"vehicles": 0, "localized": 0, "partitions": len(stations)})
        for station in stations:
            found.update(station.gauges())
        return found

    # ------------------------------------------------------------------ who is there

    @property
    def _last_will(self) -> bytes:
        """Return what the broker tells of a partition or of the process itself if its connection breaks."""
        return lease_text("") if self._back_s is None else lease_text(self.name, back_s=self._back_s)

    def _new_control(self) -> Connection:
        will = (self._topics.process(self.name), self._last_will)
        return Connection(self._broker, f"{self._broker.prefix}/{self.name}", will, lasting=False)

    def _hear(self, now: float) -> None:
        control = self._control
        control.look()
        if control.lost:
            self._reconnect(now)
            return
        if control.ready and self._subscribed_at is None:
            control.subscribe(self._topics.lease("+"))
            control.subscribe(self._topics.process("+"))
            self._subscribed_at, self._renew_at, self._settled_at = now, now, now + _SETTLE_S
            self._leases.pass_over(now)
        while control.came:
            came = control.came.popleft()
            self._hear_one(came, now)
        if control.ready and now >= self._renew_at:
            self._renew_at = now + RENEW_SHARE * self._broker.lease_s
            control.publish(self._topics.process(self.name), lease_text(self.name), retained=True)

    def _hear_one(self, came: Came, now: float) -> None:
        topic, last = came.topic, self._topics.last_level(came.topic)
        lease = read_lease(came.payload)
        if topic == self._topics.process(last):
            lease = lease or Lease(last)  # of a version before, which says less of itself
            self._leases.heard_process(last[:64], lease, now)
            if last == self.name and not came.retained and self._leases.waiting_for_me(now):
                self._settled_at = now  # its own message came back, and so all that was retained before
        elif topic != self._topics.lease(last) or not last.isdecimal() or int(last) >= self._broker.partitions:
            return
        elif lease is None:
            self._journal.warning("message refused", topic=topic[:200], why="no lease")
            return
        else:
            self._leases.heard_lease(int(last), lease, now)
        if not lease.owner:
            self._decide_at = now  # what is free is taken in this turn

    def _reconnect(self, now: float) -> None:
        if self._subscribed_at is not None:
            self._journal.warning("broker lost", why=self._control.lost)
            self._subscribed_at = None
            self._not_before.clear()  # the broker went, and not a partition to another process
        if now >= self._connect_at:
            self._connect_at = now + _AGAIN_S
            self._journal.warning("connecting", why=self._control.lost)
            self._control = self._new_control()
            self._control.open(self._selector)

    # ------------------------------------------------------------------ who owns what

    def _decide(self, now: float) -> None:
        if self._subscribed_at is None or now < self._settled_at:
            return
        wanted = self._leases.mine(now, self.tenures)
        for partition in [one for one in self.tenures if one not in wanted]:
            tenure = self.tenures[partition]
            if tenure.station is not None:
                tenure.release()
                self._ended(tenure, now)
        for partition in sorted(wanted - self.tenures.keys()):
            if now >= self._not_before.get(partition, 0.0):
                self._take(partition)

    def _take(self, partition: int) -> None:
        tenure = Tenure(
            self._broker, self._topics, self.name, partition, self._folder, self._make, self._journal,
            self._last_will, self._left.pop(partition, None), self._beside,
        )  # fmt: skip
        self.tenures[partition] = tenure
        tenure.open(self._selector)

    def _ended(self, tenure: Tenure, now: float) -> None:
        del self.tenures[tenure.partition]
        self._past.update(tenure.sums())
        if tenure.left is not None:
            self._left[tenure.partition] = tenure.left
        if self._control.ready and not self._control.lost:
            self._not_before[tenure.partition] = now + _AFTER_LOSS * self._broker.lease_s
