"""A train in a line area with all sensors of the area, as one device (FWG-1 to FVA-18).

    counter_low, counter_high     entry records, from the axles that the counting heads at both ends report    models.axle_counter
    counted_axles                 the axles of a cycle, as the section between the counters hears them          fibre_device.counted_axles
    reference                     which record, or whose hand-over, is the train's reference in this cycle      fibre_device.reference
    front_course, rear_course     no machine on board: the true course of each end of the train                 fibre_device.course
    front_flight, rear_flight     time T and distance Ls along the fibre, and the place of that end             models.time_of_flight
    front_additional, rear_...    which place by time of flight is compared with the one by sections            fibre_timed.additional
    axle_section ... section_n    the machines of an area, behind these sensors                                 models.fibre_area

All act in one step. `fibre_area` takes the axles of a cycle, the reference and the place by time of flight as they come; here each is what a
machine of this step tells, and no input of the whole. What `fibre_area` assumes of a sound reference is proved: the counter's record has as
many axles as passed. Of the place by time of flight nothing but the laws of light, cable and pattern is assumed.

Inputs of a cycle, by name, in place of those of `fibre_area` that are wired here:

    counter_low.*, counter_high.*  as models.axle_counter: axle, axles_in_cycle, axle_speed_low_mm_s, axle_speed_high_mm_s, head_fault,
                                   head_damped, passage_over. The heads are those of the axle section.
    reference.enters_low, enters_high  number of the train that comes in there, in the cycle of its first axle; 0: none
    reference.neighbour_sends, neighbour_*  the neighbouring area hands the train over, with this record
    front_flight.*, rear_flight.*  as models.time_of_flight: delay_ps, map_known, map_distance_mm, map_position_mm, map_upwards
    front_additional.amplitude_cdb, rear_additional.amplitude_cdb  amplitude of the pattern at that end
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

from safeloc.language.composition import Clause, Composition
from safeloc.language.expr import Expr, Lit, Var, as_num, before, between, ite
from safeloc.language.machine import Machine, Model
from safeloc.language.units import COUNT, MM, MS, MS_PER_S
from safeloc.models import axle_counter, fibre, fibre_area, time_of_flight
from safeloc.models.axle_counter import AxleCounter
from safeloc.models.fibre import Fibre
from safeloc.models.fibre_area import FibreArea, Machines, Sensors, in_range_of, outermost_before
from safeloc.models.fibre_area.entry_world import SOUND
from safeloc.models.fibre_device import counted_axles as counted_axles_model
from safeloc.models.fibre_device import reference as reference_model
from safeloc.models.fibre_device.configuration import SIDES, FibreDeviceConfig
from safeloc.models.fibre_device.counted_axles import CountedAxles
from safeloc.models.fibre_device.course import Course, course
from safeloc.models.fibre_device.reference import Reference
from safeloc.models.fibre_timed.additional import TRUE_PLACE, Additional, additional
from safeloc.models.fibre_timed.additional import Parts as AdditionalParts
from safeloc.models.time_of_flight import TimeOfFlight
from safeloc.models.vocabulary.absent import wired_interval

__all__ = ["FibreDevice", "FibreDeviceConfig", "compose_machines"]
NAME = "fibre_device"
_Model = TypeVar("_Model", bound=Model[Any])


@dataclass(frozen=True, eq=False)
class TimedEnd:
    """One end of the train: its course, the time of flight to it, the place that is compared, and its machine of sections."""

    course: Course
    flight: TimeOfFlight
    additional: Additional
    sections: Fibre

    @property
    def machines(self) -> tuple[Machine, ...]:
        """The machines before that of the sections, in the order of the step."""
        return self.course.machine, self.flight.machine, self.additional.machine

    @property
    def discharged(self) -> Clause:
        """The law that the time of flight guarantees."""
        return Clause(self.additional.machine, TRUE_PLACE)


@dataclass(frozen=True, eq=False)
class FibreDevice:
    """The machines, and their composition; counters at the low and the high end, machines of the front and of the rear."""

    config: FibreDeviceConfig
    counters: tuple[AxleCounter, AxleCounter]
    reference: Reference
    ends: tuple[TimedEnd, TimedEnd]
    area: FibreArea

    @property
    def composition(self) -> Composition:
        """All machines in one step."""
        return self.area.composition


def compose_machines(config: FibreDeviceConfig | None = None) -> FibreDevice:
    """Compose the device of one train and its area."""
    config = config or FibreDeviceConfig()
    low, high = (_counter(config, side) for side in SIDES)
    counted = counted_axles_model.build(counted_axles_model.Parts(config))
    reference = reference_model.build(reference_model.Parts(config))
    front, rear = _end(config, "front"), _end(config, "rear")
    area = fibre_area.machines_of(config.area, front.sections, rear.sections)
    sensors = Sensors(
        NAME,
        [low.machine, high.machine, counted.machine, reference.machine, *front.machines, *rear.machines],
        {
            **_heads(counted, (low, high), area),
            **_recorded(reference, (low, high), area),
            **_told(reference, area),
            **_timed(front),
            **_timed(rear),
        },
        [Clause(area.entry.machine, SOUND), front.discharged, rear.discharged],
    )
    return FibreDevice(config, (low, high), reference, (front, rear), fibre_area.joined(config.area, area, sensors))


def _counter(config: FibreDeviceConfig, side: str) -> AxleCounter:
    """Return the counter at one end, with one more lemma: a train over it can always stop in its coordinates, so that there is a next step."""
    own, figures = axle_counter.parts(config.counter), config.counter
    cycles = figures.max_speed_mm_s * MS_PER_S // (figures.change_mm_s2 * figures.period_ms) + 2
    stopped = own.run + own.speed * Lit(cycles * figures.period_ms, MS)
    counter = axle_counter.build(own)
    lemmas = {**counter.machine.lemmas, "a train can stop": between(own.run.low, stopped, own.run.high)}
    return replace(counter, machine=replace(counter.machine, name=f"counter_{side}", lemmas=lemmas))


def _end(config: FibreDeviceConfig, name: str) -> TimedEnd:
    """Return the machines of one end of the train."""
    located, timed = fibre.parts(config.area.fibre), time_of_flight.parts(config.time_of_flight)
    hears_the_amplitude = AdditionalParts(config.timed, fibre.parts(config.area.fibre), timed)
    return TimedEnd(
        course(located, f"{name}_course"),
        time_of_flight.build(timed, f"{name}_flight"),
        _named(additional(hears_the_amplitude), f"{name}_additional"),
        fibre.build(located, name),
    )


def _named(model: _Model, name: str) -> _Model:
    """Return a machine under a name of its own: there are two of it."""
    return replace(model, machine=replace(model.machine, name=name))


# ------------------------------------------------------------------ the counters


def _heads(counted: CountedAxles, counters: tuple[AxleCounter, AxleCounter], area: Machines) -> dict[Var, Expr]:
    """Return the wires of the heads: the section counts the axles of the counters' heads, and those that really pass are the same."""
    heads, own, none = area.axle_section.own, counted.own, as_num(0, COUNT)
    wires: dict[Var, Expr] = {
        heads.fault: own.head_fault,
        heads.damped: own.head_damped,
        **dict(zip(heads.into, own.into, strict=True)),
        **dict(zip(heads.out, own.out, strict=True)),
    }
    for side, counter in enumerate(counters):
        heard, passed = counter.own, counter.own.true_axles_in_cycle
        up = heard.axle_true_speed > 0
        upwards, downwards = ite(up, passed, none), ite(up, none, passed)
        wires |= {
            own.axle[side]: heard.axle,
            own.axles[side]: heard.axles_in_cycle,
            own.fault[side]: heard.fault,
            own.damped[side]: heard.damped,
            heads.true_into[side]: (upwards, downwards)[side],
            heads.true_out[side]: (downwards, upwards)[side],
        }
    return wires


