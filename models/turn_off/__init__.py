"""Straight on or turning off at a switch, from the lateral motion of a reflector in view (RFL-12; source l. 169, 294).

Before the switch the reflector keeps its place beside the vehicle's axis. Where the vehicle turns off, the image of a
reflector ahead moves to the other side; where it runs straight on, the reflector stays. What is seen is compared with
the course that map and movement authority give.

    IDLE      no switch in view
    BEFORE    a switch lies ahead, within the view zone of the reflector that is measured: its lateral place is noted
    OVER      the vehicle may be on the switch: the lateral place is watched
    DECIDED   straight on, left or right
    UNSEEN    the reflector was not measured long enough: the next reflector's model has to tell
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.expr import (
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
    as_num,
    boolean,
    choice,
    enumeration,
    ite,
    members,
    number,
    optional,
)
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.units import COUNT, MM
from safeloc.models.vocabulary.reflectors import LATERAL_LIMIT_MM

COURSE = members("course", "UNDECIDED", "STRAIGHT", "LEFT", "RIGHT")
UNDECIDED, STRAIGHT, LEFT, RIGHT = COURSE


class TurnOffConfig(Config):
    """How far a reflector's image moves, and how exactly that is measured."""

    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    lateral_error_mm: int = quantity(400, "mm", 0, 10_000, "[D] 3 mrad at 100 m, and 0.1 m of sway and survey")
    sway_mm: int = quantity(200, "mm", 0, 10_000, "[M] of the vehicle on straight track")
    straight_mm: int = quantity(1_000, "mm", 0, 50_000, "[D] sway and twice the lateral error")
    turn_mm: int = quantity(1_500, "mm", 1, 50_000, "[D] above what running straight on can show")
    least_shift_mm: int = quantity(2_500, "mm", 1, 50_000, "[D] turnout 1:9: 6.3 degrees, 2.5 m at 23 m of range")
    decide_mm: int = quantity(30_000, "mm beyond the switch", 0, 200_000, "[M] length of a turnout 1:9")
    give_up_mm: int = quantity(60_000, "mm beyond the switch", 0, 500_000, "[D] twice the turnout")
    miss_limit_cycles: int = quantity(20, "cycles", 1, 10_000, "[D] 2 s over the switch without a measurement")

    @model_validator(mode="after")
    def _can_decide(self) -> TurnOffConfig:
        noise = self.sway_mm + 2 * self.lateral_error_mm
        if self.turn_mm <= noise:
            raise ValueError(f"turn_mm {self.turn_mm} must exceed sway and twice the lateral error, {noise} mm.")
        if self.straight_mm >= self.least_shift_mm - 2 * self.lateral_error_mm:
            raise ValueError(
                "straight_mm must be below least_shift_mm less twice the lateral error, or turns are missed."
            )
        if self.give_up_mm < self.decide_mm:
            raise ValueError("give_up_mm must not be below decide_mm.")
        return self


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine. Lengths in mm.

    measured     the reflector behind the switch was measured in this cycle, at `lateral` (positive to the left)
    low, high    the reported interval of end A
    switch       the map's next facing switch, within the view zone of that reflector
    authorised   the course by map and movement authority
    true         ghost: the course the vehicle takes
    place, shift ghosts: where the reflector lies beside the axis before the switch, and how far its image has moved
    """

    config: TurnOffConfig
    measured: BoolVar
    lateral: NumVar
    low: NumVar
    high: NumVar
    switch: Optional
    authorised: NumVar
    here: NumVar
    noted: NumVar
    course: NumVar
    asked: NumVar
    misses: NumVar
    true: NumVar
    next_true: NumVar
    place: NumVar
    next_place: NumVar
    shift: NumVar

    @property
    def motion(self) -> Num:
        """How far the image has moved since it was noted."""
        return self.lateral - self.noted

    @property
    def announced(self) -> Bool:
        """The map announces another switch; the vehicle is surely before it, and the reflector is measured."""
        return self.switch.present & self.switch.value.ne(self.here) & (self.high < self.switch.value) & self.measured

    @property
    def before(self) -> Bool:
        """The whole interval lies before the switch."""
        return self.high < self.here

    @property
    def through(self) -> Bool:
        """The whole interval lies beyond the turnout: a turn would show."""
        return self.low >= self.here + self.config.decide_mm

    @property
    def given_up(self) -> Bool:
        """The vehicle is far beyond the switch, or the reflector was not measured for too long."""
        far = self.low > self.here + self.config.give_up_mm
        return far | (~self.measured & (self.misses >= self.config.miss_limit_cycles))


@dataclass(frozen=True, eq=False)
class TurnOff:
    """The machine together with its variables, for properties to speak about."""

    machine: Machine
    own: Parts


def machine(config: TurnOffConfig | None = None) -> Machine:
    """The turn-off machine (RFL-12)."""
    return build(parts(config or TurnOffConfig())).machine


def parts(config: TurnOffConfig) -> Parts:
    """Fresh variables for one machine."""
    limit, most, course = config.position_limit_mm, LATERAL_LIMIT_MM, enumeration(COURSE)
    return Parts(
        config=config,
        measured=boolean("reflector_measured"),
        lateral=number("lateral_mm", MM, -most, most),
        low=number("position_low_mm", MM, -limit, limit),
        high=number("position_high_mm", MM, -limit, limit),
        switch=optional("switch_position_mm", MM, -limit, limit),
        authorised=choice("authorised_course", course),
        here=number("switch_here_mm", MM, -limit - 1, limit),
        noted=number("noted_lateral_mm", MM, -most, most),
        course=choice("seen_course", course),
        asked=choice("asked_course", course),
        misses=number("unmeasured_cycles", COUNT, 0, config.miss_limit_cycles),
        true=choice("true_course", course),
        next_true=choice("next_true_course", course),
        place=number("true_lateral_mm", MM, -2 * most, 2 * most),
        next_place=number("next_true_lateral_mm", MM, -2 * most, 2 * most),
        shift=number("true_shift_mm", MM, -4 * most, 4 * most),
    )


def build(own: Parts) -> TurnOff:
    """The machine over the given variables."""
    table = modes("IDLE", "BEFORE", "OVER", "DECIDED", "UNSEEN")
    current = current_mode(table)
    idle, _, over, decided, unseen = table
    announced = current.one_of(idle, decided, unseen) & own.announced
    contradicts = current.eq(decided) & own.asked.ne(UNDECIDED) & own.asked.ne(own.course)
    made = Machine(
        name="turn_off",
        modes=table,
        inputs=[own.measured, own.lateral, own.low, own.high, own.switch, own.authorised],
        state={own.here: own.here.low, own.noted: 0, own.course: UNDECIDED, own.asked: UNDECIDED, own.misses: 0},
        outputs={"course": own.course, "contradicts": contradicts, "watching": current.eq(over)},
        transitions=list(_table(own, table)),
        ghosts={own.true: ANY, own.place: ANY},
        ghost_inputs=[own.next_true, own.next_place, own.shift],
        ghost_moves={
            own.true: ite(announced, own.next_true, own.true),
            own.place: ite(announced, own.next_place, own.place),
        },
        assumption=_lateral_law(own, current, table, announced),
        lemmas=_lemmas(own, current, table),
        definitions={"the image moved by": own.motion, "surely before": own.before, "surely through": own.through},
        mode_variable=current,
        doc=(
            "Straight on or turning off, from the lateral motion of a reflector in view over a switch, against the course "
            "by map and movement authority. Assumed: lateral places are measured within their error; running straight on, "
            "the image moves by no more than the sway; turning off, it moves to the other side, and beyond the turnout by "
            "at least the configured shift; the reported interval holds the true position."
        ),
    )
    return TurnOff(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    idle, before, over, decided, unseen = table
    turn, straight, zero = own.config.turn_mm, own.config.straight_mm, as_num(0, COUNT)
    trace = ("RFL-12",)
    noting: dict[Var, Expr] = {
        own.here: own.switch.value,
        own.noted: own.lateral,
        own.course: UNDECIDED,
        own.asked: own.authorised,
        own.misses: zero,
    }
    missed = ite(own.measured, zero, ite(own.misses >= own.misses.high, own.misses, own.misses + 1))
    watched: dict[Var, Expr] = {own.misses: missed, own.asked: own.authorised}

    def seen(course: Lit) -> dict[Var, Expr]:
        return {own.course: course, own.asked: own.authorised, own.misses: zero}

    yield Transition("switch in view", (idle, decided, unseen), before, own.announced, noting, trace, 0)
    yield Transition(
        "reflector unseen",
        (before, over),
        unseen,
        own.given_up,
        {own.asked: own.authorised, own.misses: zero},
        trace,
        1,
    )
    kept = {**watched, own.noted: ite(own.measured, own.lateral, own.noted)}
    yield Transition("still before", before, before, own.before, kept, trace, 2)
    yield Transition("on the switch", before, over, ~own.before, watched, trace, 2)
    yield Transition("backs off", over, before, own.before, watched, trace, 2)
    yield Transition("turns left", over, decided, own.measured & (own.motion < -turn), seen(LEFT), trace, 3)
    yield Transition("turns right", over, decided, own.measured & (own.motion > turn), seen(RIGHT), trace, 3)
    goes_on = own.measured & own.through & (abs_(own.motion) <= straight)
    yield Transition("runs straight on", over, decided, goes_on, seen(STRAIGHT), trace, 4)
    yield Transition("watch", over, over, set=watched, requirements=trace, rank=5)
    forgotten: dict[Var, Expr] = {own.here: as_num(own.here.low, MM), own.course: UNDECIDED, own.asked: UNDECIDED}
    yield Transition("back before the switch", (decided, unseen), idle, own.before, forgotten, trace, 5)
    yield Transition("keep the course", decided, decided, set={own.asked: own.authorised}, requirements=trace, rank=6)


def _lateral_law(own: Parts, current: Num, table: tuple[Lit, ...], announced: Bool) -> Bool:
    """What the image of a reflector does before, on and beyond a switch."""
    _, before, over, *_ = table
    error, sway, least = own.config.lateral_error_mm, own.config.sway_mm, own.config.least_shift_mm
    watched, beyond = current.one_of(before, over), current.eq(over) & own.through
    off = own.lateral - own.place - own.shift
    return all_of(
        [
            own.next_true.ne(UNDECIDED),
            announced.implies(abs_(own.lateral - own.next_place) <= error),
            (watched & own.measured).implies(abs_(off) <= error),
            own.before.implies(own.shift.eq(0)),
            own.true.eq(STRAIGHT).implies(abs_(own.shift) <= sway),
            own.true.eq(LEFT).implies((own.shift <= sway) & (beyond.implies(own.shift <= -least))),
            own.true.eq(RIGHT).implies((own.shift >= -sway) & (beyond.implies(own.shift >= least))),
        ]
    )


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    idle, before, over, decided, _ = table
    noted = abs_(own.noted - own.place) <= own.config.lateral_error_mm
    return {
        "the noted place is true": current.one_of(before, over).implies(noted & own.true.ne(UNDECIDED)),
        "the decided course is true": current.eq(decided).implies(own.course.eq(own.true)),
        "no course before the decision": current.ne(decided).implies(own.course.eq(UNDECIDED)),
        "a decision has a course": current.eq(decided).implies(own.course.ne(UNDECIDED)),
        "no switch while idle": current.eq(idle).implies(own.here.eq(own.here.low)),
    }
