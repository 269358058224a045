"""What a receiver measured in one epoch, and the order epochs must come in."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from safeloc.errors import InputError


@dataclass(frozen=True, slots=True)
class Measured:
    """Pseudorange (m) and range rate (m/s, positive when the distance grows); None where the receiver gave none."""

    pseudorange_m: float | None
    rate_m_per_s: float | None

    def __post_init__(self) -> None:
        for value in (self.pseudorange_m, self.rate_m_per_s):
            if value is not None and not math.isfinite(value):
                raise InputError(f"a measured value is {value}; give None where nothing was measured.")

    def whole(self) -> bool:
        """Both values are there."""
        return self.pseudorange_m is not None and self.rate_m_per_s is not None

    def code(self) -> float:
        """The pseudorange in m. InputError where the receiver gave none."""
        return _given(self.pseudorange_m, "pseudorange")

    def rate(self) -> float:
        """The range rate in m/s. InputError where the receiver gave none."""
        return _given(self.rate_m_per_s, "range rate")


def _given(value: float | None, what: str) -> float:
    if value is None:
        raise InputError(f"the receiver gave no {what}; leave the satellite out of this epoch.")
    return value


@dataclass(frozen=True, slots=True)
class Epoch:
    """Receiver time (GPS seconds, with the receiver's clock error) and what was measured per satellite."""

    time_s: float
    satellites: dict[str, Measured]


def in_order(epochs: Iterable[Epoch]) -> Iterator[Epoch]:
    """The same epochs. InputError at the first one that is not later than the one before."""
    last = -math.inf
    for epoch in epochs:
        if not epoch.time_s > last:
            raise InputError(f"epoch {epoch.time_s} s does not come after {last} s; sort the recording, drop repeats.")
        last = epoch.time_s
        yield epoch
