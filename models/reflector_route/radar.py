"""The radar's frame as the route machine hears it: of its echoes, the one that is a sighting.

A sighting is the first echo with the minimum intensity that shows a reflector's model, of whatever reflector it is: the reflector machine, which hears the
same frame, measures the map's next one only, and stands behind the route, whose contradiction it hears. Whether it stands by the own track is told by its
place beside the vehicle's axis, near the vehicle: there the reflectors of the own line stand, and none of another track.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    boolean,
    choice,
    enumeration,
    ite,
    number,
)
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.rows import Updates
from safeloc.language.units import MM
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.variables import Parts
from safeloc.models.reflector_route.configuration import ReflectorRouteConfig
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.reflectors import MAX_ERROR_MM, MODEL, NO_MODEL

NAME = "radar"
REQUIREMENTS = ("RFL-D6", "RFL-10")


@dataclass(frozen=True, eq=False)
class Radar:
    """The machine, with the inputs that it shares with the reflector machine, and the sighting of the cycle.

    sighted  there is one
    range    distance from the front end to the sighted reflector, mm
    error    the greatest error of that distance, mm: the echo's own, and what the configuration adds
    model    the model that it shows
    by_own_track  it is near, and stands where reflectors of the own track stand
    """

    machine: Machine
    slots: tuple[Slot, ...]
    shared: tuple[Var, ...]
    sighted: BoolVar
    range: NumVar
    error: NumVar
    model: NumVar
    by_own_track: BoolVar


def radar(config: ReflectorRouteConfig, heard: Parts) -> Radar:
    """Build the machine over the frame's inputs of the reflector machine."""
    declared, table = Declared(), modes("LOOKING")
    declared.sensor(heard.frame_present)
    for slot in heard.slots:
        for one in (slot.range, slot.error, slot.model, slot.intensity, slot.lateral):
            declared.sensor(one)
    sighted = declared.state(boolean("sighted"), first=False)
    away = declared.state(number("sighting_range_mm", MM, 0, config.reflector.range_limit_mm), first=0)
    error = declared.state(number("sighting_error_mm", MM, 0, MAX_ERROR_MM), first=0)
    model = declared.state(choice("sighting_model", enumeration(MODEL)), first=NO_MODEL)
    by_own_track = declared.state(boolean("sighting_by_own_track"), first=False)
    frame = _Frame(config, heard)
    outputs: dict[str, Expr] = {
        "sighted": sighted, "range_mm": away, "error_mm": error, "model": model, "by_own_track": by_own_track,
    }  # fmt: skip
    seen: Updates = {
        sighted: frame.sighted, away: frame.range, error: frame.error, model: frame.model, by_own_track: frame.by_own_track,
    }  # fmt: skip
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs=outputs,
        transitions=[
            Transition("reflector sighted", table[0], table[0], frame.sighted, seen, REQUIREMENTS, 0),
            Transition("nothing sighted", table[0], table[0], TRUE, seen, REQUIREMENTS, 1),
        ],
        doc="The sighting of the cycle, of the radar's frame. Nothing is assumed here.",
    )
    shared = (heard.frame_present, *(var for slot in heard.slots for var in _inputs(slot)))
    return Radar(made, heard.slots, shared, sighted, away, error, model, by_own_track)


@dataclass(frozen=True, eq=False)
class _Frame:
    """The sighting in a frame; without one every figure is 0, and the model is none."""

    config: ReflectorRouteConfig
    heard: Parts

    @property
    def sighted(self) -> Bool:
        return any_of(self._is_sighting(slot) for slot in self.heard.slots)

    @property
    def range(self) -> Num:
        return self._of_sighting([self._ahead(slot) for slot in self.heard.slots], as_num(0, MM))

    @property
    def error(self) -> Num:
        return self._of_sighting([self._error(slot) for slot in self.heard.slots], as_num(0, MM))

    @property
    def model(self) -> Num:
        return self._of_sighting([slot.model for slot in self.heard.slots], NO_MODEL)

    @property
    def by_own_track(self) -> Bool:
        found: Bool = FALSE
        for slot in reversed(self.heard.slots):
            found = ite(self._is_sighting(slot), self._is_by_own_track(slot), found)
        return found

    def _of_sighting(self, values: list[Num], default: Num) -> Num:
        shown = [self._is_sighting(slot) for slot in self.heard.slots]
        return first_of(*zip(shown, values, strict=True), default=default)

    def _is_sighting(self, slot: Slot) -> Bool:
        """Return whether the echo shows a model with the minimum intensity, from farther than the near range and the front end, with an error that can be told."""
        return all_of([
            self.heard.frame_present,
            slot.range.present,
            slot.intensity >= self.config.reflector.minimum_intensity_cdb,
            slot.model.ne(NO_MODEL),
            slot.range.value >= max(self.config.reflector.near_range_mm, self.config.reflector.radar_offset_mm),
            self._error(slot) <= MAX_ERROR_MM,
        ])  # fmt: skip

    def _is_by_own_track(self, slot: Slot) -> Bool:
        """Return whether the echo comes from where reflectors of the own track stand, and from near enough to tell."""
        right, left = self.config.own_track_right_mm, self.config.own_track_left_mm
        return between(right, slot.lateral, left) & (slot.range.value <= self.config.own_track_range_mm)

    def _ahead(self, slot: Slot) -> Num:
        return slot.range.value - self.config.reflector.radar_offset_mm

    def _error(self, slot: Slot) -> Num:
        return slot.error + self.config.sighting_error_mm


def _inputs(slot: Slot) -> tuple[Var, ...]:
    return (slot.range.value, slot.range.present, slot.error, slot.model, slot.intensity, slot.lateral)
