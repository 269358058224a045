"""The world of a train whose fibre may be wrong: nothing is assumed of any of the fibre's readings, at any time.

Count, place, length, speed and the pattern's identity may be wrong, alone or together, from any moment on. So may the
signals of the emitter and of train control. The laws tie down only the train as it passed the axle counter, the motion of a
train, and the counter's record (FVA-4): the one sensor that is safe in the signalling sense.

    axles, length  of the train of the last record, as it passed the counter; it stays the same train if it loses vehicles later
    truth          the front of that train
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    NumVar,
    Var,
    abs_,
    all_of,
    as_num,
    between,
    exact_to,
    ite,
    minimum,
    number,
    with_unit,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, NM, NM_PER_MM, UM, UM_PER_MM, UM_S
from safeloc.language.world import Law, World
from safeloc.models.verification.variables import AXLE_COUNTER, NEIGHBOUR, Parts

RECORD = "an axle counter's record is true"
_HANDED_OVER = "a neighbour's record is true"


@dataclass(frozen=True, eq=False)
class Doubted:
    """Ghosts besides axles, length and front of the train.

    speed        the train's speed
    width        distance between the outermost places possible for the front by the last record and the top speed alone
    record_ago   cycles since that record, up to one more than a place can be used
    spread       distance between the bounds of the length in that record
    since_confirmed   cycles since the fibre reported the train's count, or its length within tolerance and spread
    """

    own: Parts
    speed: NumVar
    next_speed: NumVar
    width: NumVar
    record_ago: NumVar
    spread: NumVar
    since_confirmed: NumVar


def doubted(own: Parts) -> Doubted:
    """Return fresh ghosts of the train beside those of the machine's parts."""
    config = own.config
    fast, cycles = config.max_speed_mm_s * UM_PER_MM, config.place_doubt_limit_mm // (2 * config.fastest_run_mm) + 2
    wide = 2 * own.possible_high.high * NM_PER_MM
    return Doubted(
        own,
        number("true_speed_um_s", UM_S, -fast, fast),
        number("next_true_speed_um_s", UM_S, -fast, fast),
        number("record_width_nm", NM, -wide, wide),
        number("record_ago_cycles", COUNT, 0, cycles),
        number("record_spread_um", UM, -own.length.high, own.length.high),
        number("since_confirmed_cycles", COUNT, 0, config.currency_cycles + 1),
    )


def world(train: Doubted) -> World:
    """Return the world: the train, its motion and its records; no clause reads the fibre, the emitter or train control."""
    own = train.own
    return World(
        ghosts={
            **own.declared.ghosts,
            **dict.fromkeys((train.speed, train.width, train.spread), ANY),
            train.record_ago: 0,
            train.since_confirmed: 0,
        },
        choices=[*own.declared.choices, train.next_speed],
        moves={
            own.axles: own.next_axles,
            own.length: own.next_length,
            own.truth: own.next_truth,
            train.speed: train.next_speed,
            **_since_record(train),
        },
        clauses={**_train(own), **_records(train)},
    )


# ------------------------------------------------------------------ ghosts of the last record


def _came(own: Parts) -> Bool:
    return own.due & own.reference_from.one_of(AXLE_COUNTER, NEIGHBOUR)


def _since_record(train: Doubted) -> dict[Var, Num]:
    """Return the moves of the ghosts of the last record: its age, and the width that it still leaves open."""
    own, came = train.own, _came(train.own)
    width = exact_to(own.record_place_high - own.record_place_low, NM) + 2 * _ran(own)
    grown = minimum(train.width + 2 * _run_nm(own), train.width.high)
    spread = ite(came, exact_to(own.record_length_high - own.record_length_low, UM), train.spread)
    older = minimum(train.since_confirmed + 1, train.since_confirmed.high)
    return {
        train.width: ite(came, width, grown),
        train.record_ago: ite(came, 0, minimum(train.record_ago + 1, train.record_ago.high)),
        train.spread: spread,
        train.since_confirmed: ite(_measured_right(own, spread), as_num(0, COUNT), older),
    }


def _measured_right(own: Parts, spread: Num) -> Bool:
    """Return the condition that the fibre reported the train's count, or its length within tolerance and spread."""
    count = own.fibre_axles.present & own.next_axles.eq(own.fibre_axles.value)
    off = abs_(own.next_length - exact_to(own.fibre_length.value, UM))
    near = off - spread <= own.config.length_tolerance_mm * UM_PER_MM
    return own.associated & (count | (own.fibre_length.present & near))


