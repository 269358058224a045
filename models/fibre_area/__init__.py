"""A train in a line area, from backscatter to virtual sections, as one step (FWG-1 to FVA-18).

    axle_section  axles counted in and out at both ends: clear, or not; its resets       models.axle_section
    entry         the train is counted in; its reference comes, or is overdue            fibre_area.entry
    train_order   trains in their order; which of the fibre's patterns is this train's   models.train_order
    front, rear   fibre machines of the train's ends: position code, count, error F      models.fibre
    emitter       function check of the fibre chain                                      models.emitter
    verification  both ends against the entry record, over the whole stay                models.verification
    report        ends of the pattern that are the train's, which may have parted        fibre_area.report
    area          intervals of all trains of the area, and bounds of uncounted vehicles  models.area
    section_n     virtual sections: FREE, OCCUPIED, AMBIGUOUS, UNKNOWN                   models.sections

The machines act in this order within one step. So any disagreement withholds and revokes the position, and keeps sections
from becoming clear, in the very cycle in which it occurs. "Front" is the end towards growing positions, whichever way the
train runs; the other one is the rear. The train is slot 1 of the area; the reports of other trains (slots 2 on) are
inputs, which other such compositions produce. `entry` alone hears a later machine, one step late: which trains were outermost, by the order.

Inputs of a cycle, by name; all others are wired:

    axle_section.axles_in_low, _in_high, _out_low, _out_high   axles that the heads at both ends counted in this cycle
    axle_section.head_fault, head_damped, reset_requested, sweep_reported_clear
    entry.enters_low, enters_high  number of the train that comes in there, in the cycle of its first axle; 0: none
    entry.leaves_low, leaves_high  the running part of a train has passed out there
    entry.train_k_all_left  (k from 2)   all of that train has left, as its own composition counts
    entry.train_k_axles_of_others (k from 2)  axles came in beside that train that are not its own, as its own composition tells in the same cycle
    entry.reference_comes          sender of the record that comes for this train in this cycle: NOBODY, AXLE_COUNTER or NEIGHBOUR
    entry.record_sound, entry.record_axles  that record: undisturbed, and its axles
    train_order.patterns, pattern_n_low_mm, pattern_n_high_mm  number and ends of the fibre's patterns in the area, from the low end
    front.*, rear.*                as models.fibre: amplitude_cdb, run_mm, flight_position_mm, reflecting_point_mm,
                                   ahead_*, behind_*, reference_accepted, reference_count, reference_position_mm,
                                   word_found, word_count, word_position_mm
    emitter.heard_pattern, emitter.heard_place_mm, emitter.test_requested
    verification.record_*          that record's length, speed, place of the front and age
    verification.fibre_axles, fibre_length_mm, fibre_speed_mm_s       the detector's readings of this train's pattern
    verification.control_*         data from train control on the train
    report.reading_age_ms          age of this cycle's readings
    area.train_k_*  (k from 2)     rear_mm, front_mm, report_age_ms, trusted, integer, downwards

Outputs, by name: `verification.trusted`, `.position_mm`, `.margin_above_mm`, `.margin_below_mm`, `.revoked`, `.reason`, `.verified_*`,
`.handover_*` (the record for the neighbour); `front.error`, `rear.error` (F) with their reasons; `emitter.failed`; `report.*`;
`section_n.clear` and its evidence. Each machine has further outputs for its state.

The axle counter that makes the record is no part of the step: it works five times as often, and sends a record when a train has passed
(models.counted_entry).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import (
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Var,
    all_of,
    any_of,
    as_num,
    before_step,
    between,
    ceil_to,
    exact_to,
    floor_to,
    ite,
    maximum,
    minimum,
)
from safeloc.language.machine import Machine
from safeloc.language.terms import Substitution
from safeloc.language.units import MM, UM
from safeloc.models import area as area_model
from safeloc.models import axle_section as axle_section_model
from safeloc.models import emitter as emitter_model
from safeloc.models import fibre as fibre_model
from safeloc.models import train_order as train_order_model
from safeloc.models import verification as verification_model
from safeloc.models.area import Area
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW
from safeloc.models.area.world import CLEAR_CLAUSE
from safeloc.models.axle_section import AxleSection
from safeloc.models.emitter import Emitter
from safeloc.models.fibre import Fibre, FibreConfig
from safeloc.models.fibre_area import entry as entry_model
from safeloc.models.fibre_area import report as report_model
from safeloc.models.fibre_area.configuration import FibreAreaConfig
from safeloc.models.fibre_area.entry import EMPTY, EXACT, THIS, Entry
from safeloc.models.fibre_area.parting import ReportedRun
from safeloc.models.fibre_area.report import Report
from safeloc.models.sections import Section, section, section_wires
from safeloc.models.train_order import TrainOrder, TrainOrderConfig
from safeloc.models.verification import Verification
from safeloc.models.vocabulary.absent import wired_interval

__all__ = [
    "FibreArea",
    "FibreAreaConfig",
    "Machines",
    "Sensors",
    "compose_machines",
    "ends",
    "entry_parts",
    "in_range_of",
    "joined",
    "machines_of",
    "outermost_before",
    "reported_run",
]


@dataclass(frozen=True, eq=False)
class Sensors:
    """Machines that a larger composition has before those of an area, and their wires (models.fibre_device).

    name       of the composition
    machines   before those of the area
    wires, discharge  as `compose` takes them, beside those of the area
    """

    name: str = "fibre_area"
    machines: Sequence[Machine] = ()
    wires: Mapping[Var, Expr] = field(default_factory=dict)
    discharge: Sequence[Clause] = ()


@dataclass(frozen=True, eq=False)
class Machines:
    """The machines of an area, in the order of the step."""

    axle_section: AxleSection
    entry: Entry
    order: TrainOrder
    front: Fibre
    rear: Fibre
    emitter: Emitter
    verification: Verification
    report: Report
    area: Area
    sections: tuple[Section, ...]

    def in_order(self) -> list[Machine]:
        """Return them as they act."""
        first = [
            self.axle_section.machine,
            self.entry.machine,
            self.order.machine,
            self.front.machine,
            self.rear.machine,
        ]
        then = [self.emitter.machine, self.verification.machine, self.report.machine, self.area.machine]
        return [*first, *then, *(one.machine for one in self.sections)]


@dataclass(frozen=True, eq=False, kw_only=True)
class FibreArea(Machines):
    """The machines, and their composition."""

    config: FibreAreaConfig
    composition: Composition


def compose_machines(config: FibreAreaConfig | None = None) -> FibreArea:
    """Return all machines of one train and its area in one step (FVA-1, FVA-9)."""
    config = config or FibreAreaConfig()
    front, rear = (fibre_model.build(fibre_model.parts(config.fibre), name) for name in ("front", "rear"))
    return joined(config, machines_of(config, front, rear))


def machines_of(config: FibreAreaConfig, front: Fibre, rear: Fibre) -> Machines:
    """Return all machines of one train and its area, with the given ones of its ends."""
    area_parts = area_model.parts(config.sections.area)
    first = area_parts.slots[:1]
    return Machines(
        axle_section_model.build(axle_section_model.parts(config.axle_section)),
        entry_model.build(entry_parts(config)),
        train_order_model.build(train_order_model.parts(TrainOrderConfig(trains=config.sections.area.trains))),
        front,
        rear,
        emitter_model.build(emitter_model.parts(config.emitter)),
        verification_model.build(verification_model.parts(config.verification), place_kept=True),
        report_model.build(_report_parts(config, front.own.ghosts.truth.high // 1_000 + 1)),
        area_model.build(area_parts, kept=first, counted_out=first),
        tuple(section(config.sections, f"section_{n}") for n in range(1, config.sections.sections + 1)),
    )


def entry_parts(config: FibreAreaConfig) -> entry_model.Parts:
    """Return the variables of the entry, in the ranges of the machines beside it."""
    return entry_model.parts(
        trains=config.sections.area.trains,
        wait_cycles=config.record_wait_cycles,
        axle_limit=config.verification.axle_limit,
        axles_a_cycle=config.axle_section.axles_a_cycle,
    )


def reported_run(fibre: FibreConfig) -> ReportedRun:
    """Return limit and error law of a pattern's measured run."""
    return ReportedRun(fibre.max_cycle_distance_mm, fibre.rate_ppm, fibre.floor_mm)


