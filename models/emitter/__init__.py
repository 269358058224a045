"""Function check of the fibre chain by an acoustic emitter beside the track (FVA-8, FVA-17).

The emitter sends its own bit pattern, from a known place, every so often and whenever it is asked to. As long as the
pattern comes back through pulse, fibre, detector and evaluation when it is due, the chain works.

    UNTESTED  no own pattern was heard yet, or not often enough after a failure
    TESTED    the last pattern came when it was due, and the next one is not overdue
    FAILED    a pattern that was due did not come, or the own pattern came from another place

Only the own pattern, from its own place, when it is due, counts. A foreign pattern changes nothing and is told.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.expr import (
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
    any_of,
    as_num,
    boolean,
    choice,
    enumeration,
    ite,
    members,
    number,
    optional,
)
from safeloc.language.machine import Initial, Machine, Model, Transition, current_mode, modes
from safeloc.language.units import COUNT, MM

HEARD = members("pattern_verdict", "NOTHING", "PASSED", "FOREIGN", "NOT_DUE", "ELSEWHERE", "NO_PLACE")
NOTHING, PASSED, FOREIGN, NOT_DUE, ELSEWHERE, NO_PLACE = HEARD
MOST_BITS = 62
TRACE = ("FVA-8", "FVA-17")


class EmitterConfig(Config):
    """One emitter: its pattern, its place, and when it is to be heard."""

    pattern: int = quantity(0b1011_0010_1110_0011, "bits", 1, 2**MOST_BITS - 1, "[M] its own among all of the line")
    place_mm: int = quantity(1_000_000, "mm", -1_000_000_000, 1_000_000_000, "[D] where it stands")
    place_tolerance_mm: int = quantity(30_000, "mm", 0, 1_000_000, "[D] the front end names an emitter within 30 m")
    due_cycles: int = quantity(20, "cycles", 2, 1_000_000, "[M] every 10 s at 500 ms")
    window_cycles: int = quantity(4, "cycles", 1, 1_000_000, "[M] 2 s: jitter, and length of the pattern")
    answer_cycles: int = quantity(6, "cycles", 1, 1_000_000, "[M] 3 s from request to recognition")
    passes_to_recover: int = quantity(2, "patterns", 1, 100, "[M] one may be an accident")

    @model_validator(mode="after")
    def _in_time(self) -> EmitterConfig:
        if self.window_cycles >= self.due_cycles or self.answer_cycles >= self.due_cycles:
            raise ValueError(
                f"window_cycles ({self.window_cycles}) and answer_cycles ({self.answer_cycles}) lie below due_cycles "
                f"({self.due_cycles}); a pattern that counts at any time tests nothing."
            )
        return self


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    pattern, place  what was recognised in this cycle, and where along the track
    requested       the emitter was asked for its pattern in this cycle
    since           cycles since the last pattern that counted
    asked           cycles since an open request, 0: none is open
    passes          patterns that counted since the failure
    works           ghost: the whole chain works
    """

    config: EmitterConfig
    pattern: Optional
    place: Optional
    requested: BoolVar
    since: NumVar
    asked: NumVar
    passes: NumVar
    judged: NumVar
    works: BoolVar
    next_works: BoolVar

    @property
    def due(self) -> Bool:
        """A pattern may come now: its regular time, or a request is open."""
        return (self.since + 1 >= self.config.due_cycles - self.config.window_cycles) | (self.asked > 0)

    @property
    def overdue(self) -> Bool:
        """The regular pattern, or the answer to a request, is too late in this cycle."""
        return (self.since >= self.config.due_cycles) | (self.asked >= self.config.answer_cycles)

    @property
    def verdict(self) -> Num:
        """What becomes of what was heard."""
        near = abs_(self.place.value - self.config.place_mm) <= self.config.place_tolerance_mm
        own = ite(self.due, PASSED, NOT_DUE)
        own = ite(self.place.present, ite(near, own, ELSEWHERE), NO_PLACE)
        verdict = ite(self.pattern.value.eq(self.config.pattern), own, FOREIGN)
        return ite(self.pattern.present, verdict, NOTHING)