def _run_nm(own: Parts) -> Num:
    """Return the run that the machine adds per cycle: that of the top speed, in whole millimetres, nm."""
    return Lit(own.config.fastest_run_mm * NM_PER_MM, NM)


def _ran(own: Parts) -> Num:
    return with_unit(own.record_age * (own.config.fastest_run_mm * NM_PER_MM), NM)


# ------------------------------------------------------------------ laws


def _train(own: Parts) -> dict[str, Bool | Law]:
    """Return the laws of the train of the last record, which moves as a train does."""
    config, limit = own.config, own.config.position_limit_mm * NM_PER_MM
    same, another = own.next_axles.eq(own.axles) & own.next_length.eq(own.length), own.leaves | _came(own)
    run = abs_(own.next_truth - own.truth)
    return {
        "from record to record it is the same train": Law(
            another | same,
            "Axles and length are those of the train of the last record as it passed the counter, until an input "
            "reports that it has left or another record comes: no other train takes its place unreported.",
            source="[D] counters at both ends of the area, and no passing (train_order: the counters report each train "
            "that leaves)",
            owner="infrastructure",
            check="counts at both ends agree whenever the area is empty; a cycle whose inputs are lost begins anew",
        ),
        "the front runs no faster than the top speed": Law(
            another | (run <= config.max_speed_mm_s * config.period_ms * 1_000),
            "In one cycle the front of that train runs no farther than at the top speed, in either direction.",
            figures=("max_speed_mm_s", "period_ms"),
            source="[D] line speed",
            owner="operator",
            check="speed supervision",
        ),
        "the line ends": Law(
            between(-limit, own.next_truth, limit),
            "No front lies beyond the coordinates of the line.",
            figures=("position_limit_mm",),
            source="[D] 1 000 km of line",
            owner="infrastructure",
            check="the line's map",
        ),
    }


def _records(train: Doubted) -> dict[str, Bool | Law]:
    """Return the laws of a counter's record, and of a record that is handed over."""
    own = train.own
    width, handed = (own.due & own.sound & own.reference_from.eq(one) for one in (AXLE_COUNTER, NEIGHBOUR))
    return {
        RECORD: Law(
            width.implies(_true_record(own) & _true_speed(train)),
            "A record that the axle counter reports as undisturbed is the train's: its axles exactly, its length "
            "within the reported bounds, and its front and its speed within theirs, as many cycles ago as the "
            "record is old. A false record that is reported as undisturbed is a wrong-side failure, no more "
            "frequent than the counter's tolerable hazard rate.",
            figures=("record_hazard_rate", "max_speed_mm_s", "traction_mm_s2", "brake_mm_s2", "period_ms"),
            source="[S] 003, claim 4: the lineside sensor is safe in the signalling sense; proved of axle_counter, but for its heads",
            owner="infrastructure",
            check="the counter's safety case (SIL 4); counts of neighbouring counters compared",
        ),
        _HANDED_OVER: Law(
            handed.implies(_true_record(own)),
            "The record that the neighbouring area hands over of a train that it trusts is true: axles, bounds "
            "of the length, and bounds of the front as many cycles ago as the record is old.",
            figures=("max_speed_mm_s", "period_ms"),
            source="[D] claimed of this machine: a record that is handed over is true",
            owner="infrastructure",
            check="the neighbour verifies by this same machine; the link is safe against corruption (EN 50159)",
        ),
    }


def _true_record(own: Parts) -> Bool:
    """Return the condition that axles, length and place agree with the record; the place as many cycles ago as the record is old."""
    ran = with_unit(own.record_age * (own.config.max_speed_mm_s * own.config.period_ms * 1_000), NM)
    low, high = (exact_to(one, NM) for one in (own.record_place_low, own.record_place_high))
    return all_of(
        [
            own.next_axles.eq(own.record_axles),
            between(exact_to(own.record_length_low, UM), own.next_length, exact_to(own.record_length_high, UM)),
            own.next_truth + ran >= low,
            own.next_truth - ran <= high,
        ]
    )


def _true_speed(train: Doubted) -> Bool:
    """Return the condition that the train's speed is that of the record, but for traction and brakes since."""
    own, config = train.own, train.own.config
    change = max(config.traction_mm_s2, config.brake_mm_s2) * config.period_ms
    changed = with_unit(own.record_age * change, UM_S)
    slow, fast = (exact_to(one, UM_S) for one in (own.record_speed_low, own.record_speed_high))
    return (train.next_speed + changed >= slow) & (train.next_speed - changed <= fast)
