"""The map's data of a reflector (RFL-3): place, model, view zone, and the distance to the next one of its model.

The figures are inputs: in every cycle those of the next reflector ahead of the target, and behind a group that is read the first one there. So the proofs hold for every
line, with any number of reflectors. `clear_mm` is the distance to the nearest other reflector of the same model on any
track that the radar can see; it is the one figure that the layout of a line has to keep.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    Expr,
    Num,
    NumVar,
    Optional,
    Var,
    as_num,
    choice,
    enumeration,
    exact_to,
    number,
    optional,
)
from safeloc.language.units import MM, NM
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL


@dataclass(frozen=True, eq=False)
class Reflector:
    """A reflector as the map describes it. Lengths in mm.

    place      place of end A when the range to the reflector is 0 (the reflector's position plus the radar's offset)
    view_from  range at which its view zone begins: from here on its echo has the minimum intensity
    view_to    range at which its view zone ends: nearer, no echo can be evaluated
    clear      distance to the nearest other reflector of the same model
    """

    place: Num
    model: Num
    view_from: Num
    view_to: Num
    clear: Num

    def view_begins(self) -> Num:
        """Return the place of end A at which the view zone begins, nm."""
        return exact_to(self.place - self.view_from, NM)

    def search_ends(self, search_run_mm: int) -> Num:
        """Return the place of end A at which the search ends, nm: the reflector has to be measured by then."""
        return exact_to(self.place - self.view_from + search_run_mm, NM)

    def roomy(self, interval: Interval) -> Bool:
        """Return whether the interval has room for one reflector of the model only: the search is not too early."""
        return exact_to(self.clear, NM) > interval.width

    def comes_into_view(self, interval: Interval) -> Bool:
        """Return whether the vehicle may be in the view zone, and no other reflector of the model could be mistaken for this one."""
        return (interval.high >= self.view_begins()) & self.roomy(interval)

    def opens(self, interval: Interval, search_run_mm: int) -> Bool:
        """Return whether the search may begin: the vehicle may be in the view zone, and not surely beyond its first `search_run`."""
        return self.comes_into_view(interval) & (interval.low <= self.search_ends(search_run_mm))

    def over(self, interval: Interval, search_run_mm: int) -> Bool:
        """Return whether the whole interval lies beyond the end of the search."""
        return interval.low > self.search_ends(search_run_mm)


@dataclass(frozen=True, eq=False)
class NextReflector:
    """Inputs: the map's next reflector, absent where the map ends or was not loaded.

    reference  its prescribed distance from its balise; present for the first reflector behind a balise
    """

    position: Optional
    model: NumVar
    view_from: NumVar
    view_to: NumVar
    clear: NumVar
    reference: Optional
    offset_mm: int

    @property
    def known(self) -> Bool:
        """The map has a next reflector that has a model."""
        return self.position.present & self.model.ne(NO_MODEL)

    @property
    def reflector(self) -> Reflector:
        """The reflector; only while `known`."""
        return Reflector(self.position.value + self.offset_mm, self.model, self.view_from, self.view_to, self.clear)


def next_reflector(declared: Declared, limit_mm: int, range_limit_mm: int, offset_mm: int) -> NextReflector:
    """Return fresh inputs `next_...`."""
    return NextReflector(
        declared.sensor(optional("next_position_mm", MM, -limit_mm, limit_mm)),
        declared.sensor(choice("next_model", enumeration(MODEL))),
        declared.sensor(number("next_view_from_mm", MM, 0, range_limit_mm)),
        declared.sensor(number("next_view_to_mm", MM, 0, range_limit_mm)),
        declared.sensor(number("next_clear_mm", MM, 0, limit_mm)),
        declared.sensor(optional("next_reference_mm", MM, 0, range_limit_mm)),
        offset_mm,
    )


@dataclass(frozen=True, eq=False)
class Target:
    """State: the reflector that is searched, tracked or awaited in a self-test; stored when its search begins."""

    position: NumVar
    model: NumVar
    view_from: NumVar
    view_to: NumVar
    clear: NumVar
    offset_mm: int

    @property
    def reflector(self) -> Reflector:
        """The stored reflector."""
        return Reflector(self.position + self.offset_mm, self.model, self.view_from, self.view_to, self.clear)

    @property
    def kept(self) -> tuple[NumVar, NumVar, NumVar, NumVar]:
        """The variables that hold lengths, in order."""
        return (self.position, self.view_from, self.view_to, self.clear)

    def become(self, ahead: NextReflector) -> dict[Var, Expr]:
        """Return updates that make the map's next reflector the target."""
        lengths = (ahead.position.value, ahead.view_from, ahead.view_to, ahead.clear)
        return {**dict(zip(self.kept, lengths, strict=True)), self.model: ahead.model}

    def nothing(self) -> dict[Var, Expr]:
        """Return updates after which there is no target."""
        return {**dict.fromkeys(self.kept, as_num(0, MM)), self.model: NO_MODEL}


def target(declared: Declared, limit_mm: int, range_limit_mm: int, offset_mm: int) -> Target:
    """Return fresh state `target_...`."""
    return Target(
        position=declared.state(number("target_position_mm", MM, -limit_mm, limit_mm), first=0),
        view_from=declared.state(number("target_view_from_mm", MM, 0, range_limit_mm), first=0),
        view_to=declared.state(number("target_view_to_mm", MM, 0, range_limit_mm), first=0),
        clear=declared.state(number("target_clear_mm", MM, 0, limit_mm), first=0),
        model=declared.state(choice("target_model", enumeration(MODEL)), first=NO_MODEL),
        offset_mm=offset_mm,
    )
