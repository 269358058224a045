"""Faults in a simulation: each has a kind, a place and a time. Every simulation declares the kinds that it has.

    KINDS = Kinds("a distance sensor", {"stuck": {}, "jump": {"by_mm": 50_000}})     # kind -> figures with defaults
    KINDS.require(faults, places=["front_wheel"], length=600)                        # InputError for an unknown fault
    KINDS.figure(fault, "by_mm")

A fault of unknown kind, or one outside the run, is refused, since it would test nothing.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from safeloc.errors import InputError

Figure = int | float | bool | str | None
Place = str | int


@dataclass(frozen=True)
class Fault:
    """A named fault from `begin` up to, not including, `end`.

    kind        kind of fault, in the words of the simulation
    where       faulty sensor, channel, balise group or the like, or several; "": all of them
    begin, end  in the simulation's unit: cycles, frames or blocks, or ms of a recording; None: to the end
    figures     amount, frequency and the like; for others the simulation's defaults apply
    """

    kind: str
    where: Place | frozenset[str] = ""
    begin: int = 0
    end: int | None = None
    figures: Mapping[str, Figure] = field(default_factory=dict, hash=False)

    def active(self, at: int) -> bool:
        """Return whether the fault acts at this time."""
        return self.begin <= at and (self.end is None or at < self.end)

    def strikes(self, place: Place) -> bool:
        """Return whether this place has the fault."""
        return self.where in ("", place) or (isinstance(self.where, frozenset) and place in self.where)

    @property
    def span(self) -> slice:
        """The time in which it is active, as a slice of an array over the run."""
        return slice(self.begin, self.end)

    def __str__(self) -> str:
        where = "" if self.where == "" else f" of {_listed(self.where)}"
        more = "".join(f", {name} {value}" for name, value in self.figures.items())
        return f"{self.kind}{where}, {self.begin} to {'the end' if self.end is None else self.end}{more}"


def _listed(where: Place | frozenset[str]) -> str:
    return ", ".join(sorted(where)) if isinstance(where, frozenset) else str(where)


@dataclass(frozen=True)
class Kinds:
    """The kinds of fault that a simulation (`of`) has: kind -> further figures, each with its default."""

    of: str
    figures: Mapping[str, Mapping[str, Figure]]

    def __contains__(self, kind: str) -> bool:
        return kind in self.figures

    def figure(self, fault: Fault, name: str) -> Any:
        """Return a figure of the fault, by default that of its kind."""
        return fault.figures.get(name, self.figures[fault.kind][name])

    def require(
        self,
        faults: Iterable[Fault],
        *,
        places: Collection[Place] | None = None,
        length: int | None = None,
        timed: bool = True,
    ) -> None:
        """Refuse faults that would test nothing: an unknown kind, place or figure, or outside the run. Raises InputError.

        places  existing places, "" for the only one; None: places are not checked
        length  length of the run in the unit of begin and end; None: unknown
        timed   faults may have a time; False: they are permanent, without begin and end
        """
        for fault in faults:
            self._require_kind(fault)
            if places is not None and fault.where not in places:
                raise InputError(f"{fault}: no such place; of {self.of} {_known(places)}.")
            if not timed and (fault.begin, fault.end) != (0, None):
                raise InputError(f"{fault}: such a fault of {self.of} is permanent; give neither begin nor end.")
            _require_time(fault, length)

    def _require_kind(self, fault: Fault) -> None:
        if fault.kind not in self.figures:
            raise InputError(f"{fault}: {self.of} has no such fault; it has {', '.join(self.figures)}.")
        known = self.figures[fault.kind]
        strange = [name for name in fault.figures if name not in known]
        if strange:
            raise InputError(f"{fault}: no figure {strange[0]!r}; {fault.kind} has {', '.join(known) or 'none'}.")


def _known(places: Collection[Place]) -> str:
    named = [str(place) for place in places if place != ""]
    if named:
        return f"there are {', '.join(named)}"
    return "there is one only, which has no name" if places else "there is none"


def plain(*kinds: str) -> dict[str, Mapping[str, Figure]]:
    """Return kinds without figures."""
    return {kind: {} for kind in kinds}


def _require_time(fault: Fault, length: int | None) -> None:
    if fault.begin < 0 or (fault.end is not None and fault.end <= fault.begin):
        raise InputError(f"{fault}: needs 0 <= begin < end.")
    if length is not None and fault.begin >= length:
        raise InputError(f"{fault}: begins after the run, which is {length} long.")
