"""Clear or occupied by axles counted in and out at both ends of a section, with its reset procedure (FVA-4, FVA-5).

    UNKNOWN    after power-up: occupied until reset and swept
    CLEAR      every axle that was counted in was counted out
    OCCUPIED   axles are counted in, or a wheel stands on a head
    DISTURBED  a count cannot be right, or a counting head is at fault: occupied until reset and swept
    SWEEPING   reset: occupied until a train ran through on sight, was counted in and out, and found the section free

Only CLEAR is clear. A reset is refused while a head is damped or at fault, while axles are counted in, and for a while
after the last axle (Frauscher FAdC manual p. 33); what it leads to is never CLEAR.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    boolean,
    choice,
    enumeration,
    ite,
    members,
    number,
)
from safeloc.language.machine import ANY, Initial, Machine, Model, Transition, current_mode, modes
from safeloc.language.units import COUNT

RESET = members("reset_answer", "NOT_ASKED", "ACCEPTED", "HEAD_DAMPED", "HEAD_FAULT", "AXLES_COUNTED", "AXLE_PASSED")
NOT_ASKED, ACCEPTED, HEAD_DAMPED, HEAD_FAULT, AXLES_COUNTED, AXLE_PASSED = RESET
TRACE = ("FVA-4", "FVA-5")
SIDES = ("low", "high")


class AxleSectionConfig(Config):
    """What the section machine depends on."""

    axle_limit: int = quantity(1_000, "axles", 2, 100_000, "[D] trains of 250 wagons")
    axles_a_cycle: int = quantity(40, "axles", 1, 400, "[D] in 500 ms, 1.8 m apart, 350 km/h: 27, with room")
    lead_cycles: int = quantity(10, "cycles", 1, 100_000, "[M] 5 s at 500 ms without an axle before a reset")


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine. Axles per cycle at the low and at the high end, into and out of the section.

    fault     a head is disturbed, knows no direction, or cannot be heard
    damped    a wheel stands on a head
    reported_clear  the driver of the sweep reports that he left the section and found nothing in it
    count     axles counted in less those counted out; quiet: cycles without an axle
    through   the sweep came in at one end only and went out at the other only
    axles     ghost: axles really in the section
    """

    config: AxleSectionConfig
    into: tuple[NumVar, ...]
    out: tuple[NumVar, ...]
    fault: BoolVar
    damped: BoolVar
    reset: BoolVar
    reported_clear: BoolVar
    count: NumVar
    quiet: NumVar
    swept_from: tuple[BoolVar, ...]
    swept_to: tuple[BoolVar, ...]
    answer: NumVar
    axles: NumVar
    next_axles: NumVar

    @property
    def change(self) -> Num:
        """Axles in less axles out in this cycle."""
        return self.into[0] + self.into[1] - self.out[0] - self.out[1]

    @property
    def counted(self) -> Num:
        """The count after the cycle."""
        return self.count + self.change

    @property
    def moved(self) -> Bool:
        """An axle passed a head."""
        return any_of(var > 0 for var in (*self.into, *self.out))

    @property
    def possible(self) -> Bool:
        """The count can be right."""
        return between(0, self.counted, self.config.axle_limit)

    @property
    def through(self) -> Bool:
        """Since the reset a train came in at one end and went out at the other, and nothing else moved."""
        ways = [
            self.swept_from[a] & ~self.swept_to[a] & ~self.swept_from[b] & self.swept_to[b] for a, b in ((0, 1), (1, 0))
        ]
        return any_of(ways)


def parts(config: AxleSectionConfig) -> Parts:
    """Fresh variables for one section."""
    most, limit = config.axles_a_cycle, config.axle_limit
    return Parts(
        config,
        tuple(number(f"axles_in_{side}", COUNT, 0, most) for side in SIDES),
        tuple(number(f"axles_out_{side}", COUNT, 0, most) for side in SIDES),
        boolean("head_fault"),
        boolean("head_damped"),
        boolean("reset_requested"),
        boolean("sweep_reported_clear"),
        number("counted_axles", COUNT, 0, limit),
        number("quiet_cycles", COUNT, 0, config.lead_cycles),
        tuple(boolean(f"sweep_in_{side}") for side in SIDES),
        tuple(boolean(f"sweep_out_{side}") for side in SIDES),
        choice("answer", enumeration(RESET)),
        number("true_axles", COUNT, 0, 2 * limit),
        number("next_true_axles", COUNT, 0, 2 * limit),
    )


AxleSection = Model[Parts]


def machine(config: AxleSectionConfig | None = None) -> Machine:
    """The machine of a section between axle counters (FVA-4, FVA-5)."""
    return build(parts(config or AxleSectionConfig())).machine


