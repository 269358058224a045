"""Leases: which process owns which partition, and when another one may take it.

Each process decides for itself, by what the broker has told it, with its own monotonic clock; no clocks are compared.

- An owner renews its lease by a retained message. It stops when no renewal was confirmed within `STOP_SHARE` of the lease,
  counted from the moment when the last confirmed one was sent.
- Another process may take a partition when the lease was given up, when the broker published the owner's last will, or when
  nothing was heard of the lease for its whole length, counted from the moment when the last message arrived.
- The last will of a worker, which its parent starts again at once, says so: its partitions wait for it, for `BACK_S`. The
  other workers take nothing and give nothing back; only if it does not come, they take what it had.

A message arrives after it was sent; so the owner has stopped before a partition is taken, if the rates of both clocks differ
by less than a tenth and if the owner's confirmed renewal reached the other process within the lease. Where the broker holds
a renewal back for longer, the session decides: whoever connects as the partition ends the connection of the one before, and
that one can neither hear records nor say reports any more.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import NamedTuple

STOP_SHARE = 0.7
"""Share of the lease after which an owner stops that was not confirmed."""

RENEW_SHARE = 0.2
"""Share of the lease after which it is renewed."""


BACK_S = 1.5
"""Seconds for which the partitions of a worker that ended wait for it: three times what its start takes."""

_LONGEST_BACK_MS = 10_000
"""Longest wait that is believed; a lease may ask for a whole length by its renewals."""


class Lease(NamedTuple):
    """Tells the owner of a partition, or that a process is there.

    owner   the owner; "" if it is free
    back_s  the owner ended, and is expected again within so many seconds; None if it did not end
    """

    owner: str
    back_s: float | None = None


def lease_text(owner: str, epoch: int = 0, back_s: float | None = None) -> bytes:
    """Return the content of a lease; without an owner it is free."""
    back = {} if back_s is None else {"back_ms": round(back_s * 1_000)}
    return json.dumps({"owner": owner, "epoch": epoch, **back}).encode()


def read_lease(text: bytes) -> Lease | None:
    """Return what a message says of a lease, and an empty one that it is free; None if it is no lease."""
    try:
        found = json.loads(text) if text else {"owner": ""}
    except (ValueError, RecursionError):
        return None
    owner = found.get("owner") if isinstance(found, dict) else None
    if not isinstance(owner, str) or len(owner) > 64:
        return None
    back_ms: object = found.get("back_ms")
    if type(back_ms) is int and 0 <= back_ms <= _LONGEST_BACK_MS:
        return Lease(owner, back_ms / 1_000)
    return Lease(owner)


@dataclass
class _Heard:
    owner: str
    at: float


class Leases:
    """The leases and the other processes, as far as this process was told of them.

    me        the name of this process
    length_s  length of a lease
    """

    def __init__(self, me: str, partitions: int, length_s: float) -> None:
        self._me, self._partitions, self._length_s = me, partitions, length_s
        self._leases: dict[int, _Heard] = {}
        self._processes: dict[str, float] = {}

    def heard_lease(self, partition: int, lease: Lease, now: float) -> None:
        """Note a lease that the broker told."""
        self._leases[partition] = _Heard(lease.owner, self._renewed_at(lease, now))

    def heard_process(self, name: str, lease: Lease, now: float) -> None:
        """Note that a process is there, that it went (no owner), or that it ended and is expected again."""
        if lease.owner:
            self._processes[name] = self._renewed_at(lease, now)
        else:
            self._processes.pop(name, None)

    def _renewed_at(self, lease: Lease, now: float) -> float:
        """Return from when on a lease counts, so that it ends when its owner is no longer expected."""
        return now if lease.back_s is None else now - max(0.0, self._length_s - lease.back_s)

    def pass_over(self, now: float) -> None:
        """Begin to count silence anew: this process could not hear anything until now."""
        for heard in self._leases.values():
            heard.at = max(heard.at, now)
        self._processes = dict.fromkeys(self._processes, now)

    def owner(self, partition: int, now: float) -> str:
        """Return the owner of a partition; "" if it may be taken."""
        heard = self._leases.get(partition)
        return "" if heard is None or now - heard.at > self._length_s else heard.owner

    def waiting_for_me(self, now: float) -> list[int]:
        """Return the partitions whose lease names this process: its own, or those that wait for a worker that ended."""
        return [one for one in self._leases if self.owner(one, now) == self._me]

    def processes(self, now: float) -> list[str]:
        """Return the processes that were heard within a lease, this one among them."""
        there = {name for name, at in self._processes.items() if now - at <= self._length_s}
        return sorted(there | {self._me})

    def mine(self, now: float, held: Collection[int]) -> set[int]:
        """Return the partitions that this process should own, as far as it holds them or may take them."""
        owners = {one: self._me if one in held else self.owner(one, now) for one in range(self._partitions)}
        return {one for one, owner in divided(owners, self.processes(now)).items() if owner == self._me}


def divided(owners: Mapping[int, str], processes: Collection[str]) -> dict[int, str]:
    """Return who should own each partition, in shares that differ by one at most.

    Every process comes to the same result from the same owners. Nothing moves that need not: an owner keeps its partitions
    up to its share. A partition whose owner is not among the processes stays with it until its lease ends; one that is beyond
    the share of its owner is nobody's ("") until it was given up.
    """
    held = {name: sorted(one for one, owner in owners.items() if owner == name) for name in processes}
    least, more = divmod(len(owners), len(processes))
    largest_first = sorted(processes, key=lambda name: (-len(held[name]), name))
    share = {name: least + (place < more) for place, name in enumerate(largest_first)}
    found = {one: owner for one, owner in owners.items() if owner and owner not in held}
    for name in processes:
        found |= dict.fromkeys(held[name][: share[name]], name)
        found |= dict.fromkeys(held[name][share[name] :], "")
    counts = {name: min(len(held[name]), share[name]) for name in processes}
    for one in sorted(one for one, owner in owners.items() if not owner):
        name = min(processes, key=lambda name: (counts[name] - share[name], name))
        found[one] = name
        counts[name] += 1
    return found
