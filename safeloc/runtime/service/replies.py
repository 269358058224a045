"""A limit on refusals to a peer: at most a small multiple of the bytes that it sent.

Reports are not limited: there is one for each cycle, regardless of its number of lines.
"""

from __future__ import annotations

from typing import Any

from safeloc.runtime.service.messages import LONGEST_REASON

FACTOR = 4
"""Bytes of refusals for each byte that the peer sends."""

FIRST_BYTES = 4_096
"""Bytes of refusals at the start: a peer with few faulty lines gets all refusals."""

_MOST_BYTES = 65_536
"""Most bytes of refusals that a peer can save up."""

_MOST_PEERS = 10_000
"""Most peers with an allowance; with more, the oldest are forgotten."""

_LONG_LINE = LONGEST_REASON
"""Bytes that count for a line that was too long to be stored."""


class Allowance:
    """The bytes of refusals that may still be sent to each peer."""

    def __init__(self) -> None:
        self._bytes: dict[str, int] = {}
        self._left_out: dict[str, int] = {}

    def line_came(self, origin: str, size: int) -> None:
        """Count the bytes that a peer sent."""
        had = self._bytes.get(origin, FIRST_BYTES)
        if had == _MOST_BYTES:
            return
        self._bytes[origin] = min(_MOST_BYTES, had + FACTOR * (size or _LONG_LINE))
        if len(self._bytes) > _MOST_PEERS:
            self.left(next(iter(self._bytes)))

    def left(self, origin: str) -> None:
        """Forget a peer that has disconnected."""
        self._bytes.pop(origin, None)
        self._left_out.pop(origin, None)

    def refusal(self, origin: str, refused: dict[str, Any], size: int) -> dict[str, Any] | None:
        """Return the refusal with the number of omitted ones before it; None if the peer has used its allowance."""
        left = self._bytes.get(origin, FIRST_BYTES)
        if size > left:
            self._left_out[origin] = self._left_out.get(origin, 0) + 1
            return None
        self._bytes[origin] = left - size
        left_out = self._left_out.pop(origin, 0)
        return {**refused, "left_out": left_out} if left_out else refused
