"""The world of an entry record: a train that passes a counting head, upwards or downwards.

Speed and run are counted upwards along the line, in whatever direction the train came. A passage is a series of axles with no
two neighbours farther apart than the longest distance between two axles of a train: if the last axle is farther behind, the
next one begins another passage, of another train or of the same one coming back.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, abs_, all_of, between, exact_to, ite, maximum, minimum
from safeloc.language.units import MS, NM, UM_S
from safeloc.language.world import Law, World
from safeloc.models.axle_counter.passage import AxleCounterConfig, Parts
from safeloc.models.axle_head import NO_AXLE
from safeloc.models.vocabulary.head_contract import (
    counts_every_axle,
    counts_every_axle_or_stays_damped,
    misses_an_axle,
)

_ABILITY = ("change_mm_s2", "max_speed_mm_s", "period_ms")


def world(own: Parts) -> World:
    """Return the world of the train on the counter: speed, run since its first axle, length and axles so far, and its distance.

    Beside the train it is told whether a damped head has left one of its axles uncounted.
    A train that stands on the counter when the machine starts begins with the first axle that passes after that.
    """
    run, length = _run_after(own)
    axles = ite(_first(own), own.true_axles_in_cycle, minimum(own.axles + own.true_axles_in_cycle, own.axles.high))
    passes = own.true_axles_in_cycle > 0
    return own.declared.world(
        moves={
            own.speed: own.next_true_speed,
            own.run: run,
            own.length: length,
            own.axles: axles,
            own.away: _away_after(own),
            own.last_axle_upwards: ite(passes, own.axle_true_speed > 0, own.last_axle_upwards),
            own.true_pause: ite(passes, 0, minimum(own.true_pause + 1, own.true_pause.high)),
            own.missed: misses_an_axle(_counts(own), fault=own.fault, damped=own.damped, missed=own.missed),
        },
        clauses={**_head_laws(own), **_train_laws(own)},
    )


# ------------------------------------------------------------------ laws


def _head_laws(own: Parts) -> dict[str, Bool | Law]:
    measured = own.axle.ne(NO_AXLE) & own.axle_speed_low.present & own.axle_speed_high.present
    slow, fast = exact_to(own.axle_speed_low.value, UM_S), exact_to(own.axle_speed_high.value, UM_S)
    return {
        "a head without a fault counts every axle": Law(
            counts_every_axle_or_stays_damped(_counts(own), fault=own.fault, damped=own.damped, missed=own.missed),
            "As long as the head is not at fault, it reports every axle once, in its cycle and with its direction; or one of its channels "
            "stays damped under an axle, and the head is damped at the end of that cycle and of each one until it is at fault.",
            source="[S] DP 1 728 700: overlapping pulses; proved of the counting head through a cycle (counting_head), tried of channels "
            "that stay damped",
            owner="supplier",
            check="counts of neighbouring counters and of the fibre compared",
        ),
        "a head without a fault measures the axle's speed": Law(
            (measured & ~own.fault).implies(between(slow, abs_(own.axle_true_speed), fast)),
            "Where both bounds of an axle's speed are reported, the axle's speed lies between them, whatever its direction.",
            source="[D] spacing of the channels and time of a sample",
            owner="supplier",
            check="speeds of consecutive axles; the train's own speed",
        ),
        "a passage is reported as over only when it is": Law(
            (own.over & own.true_axles_in_cycle.eq(0)).implies(_away_after(own)),
            "The input that the counter is clear is true only if the next axle belongs to another passage.",
            figures=("axle_gap_mm",),
            source="[D] the counters around, or the operator's eyes",
            owner="operator",
            check="the rule book",
        ),
    }


def _train_laws(own: Parts) -> dict[str, Bool | Law]:
    low, high = own.speed - _change(own), own.speed + _change(own)
    at_axle = ite(
        _first(own),
        abs_(own.next_true_speed - own.axle_true_speed) <= _change(own),
        between(low, own.axle_true_speed, high),
    )
    near = abs_(own.next_true_speed - own.axle_true_speed) <= _change(own)
    changes = (_first(own) | between(low, own.next_true_speed, high)) & (own.true_axles_in_cycle > 0).implies(
        at_axle & near
    )
    return {
        "speed changes within traction and brake": Law(
            changes,
            "In one cycle a train changes its speed by no more than its traction or its brakes can.",
            figures=("change_mm_s2", "period_ms"),
            source="[M, fairly sure] traction and brake",
            owner="operator",
            check="vehicle approval",
        ),
        "the way follows from the speed": Law(
            ite(_first(own), _since_first(own), _since_before(own, low, high)),
            "The run in a part of a cycle lies between those at the least and at the greatest speed of that cycle.",
            figures=_ABILITY,
            source="[D] kinematics",
            owner="operator",
            check="none needed",
        ),
        "trains follow each other at the headway": Law(
            (_first(own) & own.last_axle_upwards.iff(own.axle_true_speed > 0)).implies(_headway_over(own)),
            "Between the last axle of a passage and the first one of the next in the same direction, at least "
            "the headway passes.",
            figures=("headway_ms",),
            source="[M, fairly sure] signalling headway, a minute or more",
            owner="operator",
            check="timetable; block length",
        ),
        **_line_laws(own),
    }


def _line_laws(own: Parts) -> dict[str, Bool | Law]:
    """Return the laws that keep the coordinates finite."""
    run, length = _run_after(own)
    return {
        "the train stays on the line": Law(
            between(own.run.low, run, own.run.high) & between(own.length.low, length, own.length.high),
            "No train runs farther than a thousand kilometres over one counter.",
            source="[D]",
            owner="infrastructure",
            check="none needed",
        ),
        "the train can stop": Law(
            _can_stop(own, run),
            "A train can come to a stop before the coordinates end.",
            figures=_ABILITY,
            source="[D] without it the run would have to end with the coordinates",
            owner="operator",
            check="none needed",
        ),
    }


# ------------------------------------------------------------------ terms of the world


def _counts(own: Parts) -> Bool:
    """Return whether the cycle, if the head is not at fault, is reported as it was."""
    return counts_every_axle(
        fault=own.fault,
        axle=own.axle,
        number=own.axles_in_cycle,
        passed=own.true_axles_in_cycle,
        upwards=own.axle_true_speed > 0,
        downwards=own.axle_true_speed < 0,
    )


def _change(own: Parts) -> Num:
    """Return the greatest change of speed in a cycle, um/s: mm/s2 times ms."""
    return Lit(own.config.change_mm_s2 * own.config.period_ms, UM_S)


def _most(config: AxleCounterConfig) -> Num:
    return Lit(config.max_speed_mm_s * 1_000, UM_S)


def _gap_nm(own: Parts) -> int:
    return own.config.axle_gap_mm * 1_000_000


def _first(own: Parts) -> Bool:
    """Return the condition that the first axle of a passage passes in this cycle."""
    return own.away & (own.true_axles_in_cycle > 0)


def _run_after(own: Parts) -> tuple[Num, Num]:
    """Return run and length after the cycle: the run begins at the first axle of a passage; the length is the run at the last axle."""
    run = ite(_first(own), own.true_cycle_distance, own.run + own.true_cycle_distance)
    length = ite(
        _first(own),
        own.true_distance_to_axle,
        ite(own.true_axles_in_cycle > 0, own.run + own.true_distance_to_axle, own.length),
    )
    return run, length


def _away_after(own: Parts) -> Bool:
    """Return the condition that the next axle belongs to another passage: the last one is too far behind."""
    run, length = _run_after(own)
    return (own.away & own.true_axles_in_cycle.eq(0)) | (abs_(run - length) > _gap_nm(own))


def _headway_over(own: Parts) -> Bool:
    """Return the condition that the headway is over; the two axles may lie at the edges of their cycles: two periods more."""
    config = own.config
    return own.true_pause * config.period_ms > config.headway_ms - 2 * config.period_ms


def _can_stop(own: Parts, run: Num) -> Bool:
    config = own.config
    fastest, slower = config.max_speed_mm_s * 1_000, config.change_mm_s2 * config.period_ms
    stopping_ms = (fastest // slower + 2) * config.period_ms
    return between(own.run.low, run + own.next_true_speed * Lit(stopping_ms, MS), own.run.high)


def _since_first(own: Parts) -> Bool:
    """Return the bounds for the rest of the cycle after the first axle: up to the last axle in it, and after that."""
    low, high = own.axle_true_speed - _change(own), own.axle_true_speed + _change(own)
    return _within_cycle(
        own,
        (own.true_cycle_distance, own.true_distance_to_axle, own.true_cycle_distance - own.true_distance_to_axle),
        low,
        high,
    )


def _since_before(own: Parts, low: Num, high: Num) -> Bool:
    """Return the bounds for the whole cycle, up to the last axle within it, and after that."""
    slowest, fastest = _ways(own, low, high)
    over_cycle = between(slowest, own.true_cycle_distance, fastest)
    return over_cycle & _within_cycle(
        own, (own.true_distance_to_axle, own.true_cycle_distance - own.true_distance_to_axle), low, high
    )


def _within_cycle(own: Parts, runs: tuple[Num, ...], low: Num, high: Num) -> Bool:
    """Return bounds for runs in parts of a cycle."""
    slowest, fastest = _ways(own, low, high)
    return all_of(between(minimum(slowest, 0), run, maximum(fastest, 0)) for run in runs)


def _ways(own: Parts, low: Num, high: Num) -> tuple[Num, Num]:
    """Return the runs of a whole cycle at the least and at the greatest speed."""
    period, most = Lit(own.config.period_ms, MS), _most(own.config)
    return exact_to(maximum(low, -most) * period, NM), exact_to(minimum(high, most) * period, NM)
