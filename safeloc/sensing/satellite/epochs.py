"""Measurements of a receiver in one epoch, and the required order of epochs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.runtime.border import Fault, Reason


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
        """Return the pseudorange in m. InputError where the receiver gave none."""
        return _given(self.pseudorange_m, "pseudorange")

    def rate(self) -> float:
        """Return the range rate in m/s. InputError where the receiver gave none."""
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


@dataclass(frozen=True, slots=True)
class Row:
    """One satellite as a receiver delivers it: anything may stand in it, also what is no number."""

    satellite: str
    pseudorange_m: object
    rate_m_per_s: object


def received(time_s: object, rows: Iterable[Row]) -> tuple[Epoch | None, tuple[Fault, ...]]:
    """Return an epoch at the border: what is faulty in it is left out and named. None without a time that is a number.

    A satellite that is told twice has no values; a value that is not finite or no number is not measured.
    """
    number = _number(time_s)
    if number is None:
        return None, (Fault("epoch", Reason.NOT_FINITE, f"time {time_s!r}"),)
    faults: list[Fault] = []
    found: dict[str, Measured] = {}
    for row in rows:
        name = row.satellite
        if name in found:
            faults.append(Fault(name, Reason.DUPLICATE, "told twice in one epoch"))
            found[name] = Measured(None, None)
        else:
            values = [_admitted(name, value, faults) for value in (row.pseudorange_m, row.rate_m_per_s)]
            found[name] = Measured(*values)
    return Epoch(number, found), tuple(faults)


def _number(value: object) -> float | None:
    """None for what is no finite number."""
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    return None


def _admitted(name: str, value: object, faults: list[Fault]) -> float | None:
    number = _number(value)
    if number is None and value is not None:
        reason = Reason.NOT_FINITE if isinstance(value, float) else Reason.WRONG_TYPE
        faults.append(Fault(name, reason, repr(value)))
    return number


def in_order(epochs: Iterable[Epoch]) -> Iterator[Epoch]:
    """Return the same epochs. InputError at the first one that is not later than the one before."""
    last = -math.inf
    for epoch in epochs:
        if not epoch.time_s > last:
            raise InputError(f"epoch {epoch.time_s} s does not come after {last} s; sort the recording, drop repeats.")
        last = epoch.time_s
        yield epoch
