"""Models that the direction of travel hears of the radar's frame: that of the nearest reflector ahead, and of one as it is passed (RFL-D5).

A reflector that was within `passing_range_mm` and is seen there no more is passed: the radar sees it no longer a few metres before the front end reaches it. One that is only
hidden there for a frame is told as passed too early, and again as it is seen again; the order in which reflectors are met stays the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Bool, BoolVar, Num, NumVar, all_of, any_of, boolean, choice, enumeration, ite
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.rows import Updates
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.variables import Parts
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL

NAME = "met"
REQUIREMENTS = ("RFL-D5",)


@dataclass(frozen=True, eq=False)
class Met:
    """The machine; all models are NONE without a reflector.

    turned        the vehicle turned, or may have: what was near counts no longer
    passed_model  model of the reflector that was passed in this cycle
    ahead_model   model of the nearest reflector in this cycle's frame
    near_model    model of the reflector that was within `passing_range_mm` in the last frame
    """

    machine: Machine
    turned: BoolVar
    passed_model: NumVar
    ahead_model: NumVar
    near_model: NumVar


def met(config: ReflectorDeviceConfig, heard: Parts) -> Met:
    """Build the machine; frame and echoes are the reflector machine's own inputs."""
    declared, table = Declared(), modes("LOOKING")
    frame = Frame(config, declared.sensor(heard.frame_present), heard.slots)
    for slot in heard.slots:
        declared.sensor(slot.range)
        declared.sensor(slot.model)
        declared.sensor(slot.intensity)
    turned = declared.sensor(boolean("turned"))
    passed, ahead, near = (
        declared.state(choice(f"{name}_model", enumeration(MODEL)), first=NO_MODEL)
        for name in ("passed", "ahead", "near")
    )
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs={"passed_model": passed, "ahead_model": ahead},
        transitions=[
            Transition(name, table[0], table[0], guard, updates, REQUIREMENTS, rank)
            for rank, (name, guard, updates) in enumerate(_table(frame, turned, passed, ahead, near))
        ],
        doc="The models of reflectors that the vehicle meets, of the radar's frame. Nothing is assumed here.",
    )
    return Met(made, turned, passed, ahead, near)


def _table(
    frame: Frame, turned: Bool, passed: NumVar, ahead: NumVar, near: NumVar
) -> Iterator[tuple[str, Bool, Updates]]:
    """Yield the transitions, the first that is possible fires."""
    still_near: Updates = {near: ite(frame.near, frame.model, NO_MODEL), ahead: frame.model}
    gone = near.ne(NO_MODEL) & ~frame.shows_near(near)
    yield "vehicle turned", turned, {passed: NO_MODEL, near: NO_MODEL, ahead: frame.model}
    yield "no frame", ~frame.present, {passed: NO_MODEL, ahead: NO_MODEL}
    yield "reflector passed", gone, {passed: near, **still_near}
    yield "reflector near", frame.near, {passed: NO_MODEL, **still_near}
    yield "no reflector near", TRUE, {passed: NO_MODEL, **still_near}


@dataclass(frozen=True, eq=False)
class Frame:
    """The nearest reflector in a frame.

    model  the model that it shows; NONE without one
    near   there is one, within `passing_range_mm`
    """

    config: ReflectorDeviceConfig
    present: BoolVar
    slots: tuple[Slot, ...]

    @property
    def model(self) -> Num:
        return first_of(*((self._is_nearest(one), one.model) for one in self.slots), default=NO_MODEL)

    @property
    def near(self) -> Bool:
        return any_of(self._is_near(one) for one in self.slots)

    def shows_near(self, model: Num) -> Bool:
        """Return whether a reflector of this model is near, be it the nearest or not."""
        return any_of(self._is_near(one) & one.model.eq(model) for one in self.slots)

    def _is_near(self, one: Slot) -> Bool:
        return self._shows_reflector(one) & (one.range.value <= self.config.passing_range_mm)

    def _is_nearest(self, one: Slot) -> Bool:
        others = [other for other in self.slots if other is not one]
        farther = [self._shows_reflector(other).implies(one.range.value <= other.range.value) for other in others]
        return all_of([self._shows_reflector(one), *farther])

    def _shows_reflector(self, one: Slot) -> Bool:
        """Return whether the echo shows a reflector's model with the minimum intensity."""
        strong = one.intensity >= self.config.reflector.minimum_intensity_cdb
        return all_of([self.present, one.range.present, strong, one.model.ne(NO_MODEL)])