def _report_parts(config: FibreAreaConfig, pattern_limit_um: int) -> report_model.Parts:
    long = config.verification.length_limit_mm
    return report_model.parts(
        config.parting, config.sections.area.reach, reported_run(config.fibre), pattern_limit_um, long
    )


def joined(config: FibreAreaConfig, of: Machines, sensors: Sensors | None = None) -> FibreArea:
    """Return the given machines, wired, behind the given sensors."""
    sensors = sensors or Sensors()
    wires: dict[Var, Expr] = {
        **sensors.wires,
        **_entry_wires(of.entry, of.axle_section, of.order),
        **_order_wires(of.order, of.axle_section, of.entry),
        **_verification_wires(of.verification, of.front, of.rear, of.emitter, of.entry, of.order),
        **_report_wires(config, of.report, of.front, of.rear, of.verification, of.entry, of.order),
        **_area_wires(of.area, of.report, of.entry, of.axle_section),
    }
    for one in of.sections:
        wires |= section_wires(of.area, one)
    composition = compose(
        sensors.name,
        [*sensors.machines, *of.in_order()],
        wires,
        discharge=[
            *sensors.discharge,
            Clause(of.entry.machine, EXACT),
            Clause(of.entry.machine, EMPTY),
            Clause(of.area.machine, CLEAR_CLAUSE),
        ],
    )
    return FibreArea(**vars(of), config=config, composition=composition)


