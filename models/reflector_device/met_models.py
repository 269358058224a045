"""Models that the direction of travel hears of the radar's frame: that of the nearest reflector ahead, and of one as it is passed (RFL-D5).

The radar loses a reflector some metres before the front end reaches it, and may lose it for a frame at any time. So a reflector that was near is carried on by the odometer:
it is passed where the balise antenna has run the distance that was measured last. Then it is met in its order with the groups that the antenna reads.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Num,
    NumVar,
    all_of,
    any_of,
    as_num,
    boolean,
    choice,
    enumeration,
    ite,
    maximum,
    minimum,
    number,
)
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.rows import Updates
from safeloc.language.units import MM
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
    run           distance measured in this cycle, mm
    passed_model  model of the reflector that the balise antenna passed in this cycle
    ahead_model   model of the nearest reflector beyond the front end in this cycle's frame
    near_model    model of the reflector that comes next, once it was within `passing_range_mm`
    remaining     what is left to run until the antenna passes it, mm
    """

    machine: Machine
    turned: BoolVar
    run: NumVar
    passed_model: NumVar
    ahead_model: NumVar
    near_model: NumVar
    remaining: NumVar


def met(config: ReflectorDeviceConfig, heard: Parts, distance: NumVar) -> Met:
    """Build the machine; frame and echoes are the reflector machine's own inputs, and the run is in the range of `distance`."""
    declared, table = Declared(), modes("LOOKING")
    frame = Frame(config, declared.sensor(heard.frame_present), heard.slots)
    for slot in heard.slots:
        declared.sensor(slot.range)
        declared.sensor(slot.model)
        declared.sensor(slot.intensity)
    turned = declared.sensor(boolean("turned"))
    run = declared.sensor(number("run_mm", MM, distance.low, distance.high))
    passed, ahead, near = (
        declared.state(choice(f"{name}_model", enumeration(MODEL)), first=NO_MODEL)
        for name in ("passed", "ahead", "near")
    )
    remaining = declared.state(number("remaining_mm", MM, 0, frame.farthest_mm), first=0)
    carried = Carried(frame, near, remaining - run)
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs={"passed_model": passed, "ahead_model": ahead},
        transitions=[
            Transition(name, table[0], table[0], guard, {ahead: frame.model, **updates}, REQUIREMENTS, rank)
            for rank, (name, guard, updates) in enumerate(_table(carried, turned, passed, remaining))
        ],
        doc="The models of reflectors that the vehicle meets, of the radar's frame. Nothing is assumed here.",
    )
    return Met(made, turned, run, passed, ahead, near, remaining)


def _table(carried: Carried, turned: Bool, passed: NumVar, remaining: NumVar) -> Iterator[tuple[str, Bool, Updates]]:
    """Yield the transitions; the first that is possible fires."""
    frame, near = carried.frame, carried.near
    nothing: Updates = {near: NO_MODEL, remaining: as_num(0, MM)}
    shown: Updates = {near: frame.near_model, remaining: frame.away}
    yield "vehicle turned", turned, {passed: NO_MODEL, **nothing}
    yield "reflector passed", carried.passed, {passed: near, **shown}
    yield "reflector measured", carried.measured, {passed: NO_MODEL, **shown}
    yield "reflector carried on", near.ne(NO_MODEL), {passed: NO_MODEL, remaining: carried.left}
    yield "no reflector near", TRUE, {passed: NO_MODEL, **nothing}


@dataclass(frozen=True, eq=False)
class Carried:
    """The reflector that comes next, in this cycle.

    near  its model before the cycle; due  what is then left to run, below 0 beyond it
    """

    frame: Frame
    near: NumVar
    due: Num

    @property
    def left(self) -> Num:
        """The distance that is left to run, within its range."""
        return minimum(maximum(self.due, as_num(0, MM)), as_num(self.frame.farthest_mm, MM))

    @property
    def passed(self) -> Bool:
        """The antenna has run the distance, and the frame does not show the reflector near any more."""
        return all_of([self.near.ne(NO_MODEL), self.due <= 0, ~self.frame.shows_near(self.near)])

    @property
    def measured(self) -> Bool:
        """The nearest reflector is near, and no other one comes first."""
        return self.frame.near & (self.near.eq(NO_MODEL) | self.near.eq(self.frame.near_model))


@dataclass(frozen=True, eq=False)
class Frame:
    """The nearest reflector in a frame, beyond the front end.

    model       the model that it shows; NONE without one
    near        there is one, within `passing_range_mm` of the front end
    near_model  its model, NONE where it is not near
    away        its distance from the balise antenna, mm; 0 where it is not near
    """

    config: ReflectorDeviceConfig
    present: BoolVar
    slots: tuple[Slot, ...]

    @property
    def farthest_mm(self) -> int:
        """The greatest distance from the antenna at which a reflector is near."""
        return self.config.passing_range_mm + self.config.balise.antenna_mm

    @property
    def model(self) -> Num:
        return first_of(*((self._is_nearest(one), one.model) for one in self.slots), default=NO_MODEL)

    @property
    def near(self) -> Bool:
        return any_of(self._is_near(one) for one in self.slots)

    @property
    def near_model(self) -> Num:
        return ite(self.near, self.model, NO_MODEL)

    @property
    def away(self) -> Num:
        behind = self.config.balise.antenna_mm - self.config.reflector.radar_offset_mm
        nearest = [(self._is_nearest(one) & self._is_near(one), one.range.value + behind) for one in self.slots]
        return first_of(*nearest, default=as_num(0, MM))

    def shows_near(self, model: Num) -> Bool:
        """Return whether a reflector of this model is near, be it the nearest or not."""
        return any_of(self._is_near(one) & one.model.eq(model) for one in self.slots)

    def _is_near(self, one: Slot) -> Bool:
        limit_mm = self.config.passing_range_mm + self.config.reflector.radar_offset_mm
        return self._shows_reflector(one) & (one.range.value <= limit_mm)

    def _is_nearest(self, one: Slot) -> Bool:
        others = [other for other in self.slots if other is not one]
        farther = [self._shows_reflector(other).implies(one.range.value <= other.range.value) for other in others]
        return all_of([self._shows_reflector(one), *farther])

    def _shows_reflector(self, one: Slot) -> Bool:
        """Return whether the echo shows a reflector's model with the minimum intensity, from beyond the front end and the near range."""
        figures = self.config.reflector
        strong = one.intensity >= figures.minimum_intensity_cdb
        beyond = one.range.value >= max(figures.near_range_mm, figures.radar_offset_mm)
        return all_of([self.present, one.range.present, strong, one.model.ne(NO_MODEL), beyond])