def _recorded(reference: Reference, counters: tuple[AxleCounter, AxleCounter], area: Machines) -> dict[Var, Expr]:
    """Return the wires of the reference: what the counters tell, their places, and who was outermost before the step."""
    ends = area.area.own.low_end, area.area.own.high_end
    wires: dict[Var, Expr] = {
        reference.own.true_axles: in_range_of(before(area.entry.own.true_axles), reference.own.true_axles),
        **outermost_before(area.order, [one.outermost for one in reference.own.counted]),
    }
    for counter, to, end in zip(counters, reference.own.counted, ends, strict=True):
        machine = counter.machine
        wires |= {
            to.ready: machine.flag("record_ready"),
            to.sound: machine.flag("record_sound"),
            to.direction: machine.output("record_direction"),
            to.axles: machine.output("record_axles"),
            to.end: in_range_of(before(end), to.end),
            to.passed: counter.own.axles,
        }
        for pair, name, unit in ((to.length, "length", "um"), (to.run, "run", "um"), (to.speed, "speed", "mm_s")):
            told = (machine.output(f"record_{name}_{bound}_{unit}") for bound in SIDES)
            wires |= dict(zip(pair, told, strict=True))
    return wires


def _told(reference: Reference, area: Machines) -> dict[Var, Expr]:
    """Return the wires of entry and verification: the reference, and the train that comes in."""
    own, told, entry, verified = reference.own, reference.own.told, area.entry.own, area.verification.own
    bounds = {
        (verified.record_length_low, verified.record_length_high): told.length,
        (verified.record_speed_low, verified.record_speed_high): told.speed,
        (verified.record_place_low, verified.record_place_high): told.place,
    }
    return {
        **dict(zip(entry.enters, own.enters, strict=True)),
        entry.axles_of_one_that_enters: own.axles_of_one_that_enters,
        entry.comes: own.sender,
        entry.record_sound: told.sound,
        entry.record_axles: told.axles,
        verified.record_age: told.age,
        **{to: one for pair, from_ in bounds.items() for to, one in zip(pair, from_, strict=True)},
    }


# ------------------------------------------------------------------ the time of flight


def _timed(end: TimedEnd) -> dict[Var, Expr]:
    """Return the wires of one end: its course, the place by time of flight, the one that is compared, and the amplitude."""
    flight, compared, sections = end.flight, end.additional, end.sections.own
    position, below, above = wired_interval(flight.machine)
    own, to, handed = compared.own, sections.flight_position, compared.machine.flag("compared")
    return {
        end.course.own.place: in_range_of(before(sections.ghosts.truth), end.course.own.place),
        sections.ghosts.true_run: end.course.own.run,
        flight.own.next_truth: end.course.own.place_after,
        own.next_truth: end.course.own.place_after,
        own.position.present: flight.machine.flag("valid"),
        own.position.value: position,
        own.below: below,
        own.above: above,
        to.present: handed,
        to.value: ite(handed, own.place, as_num(0, MM)),
        sections.amplitude.present: own.amplitude.present,
        sections.amplitude.value: own.amplitude.value,
    }