def _entry_wires(entry: Entry, axle_section: AxleSection, order: TrainOrder) -> dict[Var, Expr]:
    """Return the wires of the entry: counted axles, and the trains that were outermost, by the order before the step."""
    own, heads = entry.own, axle_section.own
    earlier = _earlier(order.machine)
    return {
        own.clear: axle_section.machine.flag("clear"),
        own.axle_between: heads.axles > 0,
        own.occupied: axle_section.machine.flag("healthy") & ~axle_section.machine.flag("clear"),
        own.counters_count: axle_section.machine.flag("healthy") & earlier.bool(order.machine.flag("ordered")),
        **outermost_before(order, own.outermost),
        **dict(zip(own.axles_in, heads.into, strict=True)),
        **dict(zip(own.axles_out, heads.out, strict=True)),
        **dict(zip(own.passed_in, heads.true_into, strict=True)),
        **dict(zip(own.passed_out, heads.true_out, strict=True)),
    }


def outermost_before(order: TrainOrder, low_and_high: Sequence[NumVar]) -> dict[Var, Num]:
    """Return the wires of the trains that were outermost at the low and the high end, by the order before the step."""
    earlier = _earlier(order.machine)
    outermost = (earlier.num(order.machine.output(f"outermost_{side}")) for side in ("low", "high"))
    return {to: in_range_of(one, to) for to, one in zip(low_and_high, outermost, strict=True)}


def in_range_of(number: Num, to: NumVar) -> Num:
    """Return the number within the input's range: what is proved of a later machine is not known yet where an earlier one is proved."""
    return maximum(minimum(number, to.high), to.low)


def _earlier(machine: Machine) -> Substitution:
    """Return the rewriting of a machine's outputs into what they were before the step."""
    return Substitution({var: before_step(var) for var in (machine.mode, *machine.state)})


def _order_wires(order: TrainOrder, axle_section: AxleSection, entry: Entry) -> dict[Var, Expr]:
    """Return the wires of the order: a train that left a part behind has not left."""
    own, passes = order.own, entry.own
    return {
        own.enters_low: passes.enters[0],
        own.enters_high: passes.enters[1],
        own.leaves_low: passes.gone[0],
        own.leaves_high: passes.gone[1],
        own.clear: axle_section.machine.flag("clear"),
        own.fault: ~_counted(axle_section, entry),
    }


def ends(fibre: Fibre) -> tuple[Num, Num]:
    """Return bounds of one end of the train, as its machine reports them."""
    position, below, above = wired_interval(fibre.machine)
    return position - below, position + above


def _counted(axle_section: AxleSection, entry: Entry) -> Bool:
    """Return the condition that the counters count, and that axles which they count in are of a train that is known."""
    return axle_section.machine.flag("healthy") & ~entry.own.unannounced


def _verification_wires(
    verification: Verification, front: Fibre, rear: Fibre, emitter: Emitter, entry: Entry, order: TrainOrder
) -> dict[Var, Expr]:
    """Return the wires of the verification: front's interval, while both ends are located; F of either; emitter; reference."""
    own, config = verification.own, verification.own.config
    located = front.machine.flag("valid") & rear.machine.flag("valid")
    (front_low, front_high), (rear_low, rear_high) = ends(front), ends(rear)
    near, far = front_low - rear_high, front_high - rear_low
    position, below, above = wired_interval(front.machine)
    usable = all_of(
        [
            located,
            between(-config.position_limit_mm, position, config.position_limit_mm),
            (above <= config.margin_limit_mm) & (below <= config.margin_limit_mm),
            *(
                between(var.value.low, term, var.value.high)
                for var, term in ((own.ends_low, near), (own.ends_high, far))
            ),
        ]
    )
    wires: dict[Var, Expr] = {
        own.located: located,
        own.fibre_position.present: usable,
        own.ends_low.present: usable,
        own.ends_high.present: usable,
        own.fibre_error: front.machine.flag("error") | rear.machine.flag("error"),
        own.chain_tested: emitter.machine.flag("chain_tested"),
        own.chain_failed: emitter.machine.flag("failed"),
        own.due: entry.own.due,
        own.reference_from: entry.own.source,
        own.sound: entry.own.record_sound,
        own.record_axles: entry.own.record_axles,
        own.leaves: entry.own.forgets,
        own.associated: any_of(one.eq(THIS) for one in order.own.belongs),
        own.next_truth: front.own.ghosts.truth,
    }
    seen = {own.fibre_position.value: position, own.fibre_margin_above: above, own.fibre_margin_below: below}
    seen |= {own.ends_low.value: near, own.ends_high.value: far}
    return {**wires, **{var: _if(usable, term) for var, term in seen.items()}}


