"""The entry record of a train, from the axles that a counting head tells: count, speed, length, place (FVA-3, FVA-5).

    SPOILT   after power-up, or something is wrong with this passage: no record until it is told that it is over
    IDLE     no train is passing
    PASSING  axles of one train are counted; its run since the first axle is bounded
    DONE     in this cycle the train has passed; the record, or why there is none, is out

The length from first to last axle is the integral of the speed over the occupation, not the speed times the time
(figures, 003 item 6): between axles the speed is bounded by traction and braking ability, and the bounds are summed. A
train has passed when it has surely run farther than two of its axles are ever apart.

The run is reckoned from the first axle in whole um, positive in the direction in which the train came.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    abs_,
    all_of,
    any_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    minimum,
)
from safeloc.language.machine import ANY, Initial, Machine, Model, Transition, current_mode, modes
from safeloc.language.units import COUNT, MM_S, MS, NM, UM
from safeloc.models.axle_counter.passage import (
    HEAD_FAULT,
    LENGTH_UNKNOWN,
    NO_SPEED,
    POWER_UP,
    SOUND,
    SPEED_CONTRADICTED,
    TOO_LONG,
    TOO_MANY,
    TURNED,
    UM_PER_MM,
    UM_S,
    AxleCounterConfig,
    Parts,
    parts,
)
from safeloc.models.axle_head import NO_AXLE

TRACE = ("FVA-3", "FVA-5")


__all__ = ["AxleCounter", "AxleCounterConfig", "build", "machine", "parts"]


AxleCounter = Model[Parts]


def machine(config: AxleCounterConfig | None = None) -> Machine:
    """The machine that makes entry records (FVA-5)."""
    return build(parts(config or AxleCounterConfig())).machine


def build(own: Parts) -> AxleCounter:
    """The machine over the given variables."""
    table = modes("SPOILT", "IDLE", "PASSING", "DONE")
    current = current_mode(table)
    _, idle, _, done = table
    state: dict[Var, Initial] = dict.fromkeys(_bounds(own), 0)
    state |= {own.came: NO_AXLE, own.count: 0, own.flaw: POWER_UP}
    first = current.one_of(idle, done) & own.counted
    made = Machine(
        name="axle_counter",
        modes=table,
        inputs=[own.axle, own.number, own.slow, own.fast, own.fault, own.over],
        state=state,
        outputs=_outputs(own, current.eq(done)),
        transitions=list(_table(own, table)),
        ghosts={own.speed: ANY, own.run: 0, own.length: 0, own.axles: 0},
        ghost_inputs=[own.next_speed, own.axle_speed, own.step, own.axle_step, own.true_axles],
        ghost_moves=_moves(own, first),
        assumption=_assumption(own, first),
        lemmas=_lemmas(own, current, table),
        definitions={
            "speed at least": own.speeds[0], "speed at most": own.speeds[1],
            "run at least": own.runs[0], "run at most": own.runs[1], "train has passed": own.passed,
        },
        mode_variable=current,
        doc=(
            "Entry record of a train from the axles a counting head tells. Assumed: without a fault every axle is told in "
            "its cycle and in its direction, with true bounds of its speed; no train changes its speed faster, or has two "
            "axles farther apart, than configured."
        ),
    )  # fmt: skip
    return Model(made, own)


def _bounds(own: Parts) -> tuple[NumVar, ...]:
    return own.low_speed, own.high_speed, own.run_low, own.run_high, own.length_low, own.length_high, own.past_low


def _outputs(own: Parts, done: Bool) -> dict[str, Expr]:
    """The record, in the cycle in which it is ready; zero otherwise."""
    sound = done & own.flaw.eq(SOUND)

    def told(term: Num) -> Num:
        return ite(sound, term, 0)

    return {
        "record_ready": done,
        "record_sound": sound,
        "record_axles": told(own.count),
        "record_length_low_um": told(own.length_low),
        "record_length_high_um": told(own.length_high),
        "record_speed_low_mm_s": told(own.low_speed),
        "record_speed_high_mm_s": told(own.high_speed),
        "record_run_low_um": told(own.run_low),
        "record_run_high_um": told(own.run_high),
        "record_direction": own.came,
        "record_flaw": own.flaw,
    }


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    spoilt, idle, passing, done = table
    free = (idle, done)
    speeds_told = own.slow.present & own.fast.present & (own.slow.value <= own.fast.value)
    agrees = speeds_told & (own.measured[0] <= own.measured[1])
    heard = own.counted & ~own.fault

    def spoil(name: str, source: Lit | tuple[Lit, ...], when: Bool, flaw: Lit, rank: int) -> Transition:
        return Transition(name, source, spoilt, when, {**_nothing(own), own.flaw: flaw}, TRACE, rank)

    onward = heard & own.onward
    full = own.count + own.number > own.config.axle_limit
    long = (own.length_high > own.config.length_limit_mm * UM_PER_MM) | own.lost
    yield spoil("head at fault", (idle, passing, done), own.fault, HEAD_FAULT, 0)
    yield spoil("first axle without a speed", free, heard & ~speeds_told, NO_SPEED, 1)
    yield Transition("first axle", free, passing, heard & speeds_told, _first(own), TRACE, 1)
    flaws = [
        (long, TOO_LONG),
        (heard & ~own.onward, TURNED),
        (onward & ~speeds_told, NO_SPEED),
        (onward & ~agrees, SPEED_CONTRADICTED),
        (onward & full, TOO_MANY),
    ]
    flaw: Num = SOUND
    for wrong, why in reversed(flaws):
        flaw = ite(wrong, why, flaw)
    spoiling = {**_nothing(own), own.flaw: flaw}
    yield Transition("passage spoilt", passing, spoilt, any_of(wrong for wrong, _ in flaws), spoiling, TRACE, 1)
    yield Transition("next axle", passing, passing, onward, _next(own), TRACE, 2)
    sound = {**_ran(own), own.flaw: ite(own.length_known, SOUND, LENGTH_UNKNOWN)}
    yield Transition("train has passed", passing, done, own.passed, sound, TRACE, 3)
    yield Transition("between axles", passing, passing, TRUE, _ran(own), TRACE, 4)
    over = own.over & ~own.counted & ~own.fault
    yield Transition("passage without a record is over", spoilt, done, over, _nothing(own), TRACE, 3)
    yield Transition("no train", free, idle, TRUE, {**_nothing(own), own.flaw: SOUND}, TRACE, 4)


def _nothing(own: Parts) -> dict[Var, Expr]:
    """Nobody passes."""
    speed, um = as_num(0, MM_S), as_num(0, UM)
    return {
        **dict.fromkeys((own.low_speed, own.high_speed), speed),
        **dict.fromkeys((own.run_low, own.run_high, own.length_low, own.length_high, own.past_low), um),
        own.came: NO_AXLE,
        own.count: as_num(0, COUNT),
    }


def _first(own: Parts) -> dict[Var, Expr]:
    """The run begins with this axle, at some time of this cycle."""
    change, period, most = own.config.change_mm_s, own.config.period_ms, own.config.max_speed_mm_s
    low, high = maximum(own.slow.value - change, -most), minimum(own.fast.value + change, most)
    return {
        **_nothing(own),
        own.came: own.axle,
        own.count: own.number,
        own.length_low: minimum(low * Lit(period, MS), 0),
        own.length_high: maximum(high * Lit(period, MS), 0),
        own.low_speed: low,
        own.high_speed: high,
        own.run_low: minimum(low * Lit(period, MS), 0),
        own.run_high: maximum(high * Lit(period, MS), 0),
        own.past_low: minimum(low * Lit(period, MS), 0),
        own.flaw: SOUND,
    }


def _next(own: Parts) -> dict[Var, Expr]:
    """Another axle of the train, at some time of this cycle: the length ends here so far."""
    low, high = own.runs
    return {
        own.count: own.count + own.number,
        own.low_speed: own.measured[0],
        own.high_speed: own.measured[1],
        own.run_low: low,
        own.run_high: high,
        own.length_low: minimum(own.run_low, low),
        own.length_high: maximum(own.run_high, high),
        own.past_low: minimum(own.speeds[0] * Lit(own.config.period_ms, MS), 0),
    }


def _ran(own: Parts) -> dict[Var, Expr]:
    """A cycle without an axle."""
    return {
        own.low_speed: own.speeds[0],
        own.high_speed: own.speeds[1],
        own.run_low: own.runs[0],
        own.run_high: own.runs[1],
        own.past_low: own.past,
    }


# ------------------------------------------------------------------ the environment, and what helps to prove


def _run_after(own: Parts, first: Bool) -> tuple[Num, Num]:
    """Ghosts: a new train's run begins at its first axle; the length is the run at the last axle."""
    run = ite(first, own.step, own.run + own.step)
    return run, ite(first, own.axle_step, ite(own.true_axles > 0, own.run + own.axle_step, own.length))


