"""What goes wrong in a simulation: a fault of a kind, somewhere, for a time. Each simulation says which kinds it has.

    KINDS = Kinds("a distance sensor", {"stuck": {}, "jump": {"by_mm": 50_000}})     # kind -> its figures, as by default
    KINDS.require(faults, places=["front_wheel"], length=600)                        # InputError, or all is understood
    KINDS.figure(fault, "by_mm")

A fault that a simulation does not understand, or that lies outside the run, would test nothing: it is refused.
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

    kind        what it is, in the words of the simulation that it is given to
    where       the sensor, channel, balise group or the like that has it, or several; "": all there are
    begin, end  in what the simulation counts: its cycles, frames or blocks, or ms of a recording; None: to the end
    figures     how far, how often and the like; what is left out is as the simulation has it by default
    """

    kind: str
    where: Place | frozenset[str] = ""
    begin: int = 0
    end: int | None = None
    figures: Mapping[str, Figure] = field(default_factory=dict, hash=False)

    def active(self, at: int) -> bool:
        """Whether it acts then."""
        return self.begin <= at and (self.end is None or at < self.end)

    def strikes(self, place: Place) -> bool:
        """Whether that place has it."""
        return self.where in ("", place) or (isinstance(self.where, frozenset) and place in self.where)

    @property
    def span(self) -> slice:
        """What it is active in, of an array of all that is counted."""
        return slice(self.begin, self.end)

    def __str__(self) -> str:
        where = "" if self.where == "" else f" of {_listed(self.where)}"
        more = "".join(f", {name} {value}" for name, value in self.figures.items())
        return f"{self.kind}{where}, {self.begin} to {'the end' if self.end is None else self.end}{more}"


def _listed(where: Place | frozenset[str]) -> str:
    return ", ".join(sorted(where)) if isinstance(where, frozenset) else str(where)


@dataclass(frozen=True)
class Kinds:
    """The kinds of fault that a simulation understands: kind -> its further figures, each with its default."""

    of: str
    figures: Mapping[str, Mapping[str, Figure]]

    def __contains__(self, kind: str) -> bool:
        return kind in self.figures

    def figure(self, fault: Fault, name: str) -> Any:
        """A figure of the fault: its own, or the default."""
        return fault.figures.get(name, self.figures[fault.kind][name])

    def require(
        self,
        faults: Iterable[Fault],
        *,
        places: Collection[Place] | None = None,
        length: int | None = None,
        timed: bool = True,
    ) -> None:
        """InputError for a fault that would test nothing: of an unknown kind, place or figure, or outside the run.

        places  those that there are, "" where there is one only; None: whatever the fault says
        length  how much there is of what begin and end count; None: not known
        timed   it is for a time; else it is there for good, and says neither begin nor end
        """
        for fault in faults:
            self._require_kind(fault)
            if places is not None and fault.where not in places:
                raise InputError(f"{fault}: no such place; of {self.of} {_known(places)}.")
            if not timed and (fault.begin, fault.end) != (0, None):
                raise InputError(f"{fault}: such a fault of {self.of} is there for good; give neither begin nor end.")
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
    """Kinds that have no figures."""
    return {kind: {} for kind in kinds}


def _require_time(fault: Fault, length: int | None) -> None:
    if fault.begin < 0 or (fault.end is not None and fault.end <= fault.begin):
        raise InputError(f"{fault}: needs 0 <= begin < end.")
    if length is not None and fault.begin >= length:
        raise InputError(f"{fault}: begins after the run, which is {length} long.")
