"""A train counted into an area and verified there: axle counter and verification as one device (FVA-3, FVA-4, FVA-12, FVA-13).

    axle_counter          makes the entry record from what the counting head reports
    train                 no machine on board: which train the record is of
    verification_doubted  verifies the fibre's readings of that train against the record; the fibre may be wrong in everything

All act in one step. That an undisturbed record is true is not assumed: the counter's claims of count, length, place and speed
prove it. What is assumed of the counting head are its own laws, and of the train its traction, brakes and headway. The counting
head is no part of the step: it samples its channels some two hundred times a cycle (models.axle_head).
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Expr, Var, as_num, ceil_to, floor_to, ite, maximum
from safeloc.language.units import COUNT, MM
from safeloc.models import axle_counter, verification
from safeloc.models.axle_counter import AxleCounter
from safeloc.models.axle_head import UP
from safeloc.models.counted_entry.configuration import CountedEntryConfig
from safeloc.models.counted_entry.train import Train, train
from safeloc.models.verification import Verification
from safeloc.models.verification.doubted import RECORD
from safeloc.models.verification.variables import AXLE_COUNTER, NOBODY

__all__ = ["CountedEntry", "CountedEntryConfig", "compose_machines"]
NAME = "counted_entry"


@dataclass(frozen=True, eq=False)
class CountedEntry:
    """The composition and its machines."""

    config: CountedEntryConfig
    composition: Composition
    counter: AxleCounter
    train: Train
    verified: Verification


def compose_machines(config: CountedEntryConfig | None = None) -> CountedEntry:
    """Compose the device of an entrance; the train of the record is the one that passed the counter."""
    config = config or CountedEntryConfig()
    counter = axle_counter.build(axle_counter.parts(config.counter))
    verified = verification.build_doubted(verification.parts(config.verification))
    passed = train(config, counter.own, verified.own)
    wires: dict[Var, Expr] = {
        passed.record_is_undisturbed: counter.machine.flag("record_sound"),
        **_into_train(counter, passed),
        **_record(config, counter, verified),
        **_truth(passed, verified),
    }
    whole = compose(
        NAME, [counter.machine, passed.machine, verified.machine], wires, discharge=[Clause(verified.machine, RECORD)]
    )
    return CountedEntry(config, whole, counter, passed, verified)


def _into_train(counter: AxleCounter, passed: Train) -> dict[Var, Expr]:
    """Return the wires of the counter's ghosts to the train of the record."""
    of, to = counter.own, passed.counted
    return {
        to.axles: of.axles,
        to.length: of.length,
        to.run: of.run,
        to.speed: of.speed,
        to.upwards: of.last_axle_upwards,
    }


def _truth(passed: Train, verified: Verification) -> dict[Var, Expr]:
    """Return the wires of the verification's ghosts: its train is that of the record."""
    to, doubted = verified.own, verified.train
    assert doubted is not None  # it is built in the world of a doubted fibre
    return {
        to.next_axles: passed.axles,
        to.next_length: passed.length,
        to.next_truth: passed.front,
        doubted.next_speed: passed.speed,
    }


def _record(config: CountedEntryConfig, counter: AxleCounter, verified: Verification) -> dict[Var, Expr]:
    """Return the wires of the record, with speed and place counted upwards, and the place that of the front."""
    machine, to = counter.machine, verified.own
    ready, up = machine.flag("record_ready"), machine.output("record_direction").eq(UP)
    length, run, speed = (
        [machine.output(f"record_{name}_{end}_{unit}") for end in ("low", "high")]
        for name, unit in (("length", "um"), ("run", "um"), ("speed", "mm_s"))
    )
    place = ite(up, run[0], length[0] - run[1]), ite(up, run[1], length[1] - run[0])
    return {
        to.due: ready,
        to.reference_from: ite(ready, AXLE_COUNTER, NOBODY),
        to.sound: machine.flag("record_sound"),
        to.record_axles: machine.output("record_axles"),
        to.record_length_low: maximum(floor_to(length[0], MM), as_num(0, MM)),
        to.record_length_high: maximum(ceil_to(length[1], MM), as_num(0, MM)),
        to.record_speed_low: ite(up, speed[0], -speed[1]),
        to.record_speed_high: ite(up, speed[1], -speed[0]),
        to.record_place_low: floor_to(place[0], MM) + config.counter_mm,
        to.record_place_high: ceil_to(place[1], MM) + (config.counter_mm + config.overhang_mm),
        to.record_age: as_num(0, COUNT),
    }
