"""What the line area is told of a train: the bounds of both ends, and which of them are believed (FVA-9).

The fibre follows a pattern. A part that a train lost stands silent and is not seen, so the pattern's ends are the
train's only as far as the train is known to be whole:

    NEITHER   no end of the pattern is known to be the train's
    WHOLE     the pattern had in this cycle as many axles as the counter counted: both ends are
    HIGH_END  since then it ran towards the high end in every cycle: a lost part is below, the high end is the train's
    LOW_END   since then it ran towards the low end in every cycle: a lost part is above, the low end is the train's

Count is identity. A length that agrees does not make a train whole: its tolerance is wider than a wagon. A train that
stands, or turns, can lose a part on either side. What is not trusted is not told at all.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    as_num,
    between,
    boolean,
    number,
    with_unit,
)
from safeloc.language.machine import Initial, Machine, Transition, current_mode, modes
from safeloc.language.units import MM, MS, UM
from safeloc.language.world import Law, World
from safeloc.models.area.slot import Reach

REQUIREMENTS = ("FVA-9", "FVA-18", "FVA-2", "FVA-11")


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    trusted, counted  the verification trusts the train; its count matched in this cycle
    low, high         bounds of the pattern from its low end to its high end; usable: within the line's range
    upwards, downwards  the pattern ran towards the high (low) end in this cycle
    age               how old the pattern's reading is
    told, told_low, told_high  what the area is told
    pattern_rear, pattern_front  ghosts: the pattern's ends when it was read, um rounded outward
    has_all           ghost: the pattern has all axles that the counter counted
    rear_is, front_is  ghosts: the pattern's low (high) end is the train's
    next_rear, next_front  ghosts: the train's ends now, um
    """

    reach: Reach
    trusted: BoolVar
    counted: BoolVar
    usable: BoolVar
    low: NumVar
    high: NumVar
    upwards: BoolVar
    downwards: BoolVar
    age: NumVar
    told: BoolVar
    told_low: NumVar
    told_high: NumVar
    pattern_rear: NumVar
    pattern_front: NumVar
    has_all: BoolVar
    rear_is: BoolVar
    front_is: BoolVar
    next_rear_is: BoolVar
    next_front_is: BoolVar
    next_rear: NumVar
    next_front: NumVar

    @property
    def choices(self) -> list[Var]:
        """What the world chooses in a cycle."""
        pattern: list[Var] = [self.pattern_rear, self.pattern_front, self.has_all]
        return [*pattern, self.next_rear_is, self.next_front_is, self.next_rear, self.next_front]


@dataclass(frozen=True, eq=False)
class Report:
    """The machine together with its variables."""

    machine: Machine
    own: Parts


def parts(reach: Reach, pattern_limit_um: int) -> Parts:
    """Fresh variables for one train, whose pattern may be anywhere within `pattern_limit_um`."""
    limit, far = reach.limit_mm, reach.limit_mm * 1_000
    step, oldest = reach.cycle_mm * 1_000, 2 * reach.report_age_limit_ms
    return Parts(
        reach,
        boolean("train_trusted"),
        boolean("count_matches_now"),
        boolean("ends_usable"),
        number("pattern_low_mm", MM, -limit, limit),
        number("pattern_high_mm", MM, -limit, limit),
        boolean("runs_upwards"),
        boolean("runs_downwards"),
        number("reading_age_ms", MS, 0, oldest),
        boolean("trusted_now"),
        number("reported_low_mm", MM, -limit, limit),
        number("reported_high_mm", MM, -limit, limit),
        number("pattern_rear_um", UM, -pattern_limit_um, pattern_limit_um),
        number("pattern_front_um", UM, -pattern_limit_um, pattern_limit_um),
        boolean("pattern_has_all_axles"),
        boolean("rear_is_the_trains"),
        boolean("front_is_the_trains"),
        boolean("next_rear_is_the_trains"),
        boolean("next_front_is_the_trains"),
        number("next_rear_um", UM, -far - step, far + step),
        number("next_front_um", UM, -far - step, far + step),
    )


