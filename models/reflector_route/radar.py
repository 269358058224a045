"""The radar's frame as route and reflector machine hear it: of its echoes, the one that is a sighting.

No machine on board: it computes nothing. A sighting is the first echo with the minimum intensity that shows a reflector's model, of whatever reflector
it is: the reflector machine measures the map's next one only, and stands behind the route, whose contradiction it hears.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Bool, BoolVar, Num, Var, all_of, any_of, as_num
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.units import MM
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.variables import Parts
from safeloc.models.reflector_route.configuration import ReflectorRouteConfig
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.reflectors import MAX_ERROR_MM, NO_MODEL

NAME = "radar"


@dataclass(frozen=True, eq=False)
class Radar:
    """The machine, and the inputs that it shares with the reflector machine."""

    machine: Machine
    config: ReflectorRouteConfig
    frame_present: BoolVar
    slots: tuple[Slot, ...]

    @property
    def shared(self) -> list[Var]:
        """The inputs that the reflector machine has as well."""
        return [self.frame_present, *(var for slot in self.slots for var in _inputs(slot))]

    @property
    def sighted(self) -> Bool:
        """There is a sighting."""
        return any_of(self._is_sighting(slot) for slot in self.slots)

    @property
    def range(self) -> Num:
        """Distance from the front end to the sighted reflector, mm."""
        return self._of_sighting([self._ahead(slot) for slot in self.slots], as_num(0, MM))

    @property
    def error(self) -> Num:
        """The greatest error of that distance, mm: the echo's own, and what the configuration adds."""
        return self._of_sighting([self._error(slot) for slot in self.slots], as_num(0, MM))

    @property
    def model(self) -> Num:
        """The model that the sighting shows."""
        return self._of_sighting([slot.model for slot in self.slots], NO_MODEL)

    def _of_sighting(self, values: list[Num], default: Num) -> Num:
        return first_of(*((self._is_sighting(slot), value) for slot, value in zip(self.slots, values, strict=True)), default=default)  # fmt: skip

    def _is_sighting(self, slot: Slot) -> Bool:
        """Return whether the echo shows a model with the minimum intensity, ahead of the front end and with an error that can be told."""
        return all_of([
            self.frame_present,
            slot.range.present,
            slot.intensity >= self.config.reflector.minimum_intensity_cdb,
            slot.model.ne(NO_MODEL),
            self._ahead(slot) >= 0,
            self._error(slot) <= MAX_ERROR_MM,
        ])  # fmt: skip

    def _ahead(self, slot: Slot) -> Num:
        return slot.range.value - self.config.reflector.radar_offset_mm

    def _error(self, slot: Slot) -> Num:
        return slot.error + self.config.sighting_error_mm


def radar(config: ReflectorRouteConfig, heard: Parts) -> Radar:
    """Build the machine over the frame's inputs of the reflector machine."""
    declared, table = Declared(), modes("LOOKING")
    frame_present = declared.sensor(heard.frame_present)
    for slot in heard.slots:
        for one in (slot.range, slot.error, slot.model, slot.intensity, slot.lateral):
            declared.sensor(one)
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs={},
        transitions=[Transition("frame looked at", table[0], table[0], TRUE, {}, ("RFL-D6",), 0)],
        doc="The frame of the radar. Nothing is assumed here.",
    )
    return Radar(made, config, frame_present, heard.slots)


def _inputs(slot: Slot) -> tuple[Var, ...]:
    return (slot.range.value, slot.range.present, slot.error, slot.model, slot.intensity, slot.lateral)
