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
from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    abs_,
    all_of,
    any_of,
    as_num,
    between,
    boolean,
    choice,
    enumeration,
    exact_to,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
)
from safeloc.machine import ANY, Initial, Machine, Transition, current_mode, modes
from safeloc.models.axle_head import AXLE, NO_AXLE
from safeloc.units import COUNT, MM_S, MS, NM, UM, Unit

UM_S = Unit("um/s", length=1, time=-1, scale=UM.scale)
FLAW = members(
    "flaw",
    "NONE",
    "POWER_UP",
    "HEAD_FAULT",
    "NO_SPEED",
    "SPEED_CONTRADICTED",
    "TURNED",
    "TOO_MANY",
    "TOO_LONG",
    "LENGTH_UNKNOWN",
)
SOUND, POWER_UP, HEAD_FAULT, NO_SPEED, SPEED_CONTRADICTED, TURNED, TOO_MANY, TOO_LONG, LENGTH_UNKNOWN = FLAW
TRACE = ("FVA-3", "FVA-5")
UM_PER_MM = 1_000
MS_PER_S = 1_000


class AxleCounterConfig(Config):
    """What the record rests on."""

    period_ms: int = quantity(100, "ms", 1, 1_000, "[S] EVC cycles <= 100 ms; several axles may pass in one")
    max_speed_mm_s: int = quantity(100_000, "mm/s", 1, 138_889, "[M, sure] 350 km/h")
    change_mm_s2: int = quantity(1_500, "mm/s2", 1, 5_000, "[M, fairly sure] traction and brake, figures section 2")
    axles_a_cycle: int = quantity(10, "axles", 1, 400, "[D] 1.8 m apart at 350 km/h in 100 ms: 6, with room")
    axle_gap_mm: int = quantity(20_000, "mm", 1_000, 50_000, "[M] longest distance between two axles of a train")
    axle_limit: int = quantity(1_000, "axles", 2, 100_000, "[D] trains of 250 wagons")
    length_limit_mm: int = quantity(1_500_000, "mm", 10_000, 10_000_000, "[M] longest train")
    length_spread_mm: int = quantity(20_000, "mm", 1, 1_000_000, "[D] wider bounds give no length")

    @property
    def change_mm_s(self) -> int:
        """Greatest change of speed in one cycle, rounded up."""
        return -(-self.change_mm_s2 * self.period_ms // MS_PER_S)

    @property
    def run_limit_um(self) -> int:
        """Farthest a passage is followed."""
        step = self.max_speed_mm_s * self.period_ms
        return (self.length_limit_mm + self.axle_gap_mm) * UM_PER_MM + step


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    axle, number     axles were counted in this cycle, all in one direction, and how many
    slow, fast       bounds of the speeds of all of them
    fault             the head is disturbed or its two channels disagree
    over              no train is on the counter: told by the counters around, or by the operator
    low_speed, high_speed    bounds of the speed now
    run_low, run_high        bounds of the run since the first axle
    length_low, length_high  bounds of the run up to the last axle
    speed, run, length, axles  ghosts: the train's speed, its run since the first axle, up to its last axle; its axles so far
    """

    config: AxleCounterConfig
    axle: NumVar
    number: NumVar
    slow: Optional
    fast: Optional
    fault: BoolVar
    over: BoolVar
    came: NumVar
    count: NumVar
    low_speed: NumVar
    high_speed: NumVar
    run_low: NumVar
    run_high: NumVar
    length_low: NumVar
    length_high: NumVar
    flaw: NumVar
    speed: NumVar
    next_speed: NumVar
    axle_speed: NumVar
    step: NumVar
    axle_step: NumVar
    true_axles: NumVar
    run: NumVar
    length: NumVar
    axles: NumVar

    @property
    def counted(self) -> Bool:
        """An axle was counted."""
        return self.axle.ne(NO_AXLE)

    @property
    def onward(self) -> Bool:
        """The axle came in the direction of the first one."""
        return self.axle.eq(self.came)

    @property
    def speeds(self) -> tuple[Num, Num]:
        """Bounds of the speed at any time of this cycle, from those before it."""
        change, most = self.config.change_mm_s, self.config.max_speed_mm_s
        return maximum(self.low_speed - change, -most), minimum(self.high_speed + change, most)

    @property
    def runs(self) -> tuple[Num, Num]:
        """Bounds of the run after this cycle."""
        low, high = self.speeds
        period = self.config.period_ms
        after_low, after_high = self.run_low + low * Lit(period, MS), self.run_high + high * Lit(period, MS)
        return after_low, after_high

    @property
    def measured(self) -> tuple[Num, Num]:
        """Bounds of the speed after a cycle with axles."""
        low, high = self.speeds
        change = self.config.change_mm_s
        return maximum(low, self.slow.value - change), minimum(high, self.fast.value + change)

    @property
    def passed(self) -> Bool:
        """The train has surely run farther since its last axle than two axles are apart."""
        return self.runs[0] > self.length_high + Lit(self.config.axle_gap_mm * UM_PER_MM, UM)

    @property
    def lost(self) -> Bool:
        """The train may be farther than a passage is followed."""
        most = self.config.run_limit_um
        return any_of(~between(-most, run, most) for run in self.runs)

    @property
    def length_known(self) -> Bool:
        """The bounds of the length are close enough."""
        return self.length_high - self.length_low <= self.config.length_spread_mm * UM_PER_MM


def parts(config: AxleCounterConfig) -> Parts:
    """Fresh variables for one counter."""
    most, far, axles = config.max_speed_mm_s, config.run_limit_um, config.axle_limit
    step = 2 * most * config.period_ms * UM_PER_MM
    return Parts(
        config,
        choice("axle", enumeration(AXLE)),
        number("axles_in_cycle", COUNT, 1, config.axles_a_cycle),
        optional("axle_speed_low_mm_s", MM_S, 0, most),
        optional("axle_speed_high_mm_s", MM_S, 0, most),
        boolean("head_fault"),
        boolean("passage_over"),
        choice("direction", enumeration(AXLE)),
        number("axles_counted", COUNT, 0, axles),
        number("speed_low_mm_s", MM_S, -most, most),
        number("speed_high_mm_s", MM_S, -most, most),
        number("run_low_um", UM, -far, far),
        number("run_high_um", UM, -far, far),
        number("length_low_um", UM, -far, far),
        number("length_high_um", UM, -far, far),
        choice("flaw", enumeration(FLAW)),
        number("true_speed_um_s", UM_S, -most * UM_PER_MM, most * UM_PER_MM),
        number("next_true_speed_um_s", UM_S, -most * UM_PER_MM, most * UM_PER_MM),
        number("axle_true_speed_um_s", UM_S, 0, most * UM_PER_MM),
        number("true_step_nm", NM, -step, step),
        number("true_step_to_axle_nm", NM, -step, step),
        number("true_axles_in_cycle", COUNT, 0, config.axles_a_cycle),
        number("true_run_nm", NM, -(10**15), 10**15),
        number("true_length_nm", NM, -(10**15), 10**15),
        number("true_axles", COUNT, 0, 2**31),
    )


@dataclass(frozen=True, eq=False)
class AxleCounter:
    """The machine together with its variables, for properties to speak about."""

    machine: Machine
    own: Parts


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
    return AxleCounter(made, own)


def _bounds(own: Parts) -> tuple[NumVar, ...]:
    return own.low_speed, own.high_speed, own.run_low, own.run_high, own.length_low, own.length_high


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
        **dict.fromkeys((own.run_low, own.run_high, own.length_low, own.length_high), um),
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
    }


def _ran(own: Parts) -> dict[Var, Expr]:
    """A cycle without an axle."""
    return {
        own.low_speed: own.speeds[0],
        own.high_speed: own.speeds[1],
        own.run_low: own.runs[0],
        own.run_high: own.runs[1],
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
    """Heads without a fault tell every axle and its speed truly; trains keep to their traction and brakes."""
    change = Lit(own.config.change_mm_s * UM_PER_MM, UM_S)
    low, high = own.speed - change, own.speed + change
    truly = between(exact_to(own.slow.value, UM_S), own.axle_speed, exact_to(own.fast.value, UM_S))
    told = own.slow.present & own.fast.present
    axle = ite(first, abs_(own.next_speed - own.axle_speed) <= change, between(low, own.axle_speed, high))
    near = abs_(own.next_speed - own.axle_speed) <= change
    run, length = _run_after(own, first)
    return all_of(
        [
            between(own.run.low, run, own.run.high) & between(own.length.low, length, own.length.high),
            (~own.fault).implies(own.true_axles.eq(ite(own.counted, own.number, 0))),
            (own.counted & ~own.fault & told).implies(truly & axle & near),
            first | between(low, own.next_speed, high),
            ite(first, _since_first(own, change), _since_before(own, low, high)),
        ]
    )


def _since_first(own: Parts, change: Num) -> Bool:
    """The run in what is left of the cycle after the first axle."""
    most = Lit(own.config.max_speed_mm_s * UM_PER_MM, UM_S)
    low, high = _nm(own, maximum(own.axle_speed - change, -most)), _nm(own, minimum(own.axle_speed + change, most))
    return between(minimum(low, 0), own.step, maximum(high, 0)) & between(
        minimum(low, 0), own.axle_step, maximum(high, 0)
    )


def _since_before(own: Parts, low: Num, high: Num) -> Bool:
    """The run in the cycle, and up to an axle within it, at the speeds of the cycle."""
    most = Lit(own.config.max_speed_mm_s * UM_PER_MM, UM_S)
    slowest, fastest = _nm(own, maximum(low, -most)), _nm(own, minimum(high, most))
    whole = between(slowest, own.step, fastest)
    return whole & between(minimum(slowest, 0), own.axle_step, maximum(fastest, 0))


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
        "the count is true": followed.implies(own.count.eq(own.axles)),
        "a spoilt passage has a flaw": current.eq(table[0]).implies(own.flaw.ne(SOUND)),
        "a train has a direction": current.eq(table[2]).implies(own.came.ne(NO_AXLE) & (own.count > 0)),
    }