def _report_wires(
    config: FibreAreaConfig,
    report: Report,
    front: Fibre,
    rear: Fibre,
    verification: Verification,
    entry: Entry,
    order: TrainOrder,
) -> dict[Var, Expr]:
    """Return the wires of the report machine: both ends of the pattern, its run, and the match of its count in this cycle."""
    own, verified, limit = report.own, verification.own, config.sections.area.limit_mm
    (low, rear_high), (front_low, high) = ends(rear), ends(front)
    trusted = verification.machine.flag("trusted")
    located = front.machine.flag("valid") & rear.machine.flag("valid")
    usable = all_of([located, *(between(-limit, place, limit) for place in (low, rear_high, front_low, high))])
    run = front.own.run
    known = verification.machine.mode.one_of(*verification.machine.modes[1:3])
    return {
        own.trusted: trusted,
        own.count_matches_now: trusted & verified.by_count & verified.verified_ago.eq(0),
        own.gone: entry.own.left | entry.own.events[0].one_of(ENTERS_LOW, ENTERS_HIGH),
        own.usable: usable,
        own.low: _if(usable, low),
        own.high: _if(usable, high),
        own.front_low: _if(usable, front_low),
        own.rear_high: _if(usable, rear_high),
        own.longest: ite(known, verified.stored_length_high, as_num(0, MM)),
        own.upwards: verified.associated & run.present & (run.value > 0),
        own.downwards: verified.associated & run.present & (run.value < 0),
        own.run: _if(run.present, run.value),
        own.pattern_rear: floor_to(rear.own.ghosts.truth, UM),
        own.pattern_front: ceil_to(front.own.ghosts.truth, UM),
        own.count_had_all_axles: known & verified.axles.eq(verified.stored_axles),
        own.pattern_is_the_trains: any_of(_holds_this_train(order, rank) for rank in range(len(order.own.belongs))),
    }


def _holds_this_train(order: TrainOrder, rank: int) -> Bool:
    """Return the condition that the pattern belongs to this train, and that the train is in it."""
    low, high = exact_to(order.own.lows[rank], UM), exact_to(order.own.highs[rank], UM)
    return order.own.belongs[rank].eq(THIS) & between(low, order.own.trains[THIS - 1].place, high)


def _area_wires(area: Area, report: Report, entry: Entry, axle_section: AxleSection) -> dict[Var, Expr]:
    """Return the wires of the area: counters, events of all trains, the report of slot 1, and that train's true ends.

    While the counters count, a train that came in is there for the area as for the entry: also while its first wheel stands on a head, and none of
    its axles is counted.
    """
    slot, own, reported = area.own.slots[0], report.own, report.machine.flag("reported")
    assert isinstance(area.own.axle_between, BoolVar)
    return {
        area.own.healthy: _counted(axle_section, entry),
        area.own.clear: axle_section.machine.flag("clear"),
        area.own.axle_between: (axle_section.own.axles > 0) | _came_in(entry, axle_section),
        **{one.event: event for one, event in zip(area.own.slots, entry.own.events, strict=True)},
        slot.next_all_out: entry.own.true_axles_inside.eq(0),
        slot.rear.present: reported,
        slot.front.present: reported,
        slot.rear.value: report.machine.output("low_mm"),
        slot.front.value: report.machine.output("high_mm"),
        slot.age: own.age,
        slot.trusted: reported,
        slot.integer: report.machine.flag("integer"),
        slot.downwards: report.machine.flag("downwards"),
        slot.next_rear: own.next_rear,
        slot.next_front: own.next_front,
    }


def _came_in(entry: Entry, axle_section: AxleSection) -> Bool:
    counting = axle_section.machine.flag("healthy") & ~axle_section.machine.flag("clear")
    return entry.own.there & counting


def _if(usable: Bool, term: Num) -> Num:
    return ite(usable, term, as_num(0, MM))
