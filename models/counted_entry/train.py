"""The train that the counter has counted last: it is the train that the verification speaks of.

The machine computes nothing. Its world says which train a record is of: the one that has just passed the head. Axles and length are
those that the counter's own world counted of it; its front is the foremost axle that passed, and the overhang before it. Each axle may have been
counted a little beyond the head.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    BoolVar,
    Num,
    NumVar,
    all_of,
    as_num,
    between,
    boolean,
    floor_to,
    ite,
    maximum,
    minimum,
    number,
)
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.units import COUNT, NM, NM_PER_MM, UM, UM_PER_MM, UM_S
from safeloc.language.world import Law
from safeloc.models.axle_counter.passage import Parts as CounterParts
from safeloc.models.counted_entry.configuration import CountedEntryConfig
from safeloc.models.verification.variables import Parts as VerificationParts

NAME = "train"


@dataclass(frozen=True, eq=False)
class Counted:
    """The train that passed the head, by the counter's world: axles, length and run of the foremost axle, counted
    upwards, and speed.
    """

    axles: NumVar
    length: NumVar
    run: NumVar
    speed: NumVar
    upwards: BoolVar


@dataclass(frozen=True, eq=False)
class Train:
    """The machine and its variables.

    record_is_undisturbed  input: an undisturbed record comes in this cycle
    counted   choices, wired to the counter's world
    axles, length, front, speed  ghosts: the train of the last record; whatever runs elsewhere moves freely
    overhang  ghost: from its outermost axle to its end
    """

    machine: Machine
    record_is_undisturbed: BoolVar
    counted: Counted
    axles: NumVar
    length: NumVar
    front: NumVar
    speed: NumVar


def train(config: CountedEntryConfig, counter: CounterParts, verified: VerificationParts) -> Train:
    """Build the machine; its ghosts have the ranges of the machines before and behind it."""
    declared, table = Declared(), modes("RUNNING")
    recorded = declared.sensor(boolean("record_is_undisturbed"))
    counted = _counted(declared, counter)
    farthest, fastest = verified.truth.high, config.verification.max_speed_mm_s * UM_PER_MM
    axles = declared.ghost(number("recorded_axles", COUNT, 0, verified.axles.high), first=ANY)
    length = declared.ghost(number("recorded_length_um", UM, 0, verified.length.high), first=ANY)
    front = declared.ghost(number("front_nm", NM, -farthest, farthest), first=ANY)
    speed = declared.ghost(number("front_speed_um_s", UM_S, -fastest, fastest), first=ANY)
    overhang = declared.ghost(number("overhang_nm", NM, 0, counter.length.high), first=ANY)
    next_front = declared.choice(number("next_front_nm", NM, -farthest, farthest))
    next_speed = declared.choice(number("next_front_speed_um_s", UM_S, -fastest, fastest))
    next_overhang = declared.choice(number("next_overhang_nm", NM, 0, counter.length.high))
    late = _late(declared, config)
    passed = config.counter_mm * NM_PER_MM + _foremost(counted, late) + next_overhang
    made = declared.machine(
        name=NAME,
        modes=table,
        outputs={},
        transitions=[Transition("runs", table[0], table[0], TRUE, {}, ("FVA-4",), 0)],
        world=declared.world(
            moves={
                axles: ite(recorded, minimum(counted.axles, axles.high), axles),
                length: ite(recorded, _length(counted, late, length), length),
                front: ite(recorded, passed, next_front),
                speed: ite(recorded, counted.speed, next_speed),
                overhang: next_overhang,
            },
            clauses=_laws(config, late, next_overhang),
        ),
        doc="The train of the last record, as the counter's world knows it. Assumed: no vehicle overhangs its axles, and no axle is counted beyond the "
        "head, farther than configured.",
    )  # fmt: skip
    return Train(made, recorded, counted, axles, length, front, speed)


def _laws(config: CountedEntryConfig, late: tuple[NumVar, NumVar], next_overhang: NumVar) -> dict[str, Law]:
    return {
        "no axle is counted farther beyond the head": Law(
            all_of(between(0, one, config.counter.late_mm * NM_PER_MM) for one in late),
            "A wheel is counted where it has left the head, or by a channel that comes free late at most so far beyond.",
            ("late_mm",),
            "[D] proved of the head's machines with one channel that comes free late",
            "supplier",
            "type test: how long a channel stays damped after its wheel",
        ),
        "no vehicle overhangs its axles farther": Law(
            between(0, next_overhang, config.overhang_mm * NM_PER_MM),
            "From the outermost axle of a train to its end it is no farther than the figure.",
            ("overhang_mm",),
            "[M, fairly sure] drawings of vehicles: 2 to 5 m",
            "operator",
            "vehicle data entry",
        ),
    }


def _counted(declared: Declared, counter: CounterParts) -> Counted:
    return Counted(
        declared.choice(number("counted_axles", COUNT, 0, counter.axles.high)),
        declared.choice(number("counted_length_nm", NM, counter.length.low, counter.length.high)),
        declared.choice(number("counted_run_nm", NM, counter.run.low, counter.run.high)),
        declared.choice(number("counted_speed_um_s", UM_S, counter.speed.low, counter.speed.high)),
        declared.choice(boolean("counted_upwards")),
    )


def _late(declared: Declared, config: CountedEntryConfig) -> tuple[NumVar, NumVar]:
    """Return how far beyond the head the first and the last axle were when they were counted."""
    most = 2 * config.counter.late_mm * NM_PER_MM
    first, last = (number(f"{axle}_axle_counted_beyond_nm", NM, 0, most) for axle in ("first", "last"))
    return declared.choice(first), declared.choice(last)


def _foremost(counted: Counted, late: tuple[NumVar, NumVar]) -> Num:
    """Return the place of the axle that lies farthest up the line, from the counter: of a train that came downwards the last one."""
    first, last = late
    return ite(counted.upwards, counted.run + first, counted.run - counted.length - last)


def _length(counted: Counted, late: tuple[NumVar, NumVar], length: NumVar) -> Num:
    """Return the length from first to last axle, in whole um.

    Of a train whose axles all passed one way it is not negative; the counter's world does not say so.
    """
    first, last = late
    ahead = maximum(ite(counted.upwards, counted.length, -counted.length) + first - last, as_num(0, NM))
    return minimum(floor_to(ahead, UM), length.high)