def build(own: Parts) -> AxleSection:
    """The machine over the given variables."""
    table = modes("UNKNOWN", "CLEAR", "OCCUPIED", "DISTURBED", "SWEEPING")
    current = current_mode(table)
    _, clear, occupied, _, _ = table
    state: dict[Var, Initial] = {own.count: 0, own.quiet: 0, own.answer: NOT_ASKED}
    state |= dict.fromkeys((*own.swept_from, *own.swept_to), False)
    counting = current.one_of(clear, occupied)
    made = Machine(
        name="axle_section",
        modes=table,
        inputs=[*own.into, *own.out, own.fault, own.damped, own.reset, own.reported_clear],
        state=state,
        outputs={
            "clear": current.eq(clear),
            "healthy": counting,
            "needs_reset": current.one_of(table[0], table[3]),
            "axles": own.count,
            "reset_answer": own.answer,
        },
        transitions=list(_table(own, current, table)),
        ghosts={own.axles: ANY},
        ghost_inputs=[own.next_axles],
        ghost_moves={own.axles: own.next_axles},
        assumption=_assumption(own, current, table),
        lemmas={
            "a count that is believed is true": counting.implies(own.axles.eq(own.count)),
            "clear is zero": current.eq(clear).implies(own.count.eq(0)),
        },
        definitions={"count after the cycle": own.counted, "sweep ran through": own.through, "answer": _answer(own, current, table)},
        mode_variable=current,
        doc=(
            "Clear or occupied by counting axles at both ends. Assumed: heads without a fault count every axle once and "
            "in its direction; a sweep that ran through on sight, was counted in and out, and reports the section free, "
            "left nothing behind. A miscount that no head tells and that never makes the count negative is outside of this."
        ),
    )  # fmt: skip
    return Model(made, own)


def _answer(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> Num:
    """What is said to a request for reset. A count is believed only while it is undisturbed, or swept."""
    counted = current.one_of(table[2], table[4]) & (own.count > 0)
    answer = ite(own.moved | (own.quiet < own.config.lead_cycles), AXLE_PASSED, ACCEPTED)
    answer = ite(counted, AXLES_COUNTED, answer)
    answer = ite(own.damped, HEAD_DAMPED, answer)
    answer = ite(own.fault, HEAD_FAULT, answer)
    return ite(own.reset, answer, NOT_ASKED)


def _table(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unknown, clear, occupied, disturbed, sweeping = table
    answer = _answer(own, current, table)
    zero = as_num(0, COUNT)
    quiet = ite(own.moved, zero, ite(own.quiet >= own.config.lead_cycles, own.quiet, own.quiet + 1))
    told: dict[Var, Expr | int | bool] = {own.quiet: quiet, own.answer: answer}
    fresh: dict[Var, Expr | int | bool] = {
        **told,
        own.count: 0,
        **dict.fromkeys((*own.swept_from, *own.swept_to), False),
    }
    counted: dict[Var, Expr | int | bool] = {**told, own.count: own.counted}
    sweep = counted | {var: var | (axles > 0) for var, axles in _ways(own)}
    believed = (clear, occupied, sweeping)
    wrong = own.fault | ~own.possible
    swept = own.through & own.counted.eq(0) & ~own.moved & ~own.damped & own.reported_clear
    yield Transition("count cannot be believed", believed, disturbed, wrong, fresh, TRACE, 0)
    yield Transition("reset accepted", table, sweeping, answer.eq(ACCEPTED), fresh, TRACE, 1)
    yield Transition("swept", sweeping, clear, swept, counted, TRACE, 2)
    yield Transition("sweep goes on", sweeping, sweeping, TRUE, sweep, TRACE, 3)
    yield Transition("all axles counted out", occupied, clear, own.counted.eq(0) & ~own.damped, counted, TRACE, 2)
    yield Transition("axles counted in", clear, occupied, (own.counted > 0) | own.damped, counted, TRACE, 2)
    yield Transition("stay clear", clear, clear, TRUE, counted, TRACE, 3)
    yield Transition("stay occupied", occupied, occupied, TRUE, counted, TRACE, 3)
    yield Transition("stay disturbed", disturbed, disturbed, TRUE, told, TRACE, 3)
    yield Transition("stay unknown", unknown, unknown, TRUE, told, TRACE, 3)


def _ways(own: Parts) -> list[tuple[BoolVar, NumVar]]:
    return [*zip(own.swept_from, own.into, strict=True), *zip(own.swept_to, own.out, strict=True)]


def _assumption(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> Bool:
    """Counts are true while no head is at fault; a reported, balanced sweep through leaves nothing."""
    swept = current.eq(table[4]) & own.through & own.counted.eq(0) & ~own.moved & own.reported_clear
    return all_of(
        [
            (~own.fault).implies(own.next_axles.eq(own.axles + own.change)),
            (swept & ~own.fault).implies(own.next_axles.eq(0)),
        ]
    )