def parts(config: EmitterConfig) -> Parts:
    """Fresh variables for one emitter."""
    far = 2_000_000_000
    return Parts(
        config,
        optional("heard_pattern", COUNT, 0, 2**MOST_BITS - 1),
        optional("heard_place_mm", MM, -far, far),
        boolean("test_requested"),
        number("since_passed_cycles", COUNT, 0, config.due_cycles),
        number("since_request_cycles", COUNT, 0, config.answer_cycles),
        number("passes", COUNT, 0, config.passes_to_recover),
        choice("judged", enumeration(HEARD)),
        boolean("chain_works"),
        boolean("next_chain_works"),
    )


Emitter = Model[Parts]


def machine(config: EmitterConfig | None = None) -> Machine:
    """The machine of one test emitter (FVA-8)."""
    return build(parts(config or EmitterConfig())).machine


def build(own: Parts) -> Emitter:
    """The machine over the given variables."""
    table = modes("UNTESTED", "TESTED", "FAILED")
    current = current_mode(table)
    tested = current.eq(table[1])
    state: dict[Var, Initial] = {own.since: 0, own.asked: 0, own.passes: 0, own.judged: NOTHING}
    passed = own.verdict.eq(PASSED)
    made = Machine(
        name="emitter",
        modes=table,
        inputs=[own.pattern, own.place, own.requested],
        state=state,
        outputs={
            "chain_tested": tested,
            "failed": current.eq(table[2]),
            "heard": own.judged,
            "foreign_heard": own.judged.eq(FOREIGN),
            "next_due_in_cycles": own.config.due_cycles - own.since,
        },
        transitions=list(_table(own, table)),
        ghosts={own.works: True},
        ghost_inputs=[own.next_works],
        ghost_moves={own.works: own.next_works},
        assumption=passed.implies(own.next_works),
        definitions={"pattern judged": own.verdict, "a pattern may come": own.due, "overdue": own.overdue},
        mode_variable=current,
        doc=(
            "Function check of the fibre chain by an emitter with a bit pattern of its own. Assumed: nothing else makes "
            "this pattern at this place when it is due, so that hearing it shows that the chain works."
        ),
    )
    return Model(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    untested, tested, failed = table
    zero, heard = as_num(0, COUNT), own.verdict
    waited = ite(own.since >= own.config.due_cycles, own.since, own.since + 1)
    open_request = any_of([own.asked > 0, own.requested])
    asked = ite(open_request & (own.asked < own.config.answer_cycles), own.asked + 1, zero)
    waiting: dict[Var, Expr] = {own.since: waited, own.asked: asked, own.judged: heard}
    gone: dict[Var, Expr] = {**waiting, own.passes: zero, own.asked: zero}
    passed: dict[Var, Expr] = {own.since: zero, own.asked: zero, own.judged: heard, own.passes: zero}
    counted: dict[Var, Expr] = {**passed, own.passes: own.passes + 1}
    recovering: dict[Var, Expr] = {**waiting, own.passes: ite(own.since >= own.config.due_cycles, zero, own.passes)}
    enough = own.passes + 1 >= own.config.passes_to_recover
    hears, elsewhere = heard.eq(PASSED), heard.eq(ELSEWHERE)
    yield Transition("own pattern from elsewhere", table, failed, elsewhere, gone, TRACE, 0)
    yield Transition("pattern passes", tested, tested, hears & ~own.overdue, passed, TRACE, 1)
    yield Transition("pattern does not come", (untested, tested), failed, own.overdue, gone, TRACE, 2)
    yield Transition("first pattern passes", untested, tested, hears, passed, TRACE, 3)
    if own.config.passes_to_recover > 1:
        yield Transition("one more pattern passes", failed, failed, hears & ~enough, counted, TRACE, 3)
    yield Transition("enough patterns pass", failed, tested, hears & enough, passed, TRACE, 4)
    yield Transition("wait for the first pattern", untested, untested, TRUE, waiting, TRACE, 5)
    yield Transition("wait for the next pattern", tested, tested, TRUE, waiting, TRACE, 5)
    yield Transition("wait for a pattern after the failure", failed, failed, TRUE, recovering, TRACE, 5)