def _moves(own: Parts, first: Bool) -> dict[Var, Expr]:
    run, length = _run_after(own, first)
    return {
        own.speed: own.next_speed,
        own.run: run,
        own.length: length,
        own.axles: ite(first, own.true_axles, minimum(own.axles + own.true_axles, own.axles.high)),
    }


def _assumption(own: Parts, first: Bool) -> Bool:
    """Heads without a fault tell every axle and its speed truly; trains keep to their traction and brakes, and can stop."""
    change = Lit(own.config.change_mm_s * UM_PER_MM, UM_S)
    low, high = own.speed - change, own.speed + change
    told = own.slow.present & own.fast.present
    axle = ite(first, abs_(own.next_speed - own.axle_speed) <= change, between(low, own.axle_speed, high))
    near = abs_(own.next_speed - own.axle_speed) <= change
    run, length = _run_after(own, first)
    return all_of(
        [
            between(own.run.low, run, own.run.high) & between(own.length.low, length, own.length.high),
            _can_stop(own, run),
            (~own.fault).implies(own.true_axles.eq(ite(own.counted, own.number, 0))),
            (own.counted & ~own.fault & told).implies(_speed_is_true(own, first) & axle & near),
            first | between(low, own.next_speed, high),
            ite(first, _since_first(own, change), _since_before(own, low, high)),
        ]
    )


