"""The topics on the broker, and the partition of a vehicle.

PREFIX/records/PARTITION/VEHICLE   lines of a vehicle, to the process (QoS 1)
PREFIX/reports/PARTITION/VEHICLE   its last report (retained)
PREFIX/events/PARTITION/VEHICLE    its refused lines and other events
PREFIX/leases/PARTITION            the process that owns the partition (retained, last will)
PREFIX/processes/PROCESS           a process that is there (retained, last will)
"""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass

from safeloc.runtime.service.messages import VEHICLE

PREFIX = re.compile(r"[A-Za-z0-9_.-]{1,64}(/[A-Za-z0-9_.-]{1,64}){0,7}")
"""A valid prefix: no wildcard, no empty level, nothing of the broker's own ($SYS)."""


def partition_of(vehicle: str, partitions: int) -> int:
    """Return the partition of a vehicle: CRC-32 of its name, modulo the number of partitions."""
    return zlib.crc32(vehicle.encode()) % partitions


@dataclass(frozen=True)
class Topics:
    """The topics below one prefix, for a fleet in so many partitions."""

    prefix: str
    partitions: int

    def records(self, partition: int) -> str:
        """Return the filter for the records of all vehicles of a partition."""
        return f"{self.prefix}/records/{partition}/+"

    def record(self, vehicle: str) -> str:
        """Return the topic of a vehicle's records."""
        return f"{self.prefix}/records/{partition_of(vehicle, self.partitions)}/{vehicle}"

    def report(self, partition: int, vehicle: str) -> str:
        """Return the topic of a vehicle's reports."""
        return f"{self.prefix}/reports/{partition}/{vehicle}"

    def event(self, partition: int, vehicle: str) -> str:
        """Return the topic of a vehicle's events."""
        return f"{self.prefix}/events/{partition}/{vehicle}"

    def lease(self, partition: int | str) -> str:
        """Return the topic of the lease of a partition; `+` for all."""
        return f"{self.prefix}/leases/{partition}"

    def process(self, name: str) -> str:
        """Return the topic of a process; `+` for all."""
        return f"{self.prefix}/processes/{name}"

    def session(self, partition: int) -> str:
        """Return the client identifier of a partition's session: the same for each process, so that one at a time has it."""
        return f"{self.prefix}/{partition}"

    def vehicle(self, topic: str, partition: int) -> str | None:
        """Return the vehicle of a topic of records of this partition; None if it names none, or one of another partition."""
        begin = f"{self.prefix}/records/{partition}/"
        vehicle = topic[len(begin) :]
        if not topic.startswith(begin) or VEHICLE.fullmatch(vehicle) is None:
            return None
        return vehicle if partition_of(vehicle, self.partitions) == partition else None

    def last_level(self, topic: str) -> str:
        """Return the last level of a topic: a partition, or a process."""
        return topic.rpartition("/")[2]
