"""The report of a controller after a cycle: mode, transitions, outputs, the interval, and rejected records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from safeloc.language.nodes import Value
from safeloc.language.units import MM_PER_M
from safeloc.reported import Standing
from safeloc.runtime.border import Fault
from safeloc.runtime.breaches import Breach


@dataclass(frozen=True)
class Interval:
    """The reported interval along the line, both ends included, in mm."""

    low_mm: int
    high_mm: int

    @property
    def length_mm(self) -> int:
        """From end to end."""
        return self.high_mm - self.low_mm

    def holds(self, place_mm: int) -> bool:
        """Return whether the interval contains the place."""
        return self.low_mm <= place_mm <= self.high_mm

    def words(self) -> str:
        """In metres: `249.500 m to 250.612 m`."""
        return f"{metres(self.low_mm)} to {metres(self.high_mm)}"


def metres(length_mm: int) -> str:
    """Write a length exactly, with three decimals: -500 is `-0.500 m`."""
    whole, rest = divmod(abs(length_mm), MM_PER_M)
    return f"{'-' if length_mm < 0 else ''}{whole}.{rest:03} m"


@dataclass(frozen=True)
class Move:
    """A transition that fired: of which machine, from which mode to which, and the requirements it answers for."""

    machine: str
    name: str
    source: str
    target: str
    requirements: tuple[str, ...] = ()

    @property
    def changes_mode(self) -> bool:
        """True if the transition entered another mode."""
        return self.source != self.target


@dataclass(frozen=True)
class Report:
    """The result of a cycle. Times are on the clock of the records, in ms.

    modes       machine -> label of its mode
    moves       transitions that fired, in the order of the machines; none where a machine stayed as it was
    values      outputs as the machine has them: whole numbers (enumerations by number) and truth values; None for one that
                is absent, such as the position and its margins while none is reported
    outputs     the same with the labels of enumerations
    interval    the reported interval; None while nothing is reported, and for machines without an interval
    rejections  records that were not used, each with its channel and reason
    anew        the reason for a restart of the machine in this cycle; "" without one
    standing    the comparison of the interval with a truth record of the cycle; None without one
    breaches    laws of the worlds that the inputs of the cycle show to be broken, where they are judged
    """

    machine: str
    cycle: int
    time_ms: int
    modes: Mapping[str, str]
    moves: tuple[Move, ...]
    values: Mapping[str, Value | None]
    labels: Mapping[str, tuple[str, ...]]
    interval: Interval | None
    rejections: tuple[Fault, ...] = ()
    anew: str = ""
    standing: Standing | None = None
    breaches: tuple[Breach, ...] = ()

    @cached_property
    def outputs(self) -> Mapping[str, Value | str | None]:
        """Outputs by name, enumerations by their labels; None is an output that is absent."""
        labels = self.labels
        return {
            name: labels[name][value] if name in labels and value is not None else value
            for name, value in self.values.items()
        }

    @property
    def mode(self) -> str:
        """The mode, of several machines with commas between."""
        return ", ".join(self.modes.values())

    def words(self) -> str:
        """Return one sober sentence for a log."""
        where = "nothing reported" if self.interval is None else self.interval.words()
        told = [f"cycle {self.cycle} at {self.time_ms} ms: {self.mode}", where]
        told += [f"began anew ({self.anew})"] if self.anew else []
        told += [f"{fault.channel} not used: {reason_of(fault)}" for fault in self.rejections]
        told += [breach.words() for breach in self.breaches]
        return "; ".join(told)

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON (schema safeloc-controller-report/1); what does not apply is left out."""
        data: dict[str, Any] = {"cycle": self.cycle, "time_ms": self.time_ms, "mode": dict(self.modes)}
        data["fired"] = {move.machine: move.name for move in self.moves}
        interval = self.interval
        data["interval_mm"] = None if interval is None else [interval.low_mm, interval.high_mm]
        data["outputs"] = dict(self.outputs)
        if self.rejections:
            data["rejections"] = [_fault_data(fault) for fault in self.rejections]
        if self.anew:
            data["anew"] = self.anew
        if self.standing is not None:
            data["truth"] = self.standing
        if self.breaches:
            data["assumptions_broken"] = [breach.as_data() for breach in self.breaches]
        return data


def reason_of(fault: Fault) -> str:
    """Return the reason with its detail, in words."""
    return f"{fault.reason.value} ({fault.detail})" if fault.detail else fault.reason.value


def _fault_data(fault: Fault) -> dict[str, Any]:
    data: dict[str, Any] = {"channel": fault.channel, "reason": fault.reason.name, "detail": fault.detail}
    return data if fault.number is None else {**data, "number": fault.number}
