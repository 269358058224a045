"""Measurements of a receiver in one epoch, and the required order of epochs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Set
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.runtime.border import Fault, Reason


@dataclass(frozen=True, slots=True)
class Measured:
    """Pseudorange (m) and range rate (m/s, positive if the distance grows); None if not measured."""

    pseudorange_m: float | None
    rate_m_per_s: float | None

    def __post_init__(self) -> None:
        for value in (self.pseudorange_m, self.rate_m_per_s):
            if value is not None and not math.isfinite(value):
                raise InputError(f"a measured value is {value}; give None if nothing was measured.")

    def complete(self) -> bool:
        """Return whether both values were measured."""
        return self.pseudorange_m is not None and self.rate_m_per_s is not None

    def code(self) -> float:
        """Return the pseudorange in m. InputError if it was not measured."""
        return _given(self.pseudorange_m, "pseudorange")

    def rate(self) -> float:
        """Return the range rate in m/s. InputError if it was not measured."""
        return _given(self.rate_m_per_s, "range rate")


def _given(value: float | None, what: str) -> float:
    if value is None:
        raise InputError(f"the receiver gave no {what}; leave the satellite out of this epoch.")
    return value


@dataclass(frozen=True, slots=True)
class Epoch:
    """The receiver's time (GPS seconds, with its clock error) and its measurements by satellite."""

    time_s: float
    satellites: dict[str, Measured]

    def only(self, names: Set[str]) -> Epoch:
        """Return the epoch with the measurements of these satellites alone."""
        return Epoch(self.time_s, {name: one for name, one in self.satellites.items() if name in names})


@dataclass(frozen=True, slots=True)
class Row:
    """One satellite as a receiver delivers it, unchecked: values of any type."""

    satellite: str
    pseudorange_m: object
    rate_m_per_s: object


def received(time_s: object, rows: Iterable[Row]) -> tuple[Epoch | None, tuple[Fault, ...]]:
    """Return the epoch without faulty values, and the faults; no epoch if the time is not a number.

    A satellite that is delivered twice has no values; a value that is not a finite number counts as not measured.
    """
    number = _number(time_s)
    if number is None:
        return None, (Fault("epoch", Reason.NOT_FINITE, f"time {time_s!r}"),)
    faults: list[Fault] = []
    found: dict[str, Measured] = {}
    for row in rows:
        name = row.satellite
        if name in found:
            faults.append(Fault(name, Reason.DUPLICATE, "delivered twice in one epoch"))
            found[name] = Measured(None, None)
        else:
            values = [_admitted(name, value, faults) for value in (row.pseudorange_m, row.rate_m_per_s)]
            found[name] = Measured(*values)
    return Epoch(number, found), tuple(faults)


def _number(value: object) -> float | None:
    """Return the value as a float; None if it is not a finite number."""
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
    """Yield the same epochs. InputError at the first that is not later than the previous one."""
    last = -math.inf
    for epoch in epochs:
        if not epoch.time_s > last:
            raise InputError(f"epoch {epoch.time_s} s does not come after {last} s; sort the recording, drop repeats.")
        last = epoch.time_s
        yield epoch