def build(own: Parts) -> Report:
    """The machine over the given variables."""
    table = modes("NEITHER", "WHOLE", "HIGH_END", "LOW_END")
    current = current_mode(table)
    neither, whole, high, low = table
    state: dict[Var, Initial] = {own.told: False, own.told_low: 0, own.told_high: 0}
    inputs: list[Var] = [own.trusted, own.counted, own.usable, own.low, own.high, own.upwards, own.downwards, own.age]
    machine = Machine(
        name="report",
        modes=table,
        inputs=inputs,
        state=state,
        outputs={
            "told": own.told & current.ne(neither),
            "low_mm": own.told_low,
            "high_mm": own.told_high,
            "integer": current.eq(whole),
            "downwards": current.eq(low),
        },
        transitions=list(_table(own, table)),
        world=World(
            ghosts={own.rear_is: False, own.front_is: False},
            choices=own.choices,
            moves={own.rear_is: own.next_rear_is, own.front_is: own.next_front_is},
            clauses=_clauses(own),
        ),
        lemmas={
            "a believed high end is the train's": current.one_of(whole, high).implies(own.front_is),
            "a believed low end is the train's": current.one_of(whole, low).implies(own.rear_is),
        },
        mode_variable=current,
        doc=(
            "Which ends of a pattern are the train's. Assumed: a pattern with as many axles as the counter counted is the "
            "whole train; a train loses vehicles at the end that trails, and the pattern's direction of running is told "
            "truly; in the age of a reading nothing runs faster than the line's top speed."
        ),
    )
    return Report(machine, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    neither, whole, high, low = table
    zero = as_num(0, MM)
    told: dict[Var, Expr] = {own.told: TRUE, own.told_low: own.low, own.told_high: own.high}
    untold: dict[Var, Expr] = {own.told: FALSE, own.told_low: zero, own.told_high: zero}
    good = own.trusted & own.usable & (own.low <= own.high)
    up, down = own.upwards & ~own.downwards, own.downwards & ~own.upwards

    def row(name: str, source: Lit | tuple[Lit, ...], target: Lit, when: Bool, rank: int) -> Iterator[Transition]:
        yield Transition(name, source, target, when & good, told, REQUIREMENTS, rank)
        yield Transition(f"{name}, not told", source, target, when & ~good, untold, REQUIREMENTS, rank)

    yield from row("count matches", table, whole, own.counted, 0)
    yield from row("runs up since it was whole", (whole, high), high, up, 1)
    yield from row("runs down since it was whole", (whole, low), low, down, 1)
    yield Transition("may be in parts", table, neither, TRUE, untold, REQUIREMENTS, 2)


def _clauses(own: Parts) -> dict[str, Law]:
    """The pattern is part of the train: all of it if it has all axles; and its leading end is the train's."""
    up, down = own.upwards & ~own.downwards, own.downwards & ~own.upwards
    return {
        "a pattern with all axles is the whole train": Law(
            own.has_all.implies(own.next_rear_is & own.next_front_is),
            "A pattern in which as many axles are seen as the axle counter counted is the whole train.",
            source="[S] FVA-3: the axle count does not change during the stay",
            owner="infrastructure",
            check="the count is compared at every further axle counter",
        ),
        "the leading high end stays the train's": _stays(own.front_is & up, own.next_front_is, "high"),
        "the leading low end stays the train's": _stays(own.rear_is & down, own.next_rear_is, "low"),
        "the train's high end is near the pattern's": _read(
            own, own.next_front_is, own.next_front, own.pattern_front, "high"
        ),
        "the train's low end is near the pattern's": _read(
            own, own.next_rear_is, own.next_rear, own.pattern_rear, "low"
        ),
    }


def _stays(leads: Bool, next_is: Bool, end: str) -> Law:
    return Law(
        leads.implies(next_is),
        f"While the train runs towards its {end} end, it loses no vehicle there, and the direction of running is told truly.",
        source="[D] a coupling parts under traction or brake; what leads is not left behind",
        owner="operator",
        check="train integrity monitoring",
    )


def _read(own: Parts, known: Bool, place: Num, read: Num, end: str) -> Law:
    ran = with_unit(own.age * own.reach.max_speed_mm_s, UM)
    return Law(
        known.implies(_near(place, read, ran)),
        f"In the age of a reading the train's {end} end runs no farther than at the line's highest speed.",
        ("max_speed_mm_s",),
        "[D] line speed",
        "operator",
        "speed supervision",
    )


def _near(place: Num, read: Num, ran: Num) -> Bool:
    return between(read - ran, place, read + ran)
