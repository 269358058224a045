"""Ghosts of the reflector machine: the place of end A, what truly sent each echo and from where, the radar's error, the map's entries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, Num, NumVar, choice, enumeration, number
from safeloc.language.machine import ANY
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL


class Figures(Protocol):
    """Figures of the configuration that bound the ghosts."""

    @property
    def echo_slots(self) -> int:
        """Echoes in a frame."""
        ...

    @property
    def position_limit_mm(self) -> int:
        """The farthest place on the map."""
        ...

    @property
    def reach_nm(self) -> int:
        """The farthest place that end A may have, nm."""
        ...

    @property
    def range_limit_mm(self) -> int:
        """The greatest range that is measured."""
        ...

    @property
    def map_accuracy_mm(self) -> int:
        """The greatest distance of a reflector from its place on the map."""
        ...

    @property
    def radar_scale_ppm(self) -> int:
        """The greatest error in proportion to a range."""
        ...


@dataclass(frozen=True, eq=False)
class Moving:
    """The vehicle's movement, which several machines of a composition share.

    truth, true_cycle_distance     place of end A, and its travel in the cycle, nm
    wander, next_wander  the one-off part of the odometer's error, before the cycle and, freely chosen, after it, nm
    """

    truth: NumVar
    true_cycle_distance: NumVar
    wander: NumVar
    next_wander: NumVar


@dataclass(frozen=True, eq=False)
class Entry:
    """One reflector as the map gives it: its place, its model, and the distance to the next one of that model."""

    position: Num
    model: Num
    clear: Num

    @property
    def figures(self) -> tuple[Num, Num, Num]:
        """All three in order."""
        return (self.position, self.model, self.clear)


@dataclass(frozen=True, eq=False)
class Ghosts(Moving):
    """The vehicle's movement, what truly sent each echo, the radar's error, and the map's entries.

    kind       per slot: what truly sent the echo: a reflector of this model, be it the target or any other one of the line, or
               NONE: a thing that is no reflector
    origin     per slot: place along the track that reflected it, nm
    on_map     per slot: where the map has that reflector, mm; of a thing that is no reflector it says nothing
    bias       by how much the radar measures every range too long, nm: its systematic error, of any size
    scaled     per slot: error in proportion to the range, nm, positive where the range is measured too long
    announced  the map's last entry
    sought     the map's entry of the reflector that the machine names as its target, if that is another one
    """

    kind: tuple[NumVar, ...]
    origin: tuple[NumVar, ...]
    on_map: tuple[NumVar, ...]
    bias: NumVar
    next_bias: NumVar
    scaled: tuple[NumVar, ...]
    announced: Entry
    sought: Entry

    @property
    def reflector(self) -> tuple[Bool, ...]:
        """The echo comes from a reflector, for each slot."""
        return tuple(kind.ne(NO_MODEL) for kind in self.kind)


def ghosts(declared: Declared, moving: Moving, figures: Figures) -> Ghosts:
    """Return the ghosts: fresh ones beside those of the movement."""
    reach, slots = figures.reach_nm, range(1, figures.echo_slots + 1)
    scaled, far_mm = figures.range_limit_mm * figures.radar_scale_ppm, 2 * reach // NM_PER_MM + figures.map_accuracy_mm
    return Ghosts(
        truth=declared.ghost(moving.truth, first=ANY),
        wander=declared.ghost(moving.wander, first=ANY),
        bias=declared.ghost(number("radar_bias_nm", NM, -reach, reach), first=ANY),
        announced=_entry(declared, "announced", figures.position_limit_mm),
        sought=_entry(declared, "sought", figures.position_limit_mm),
        true_cycle_distance=declared.choice(moving.true_cycle_distance),
        next_wander=declared.choice(moving.next_wander),
        kind=tuple(declared.choice(choice(f"echo_{n}_true_model", enumeration(MODEL))) for n in slots),
        origin=tuple(declared.choice(number(f"echo_{n}_origin_nm", NM, -2 * reach, 2 * reach)) for n in slots),
        on_map=tuple(declared.choice(number(f"echo_{n}_map_place_mm", MM, -far_mm, far_mm)) for n in slots),
        next_bias=declared.choice(number("next_radar_bias_nm", NM, -reach, reach)),
        scaled=tuple(declared.choice(number(f"echo_{n}_scaled_nm", NM, -scaled, scaled)) for n in slots),
    )


def _entry(declared: Declared, name: str, limit_mm: int) -> Entry:
    return Entry(
        declared.ghost(number(f"{name}_reflector_mm", MM, -limit_mm, limit_mm), first=0),
        declared.ghost(choice(f"{name}_reflector_model", enumeration(MODEL)), first=NO_MODEL),
        declared.ghost(number(f"{name}_reflector_clear_mm", MM, 0, limit_mm), first=0),
    )
