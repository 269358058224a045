"""The radar's frame as the route machine hears it: of its echoes, the one that is a sighting.

A sighting is the first echo with the minimum intensity that shows a reflector's model, of whatever reflector it is: the reflector machine, which hears the
same frame, measures the map's next one only. Whether it stands by the own track is told by its place beside the vehicle's axis, near the vehicle: there the
reflectors of the own line stand, and none of another track.
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
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.reflectors import MAX_ERROR_MM, MODEL, NO_MODEL

NAME = "radar"
REQUIREMENTS = ("RFL-D6", "RFL-10")


@dataclass(frozen=True, eq=False)
class Radar:
    """The machine, the echoes that it hears, and the sighting of the cycle.

    sighted  there is one
    range    distance from the front end to the sighted reflector, mm
    error    the greatest error of that distance, mm: the echo's own, and what the configuration adds
    model    the model that it shows
    by_own_track  it is near, and stands where reflectors of the own track stand
    """

    machine: Machine
    echoes: tuple[Slot, ...]
    sighted: BoolVar
    range: NumVar
    error: NumVar
    model: NumVar
    by_own_track: BoolVar


def radar(config: ReflectorDeviceConfig, heard: Parts) -> Radar:
    """Build the machine; frame and echoes are the reflector machine's own inputs."""
    declared, table = Declared(), modes("LOOKING")
    frame = _Frame(config, declared.sensor(heard.frame_present), heard.slots)
    for slot in heard.slots:
        declared.sensor(slot.range)
        for echo in (slot.error, slot.model, slot.intensity, slot.lateral):
            declared.sensor(echo)
    sighted = declared.state(boolean("sighted"), first=False)
    away = declared.state(number("sighting_range_mm", MM, 0, config.reflector.range_limit_mm), first=0)
    error = declared.state(number("sighting_error_mm", MM, 0, MAX_ERROR_MM), first=0)
    model = declared.state(choice("sighting_model", enumeration(MODEL)), first=NO_MODEL)
    by_own_track = declared.state(boolean("sighting_by_own_track"), first=False)
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
    return Radar(made, heard.slots, sighted, away, error, model, by_own_track)


@dataclass(frozen=True, eq=False)
class _Frame:
    """The sighting in a frame; without one every figure is 0, and the model is none."""

    config: ReflectorDeviceConfig
    present: BoolVar
    echoes: tuple[Slot, ...]

    @property
    def sighted(self) -> Bool:
        return any_of(self._is_sighting(one) for one in self.echoes)

    @property
    def range(self) -> Num:
        return self._of_sighting([self._ahead(one) for one in self.echoes], as_num(0, MM))

    @property
    def error(self) -> Num:
        return self._of_sighting([self._error(one) for one in self.echoes], as_num(0, MM))

    @property
    def model(self) -> Num:
        return self._of_sighting([one.model for one in self.echoes], NO_MODEL)

    @property
    def by_own_track(self) -> Bool:
        found: Bool = FALSE
        for one in reversed(self.echoes):
            found = ite(self._is_sighting(one), self._is_by_own_track(one), found)
        return found

    def _of_sighting(self, values: list[Num], default: Num) -> Num:
        shown = [self._is_sighting(one) for one in self.echoes]
        return first_of(*zip(shown, values, strict=True), default=default)

    def _is_sighting(self, one: Slot) -> Bool:
        """Return whether the echo shows a model with the minimum intensity, from farther than the near range and the front end, with an error that can be told."""
        return all_of([
            self.present,
            one.range.present,
            one.intensity >= self.config.reflector.minimum_intensity_cdb,
            one.model.ne(NO_MODEL),
            one.range.value >= max(self.config.reflector.near_range_mm, self.config.reflector.radar_offset_mm),
            self._error(one) <= MAX_ERROR_MM,
        ])  # fmt: skip

    def _is_by_own_track(self, one: Slot) -> Bool:
        """Return whether the echo comes from where reflectors of the own track stand, and from near enough to tell."""
        right, left = self.config.own_track_right_mm, self.config.own_track_left_mm
        return between(right, one.lateral, left) & (one.range.value <= self.config.own_track_range_mm)

    def _ahead(self, one: Slot) -> Num:
        return one.range.value - self.config.reflector.radar_offset_mm

    def _error(self, one: Slot) -> Num:
        return one.error + self.config.sighting_error_mm