def _can_stop(own: Parts, run: Num) -> Bool:
    """The train can come to a stop before the coordinates end; without it its run would have to end with them."""
    config = own.config
    stopping_ms = -(-(config.max_speed_mm_s + config.change_mm_s) * config.period_ms // config.change_mm_s)
    return between(own.run.low, run + own.next_speed * Lit(stopping_ms, MS), own.run.high)


def _speed_is_true(own: Parts, first: Bool) -> Bool:
    """Told speeds have no sign: an axle against the train's direction has run back. In which one it came may be unknown."""
    slow, fast = exact_to(own.slow.value, UM_S), exact_to(own.fast.value, UM_S)
    on, back = between(slow, own.axle_speed, fast), between(-fast, own.axle_speed, -slow)
    return ite(first | own.onward, on, back | (own.came.eq(NO_AXLE) & on))


def _since_first(own: Parts, change: Num) -> Bool:
    """The run in what is left of the cycle after the first axle, up to the last one in it, and after that."""
    most = Lit(own.config.max_speed_mm_s * UM_PER_MM, UM_S)
    low, high = _nm(own, maximum(own.axle_speed - change, -most)), _nm(own, minimum(own.axle_speed + change, most))
    return _within_cycle((own.step, own.axle_step, own.step - own.axle_step), low, high)


def _since_before(own: Parts, low: Num, high: Num) -> Bool:
    """The run in the cycle, at the speeds of the cycle; up to the last axle within it, and after that."""
    most = Lit(own.config.max_speed_mm_s * UM_PER_MM, UM_S)
    slowest, fastest = _nm(own, maximum(low, -most)), _nm(own, minimum(high, most))
    whole = between(slowest, own.step, fastest)
    return whole & _within_cycle((own.axle_step, own.step - own.axle_step), slowest, fastest)


def _within_cycle(runs: tuple[Num, ...], low: Num, high: Num) -> Bool:
    """Runs in a part of a cycle, of which the whole would give between `low` and `high`."""
    return all_of(between(minimum(low, 0), run, maximum(high, 0)) for run in runs)


def _nm(own: Parts, speed: Num) -> Num:
    """The run of a whole cycle at a speed."""
    return speed * Lit(own.config.period_ms, MS)


def _lemmas(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    followed = current.eq(table[2]) | (current.eq(table[3]) & own.flaw.eq(SOUND))
    run = between(exact_to(own.run_low, NM), own.run, exact_to(own.run_high, NM))
    length = between(exact_to(own.length_low, NM), own.length, exact_to(own.length_high, NM))
    speed = between(exact_to(own.low_speed, UM_S), own.speed, exact_to(own.high_speed, UM_S))
    return {
        "the run is within its bounds": followed.implies(run),
        "the length is within its bounds": followed.implies(length),
        "the speed is within its bounds": followed.implies(speed),
        "the run since the last axle is within its bound": followed.implies(
            own.run - own.length >= exact_to(own.past_low, NM)
        ),
        "the count is true": followed.implies(own.count.eq(own.axles)),
        "a spoilt passage has a flaw": current.eq(table[0]).implies(own.flaw.ne(SOUND)),
        "a train has a direction": current.eq(table[2]).implies(own.came.ne(NO_AXLE) & (own.count > 0)),
    }
