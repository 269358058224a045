"""The entry record of a train, from the axles that a counting head reports: count, speed, length, place (FVA-3, FVA-5).

    SPOILT   after power-up, or after a flaw in this passage: no record until an input reports that the passage is over
    IDLE     no train is passing
    PASSING  axles of one train are counted; its run since the first axle is bounded
    DONE     the train has passed in this cycle: the outputs hold the record, or the reason why there is none

The length from first to last axle is the integral of the speed over the occupation, not the speed times the time
(figures, 003 item 6): between axles the speed is bounded by traction and braking ability, and the bounds are summed. A
train has passed when it has certainly run farther than its longest distance between two axles. If the head is still damped then, a
wheel may have come that it has not counted, and there is no record. If the train runs too slowly for that,
an axle that comes after a pause as long as the headway may be another train's, and spoils the passage.

A head whose channel comes free late may count a wheel up to `late_mm` beyond it. So the first axle may lie that much farther on than the run says, and
the length may be that much shorter or longer; the record has room for both.

The run is counted from the first axle in whole um, positive in the direction in which the train came.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Bool, Expr, Lit, Num, any_of, ite, maximum, minimum
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import MS, UM_PER_MM
from safeloc.models.axle_counter.cycle import Cycle
from safeloc.models.axle_counter.lemmas import lemmas
from safeloc.models.axle_counter.passage import (
    HEAD_DAMPED,
    HEAD_FAULT,
    LENGTH_UNKNOWN,
    MAYBE_ANOTHER_TRAIN,
    NO_SPEED,
    SOUND,
    SPEED_CONTRADICTED,
    TOO_LONG,
    TOO_MANY,
    TURNED,
    AxleCounterConfig,
    Parts,
    parts,
)
from safeloc.models.axle_counter.world import world
from safeloc.models.axle_head import NO_AXLE
from safeloc.models.vocabulary.first_of import first_of

REQUIREMENTS = ("FVA-3", "FVA-5")


__all__ = ["AxleCounter", "AxleCounterConfig", "build", "machine", "parts"]


AxleCounter = Model[Parts]


def machine(config: AxleCounterConfig | None = None) -> Machine:
    """Return the machine that makes entry records (FVA-5)."""
    return build(parts(config or AxleCounterConfig())).machine


def build(own: Parts) -> AxleCounter:
    """Return the machine over the given variables."""
    table = modes("SPOILT", "IDLE", "PASSING", "DONE")
    current = current_mode(table)
    *_, done = table
    cycle = Cycle(own)
    made = own.declared.machine(
        name="axle_counter",
        modes=table,
        outputs=_outputs(own, current.eq(done)),
        transitions=list(_table(own, cycle, table)),
        world=world(own),
        lemmas=lemmas(own, current, table),
        definitions={
            "speed at least": cycle.speeds[0], "speed at most": cycle.speeds[1],
            "run at least": cycle.runs[0], "run at most": cycle.runs[1], "train has passed": cycle.passed,
        },
        doc=(
            "Entry record of a train from the axles that a counting head reports. Assumed: without a fault the "
            "head reports every axle in its cycle and in its direction, with true bounds of its speed, or stays damped; no train "
            "changes its speed faster, or has two axles farther apart, than configured; trains follow each other "
            "at the headway; the input that a passage is over is true."
        ),
    )  # fmt: skip
    return Model(made, own)


def _outputs(own: Parts, done: Bool) -> dict[str, Expr]:
    """Return the outputs: the record in the cycle in which it is ready, otherwise zeros."""
    sound, late = done & own.flaw.eq(SOUND), own.config.late_mm * UM_PER_MM

    def if_ready(term: Num) -> Num:
        return ite(sound, term, 0)

    return {
        "record_ready": done,
        "record_sound": sound,
        "record_axles": if_ready(own.axles_counted),
        "record_length_low_um": if_ready(own.length_low - late),
        "record_length_high_um": if_ready(own.length_high + late),
        "record_speed_low_mm_s": if_ready(own.speed_low),
        "record_speed_high_mm_s": if_ready(own.speed_high),
        "record_run_low_um": if_ready(own.run_low),
        "record_run_high_um": if_ready(own.run_high + late),
        "record_direction": own.direction,
        "record_flaw": own.flaw,
    }


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, cycle: Cycle, table: tuple[Lit, ...]) -> Iterator[Transition]:
    spoilt, idle, passing, done = table
    free, counted = (idle, done), cycle.counted & ~own.fault
    both_speeds = (
        own.axle_speed_low.present
        & own.axle_speed_high.present
        & (own.axle_speed_low.value <= own.axle_speed_high.value)
    )
    onward, flaws = counted & cycle.onward, _flaws(own, cycle, counted, both_speeds)
    wrong, flaw = any_of(when for when, _ in flaws), first_of(*flaws, default=SOUND)
    nothing, ran = _nothing(own), _ran(own, cycle)
    found: Updates = {own.flaw: ite(cycle.length_known, SOUND, LENGTH_UNKNOWN)}
    over = own.over & ~cycle.counted & ~own.fault
    yield Transition(
        "head at fault", (idle, passing, done), spoilt, own.fault,
        together(nothing, {own.flaw: HEAD_FAULT}), REQUIREMENTS, 0)  # fmt: skip
    yield Transition(
        "first axle without a speed", free, spoilt, counted & ~both_speeds,
        together(nothing, {own.flaw: NO_SPEED}), REQUIREMENTS, 1)  # fmt: skip
    yield Transition(
        "first axle", free, passing, counted & both_speeds,
        together(_first(own), {own.flaw: SOUND}), REQUIREMENTS, 1)  # fmt: skip
    yield Transition(
        "passage spoilt", passing, spoilt, wrong, together(nothing, {own.flaw: flaw}), REQUIREMENTS, 1)  # fmt: skip
    yield Transition("next axle", passing, passing, onward, _next(own, cycle), REQUIREMENTS, 2)
    yield Transition("train has passed", passing, done, cycle.passed, together(ran, found), REQUIREMENTS, 3)
    yield Transition("between axles", passing, passing, TRUE, ran, REQUIREMENTS, 4)
    yield Transition("passage without a record is over", spoilt, done, over, nothing, REQUIREMENTS, 3)
    yield Transition("no train", free, idle, TRUE, together(nothing, {own.flaw: SOUND}), REQUIREMENTS, 4)


def _flaws(own: Parts, cycle: Cycle, counted: Bool, both_speeds: Bool) -> list[tuple[Bool, Lit]]:
    """Return each reason to give no record of this passage; the first that holds is reported."""
    onward = counted & cycle.onward
    long = (own.length_high > own.config.length_limit_mm * UM_PER_MM) | cycle.lost
    agrees = both_speeds & (cycle.measured[0] <= cycle.measured[1])
    full = own.axles_counted + own.axles_in_cycle > own.config.axle_limit
    return [
        (long, TOO_LONG),
        (counted & ~cycle.onward, TURNED),
        (onward & cycle.maybe_another, MAYBE_ANOTHER_TRAIN),
        (onward & ~both_speeds, NO_SPEED),
        (onward & ~agrees, SPEED_CONTRADICTED),
        (onward & full, TOO_MANY),
        (cycle.may_lack_an_axle, HEAD_DAMPED),
    ]


# ------------------------------------------------------------------ groups of updates: all but the flaw


def _nothing(own: Parts) -> Updates:
    """Clear the passage: no train is on the counter."""
    return {
        own.speed_low: 0, own.speed_high: 0, own.run_low: 0, own.run_high: 0, own.length_low: 0, own.length_high: 0,
        own.past_low: 0, own.direction: NO_AXLE, own.axles_counted: 0, own.pause: 0,
    }  # fmt: skip


def _first(own: Parts) -> Updates:
    """Begin the run at this axle, which passed at some time of this cycle."""
    change, period, most = own.config.change_mm_s, own.config.period_ms, own.config.max_speed_mm_s
    low, high = maximum(own.axle_speed_low.value - change, -most), minimum(own.axle_speed_high.value + change, most)
    return {
        own.speed_low: low,
        own.speed_high: high,
        own.run_low: minimum(low * Lit(period, MS), 0),
        own.run_high: maximum(high * Lit(period, MS), 0),
        own.length_low: minimum(low * Lit(period, MS), 0),
        own.length_high: maximum(high * Lit(period, MS), 0),
        own.past_low: minimum(low * Lit(period, MS), 0),
        own.direction: own.axle,
        own.axles_counted: own.axles_in_cycle,
        own.pause: 0,
    }


def _next(own: Parts, cycle: Cycle) -> Updates:
    """Count another axle of the train, which passed at some time of this cycle: the length ends here so far."""
    low, high = cycle.runs
    return {
        own.speed_low: cycle.measured[0],
        own.speed_high: cycle.measured[1],
        own.run_low: low,
        own.run_high: high,
        own.length_low: minimum(own.run_low, low),
        own.length_high: maximum(own.run_high, high),
        own.past_low: minimum(cycle.speeds[0] * Lit(own.config.period_ms, MS), 0),
        own.axles_counted: own.axles_counted + own.axles_in_cycle,
        own.pause: 0,
    }


def _ran(own: Parts, cycle: Cycle) -> Updates:
    """Continue the run: a cycle without an axle."""
    return {
        own.speed_low: cycle.speeds[0],
        own.speed_high: cycle.speeds[1],
        own.run_low: cycle.runs[0],
        own.run_high: cycle.runs[1],
        own.past_low: cycle.past,
        own.pause: cycle.paused,
    }
