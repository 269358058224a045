"""Messages that come again: each is known by its content, among the last ones of its vehicle.

A broker delivers at least once: it sends again what was not acknowledged, and what a vehicle has sent again after its
connection broke. Numbers alone would show it, but many lines with passed numbers in a row are also what a vehicle sends that
has restarted its count; so such lines are not left out by their numbers.

A vehicle that restarts count and clock, and stands still, sends the content of its first messages again. Therefore these are
known only if the broker says itself that it sends again (DUP), and all others from a number on that the vehicle cannot reach
again without its restart being noticed.
"""

from __future__ import annotations

import re
from collections import Counter, deque
from collections.abc import Mapping, Sequence
from hashlib import blake2b
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from safeloc.runtime.service.saved_fields import checked_fields

_MOST_MESSAGES = 128
"""Messages of a vehicle that are remembered: some ten seconds."""

_EARLY_LINES = 1_000
"""Numbers up to this one count as those of the first messages of a vehicle."""

_MOST_VEHICLES = 2_000
_BYTES = 8
_NUMBER = re.compile(rb'"number": ?([0-9]{1,18})')
_Digests = Annotated[str, Field(pattern=r"^([0-9a-f]{16})*$", max_length=_MOST_MESSAGES * _BYTES * 2)]


class _Saved(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True)

    recent: dict[str, _Digests] = {}


class _Last:
    """The last messages of one vehicle in their order, and how often each is among them: early ones may be equal."""

    def __init__(self) -> None:
        self.order: deque[bytes] = deque()
        self.times: dict[bytes, int] = {}

    def add(self, digest: bytes) -> None:
        """Remember a message; forget the oldest beyond the most."""
        self.order.append(digest)
        self.times[digest] = self.times.get(digest, 0) + 1
        if len(self.order) > _MOST_MESSAGES:
            oldest = self.order.popleft()
            self.times[oldest] -= 1
            if not self.times[oldest]:
                del self.times[oldest]

    def restore(self, digests: Sequence[bytes]) -> None:
        """Remember these, which are not too many, and no others."""
        self.order, self.times = deque(digests), dict(Counter(digests))


class Recent:
    """The last messages of each vehicle, as digests."""

    def __init__(self) -> None:
        self._of: dict[str, _Last] = {}

    def came_before(self, vehicle: str, payload: bytes, *, again: bool) -> bool:
        """Return whether a message came before; if not, remember it. `again`: the broker says that it sends it again."""
        digest = blake2b(payload, digest_size=_BYTES).digest()
        known = self._of.get(vehicle)
        if known is None:
            known = self._remembered(vehicle)
        elif digest in known.times and (again or _first_number(payload) > _EARLY_LINES):
            return True
        known.add(digest)
        return False

    def position(self) -> Mapping[str, str]:
        """Return the memory, for a snapshot."""
        return {vehicle: b"".join(known.order).hex() for vehicle, known in self._of.items()}

    def resume(self, position: Mapping[str, object]) -> None:
        """Continue with the memory of a snapshot; SnapshotError if it is none."""
        for vehicle, text in checked_fields(_Saved, position).recent.items():
            data = bytes.fromhex(text)
            self._remembered(vehicle).restore([data[at : at + _BYTES] for at in range(0, len(data), _BYTES)])

    def _remembered(self, vehicle: str) -> _Last:
        if len(self._of) >= _MOST_VEHICLES:
            del self._of[next(iter(self._of))]
        return self._of.setdefault(vehicle, _Last())


def _first_number(payload: bytes) -> int:
    found = _NUMBER.search(payload)
    return 0 if found is None else int(found[1])
