"""The report of a controller after a cycle: modes, transitions, outputs, interval and rejected records."""

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
        """The length of the interval in mm."""
        return self.high_mm - self.low_mm

    def holds(self, place_mm: int) -> bool:
        """Return whether the interval contains the place."""
        return self.low_mm <= place_mm <= self.high_mm

    def words(self) -> str:
        """Return the interval in metres: `249.500 m to 250.612 m`."""
        return f"{_metres(self.low_mm)} to {_metres(self.high_mm)}"


def _metres(length_mm: int) -> str:
    """Return a length in metres with three decimals: -500 gives `-0.500 m`."""
    metres, rest = divmod(abs(length_mm), MM_PER_M)
    return f"{'-' if length_mm < 0 else ''}{metres}.{rest:03} m"


@dataclass(frozen=True)
class Track:
    """The track that is told: an edge by its number on the map, or that it is not known, and the edges that are possible.

    edge      the edge along which the reported interval lies; None while it is not known
    possible  every edge on which the vehicle may be, with the interval along it; empty while nothing is known
    """

    edge: int | None
    possible: tuple[tuple[int, Interval], ...]

    def words(self, interval: Interval | None) -> str:
        """Return edge and place, or that the edge is not known, and where the vehicle may be."""
        if self.edge is not None and interval is not None:
            return f"on edge {self.edge}, {interval.words()}"
        named = " or ".join(f"on edge {edge}, {place.words()}" for edge, place in self.possible)
        return f"edge not known: {named or 'nothing reported'}"

    def as_data(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        possible = [{"edge": edge, "interval_mm": [one.low_mm, one.high_mm]} for edge, one in self.possible]
        return {"edge": self.edge, "possible": possible}


@dataclass(frozen=True)
class Move:
    """A transition that fired: machine, name, mode before and after, and the requirements that it implements."""

    machine: str
    name: str
    source: str
    target: str
    requirements: tuple[str, ...] = ()

    @property
    def changes_mode(self) -> bool:
        """Return whether the transition entered another mode."""
        return self.source != self.target


@dataclass(frozen=True)
class Report:
    """The result of a cycle. Times are on the clock of the records, in ms.

    modes       machine -> label of its mode
    moves       transitions that fired, in the order of the machines; at most one per machine
    values      outputs: whole numbers (enumerations by number) and truth values; None for an absent output, such as the
                position and its margins while none is reported
    outputs     the same, enumerations by label
    interval    the reported interval; None while nothing is reported, and for machines without an interval
    rejections  records that were not used, each with its channel and reason
    anew        the reason for a restart of the machine in this cycle; "" without a restart
    standing    the comparison of the interval with a truth record of the cycle; None without such a record
    breaches    broken laws of the worlds that the inputs of the cycle reveal; empty if the laws are not checked
    track       the track along which the interval lies; None for a machine whose interval lies along the line
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
    track: Track | None = None

    @cached_property
    def outputs(self) -> Mapping[str, Value | str | None]:
        """Outputs by name, enumerations by their labels; None is an output that is absent."""
        outputs: dict[str, Value | str | None] = dict(self.values)
        for name, members in self.labels.items():
            number = outputs[name]
            if number is not None:
                outputs[name] = members[int(number)]
        return outputs

    @property
    def mode(self) -> str:
        """The mode; the modes of several machines are separated by commas."""
        return ", ".join(self.modes.values())

    def words(self) -> str:
        """Return one sentence for a log."""
        where = "nothing reported" if self.interval is None else self.interval.words()
        where = where if self.track is None else self.track.words(self.interval)
        parts = [f"cycle {self.cycle} at {self.time_ms} ms: {self.mode}", where]
        parts += [f"restarted ({self.anew})"] if self.anew else []
        parts += [f"{fault.channel} not used: {_reason_of(fault)}" for fault in self.rejections]
        parts += [breach.words() for breach in self.breaches]
        return "; ".join(parts)

    def as_data(self) -> dict[str, Any]:
        """Return plain data for JSON (schema safeloc-controller-report/1); fields that do not apply are left out."""
        data: dict[str, Any] = {"cycle": self.cycle, "time_ms": self.time_ms, "mode": dict(self.modes)}
        data["fired"] = {move.machine: move.name for move in self.moves}
        interval = self.interval
        data["interval_mm"] = None if interval is None else [interval.low_mm, interval.high_mm]
        if self.track is not None:
            data["track"] = self.track.as_data()
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


def _reason_of(fault: Fault) -> str:
    """Return the reason with its detail, in words."""
    return f"{fault.reason.value} ({fault.detail})" if fault.detail else fault.reason.value


def _fault_data(fault: Fault) -> dict[str, Any]:
    data: dict[str, Any] = {"channel": fault.channel, "reason": fault.reason.name, "detail": fault.detail}
    return data if fault.number is None else {**data, "number": fault.number}
