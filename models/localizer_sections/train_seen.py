"""Trackside: the train as its last new report tells it, for the line area that follows it (FVA-9, FVA-18).

Both ends come by radio, their age added to the error (models.transmission). A report counts once, in the cycle in which it is new; one
that is merely held says nothing more, since the area lets a train's bounds run on by itself. So a radio link that falls
silent can narrow nothing.

    SILENT      no new report in this cycle
    FRONT_ONLY  a new report of the front end alone: the train is not confirmed to be whole
    WHOLE       a new report of both ends
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Lit,
    Num,
    NumVar,
    Var,
    all_of,
    as_num,
    between,
    boolean,
    exact_to,
    ite,
    maximum,
    minimum,
    number,
)
from safeloc.language.machine import ANY, Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import MM, MS, NM
from safeloc.language.world import Law, World
from safeloc.models.vocabulary.vehicle_world import stated_interval_holds

REQUIREMENTS = ("FVA-9", "FVA-18")


@dataclass(frozen=True, eq=False)
class EndInputs:
    """An end's interval as the radio link gives it out, and its place (ghost); inputs, mm and nm."""

    valid: BoolVar
    position: NumVar
    below: NumVar
    above: NumVar
    truth: NumVar
    next_truth: NumVar

    @property
    def low(self) -> Num:
        """Its lower bound."""
        return self.position - self.below

    @property
    def high(self) -> Num:
        """Its upper bound."""
        return self.position + self.above

    @property
    def inputs(self) -> list[Var]:
        """Inputs of the report."""
        return [self.valid, self.position, self.below, self.above]

    def holds(self) -> Bool:
        """Return whether the interval that the link reports, if it is valid, contains the true place."""
        return self.valid.implies(stated_interval_holds(self.position, self.below, self.above, self.next_truth))


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    front, far    inputs: both ends
    age           input: how old the front end's report is
    upwards       input: the front end faces growing positions
    known, known_age  the front end's report of the cycle before
    low, high     bounds of the train from a new report
    low_end_believed     the end towards the low end is the one that is believed without the other
    """

    limit_mm: int
    period_ms: int
    front: EndInputs
    far: EndInputs
    age: NumVar
    upwards: BoolVar
    known: BoolVar
    known_age: NumVar
    low: NumVar
    high: NumVar
    low_end_believed: BoolVar

    @property
    def new(self) -> Bool:
        """The front end's report is another one than before: not merely older by a cycle."""
        return self.front.valid & (~self.known | self.age.ne(self.known_age + self.period_ms))


TrainSeen = Model[Parts]


def end_inputs(name: str, limit_mm: int, margin_mm: int, truth: NumVar) -> EndInputs:
    """Return fresh inputs of one end."""
    return EndInputs(
        boolean(f"{name}_valid"),
        number(f"{name}_position_mm", MM, -limit_mm, limit_mm),
        number(f"{name}_margin_below_mm", MM, 0, margin_mm),
        number(f"{name}_margin_above_mm", MM, 0, margin_mm),
        truth,
        number(f"next_{name}_truth_nm", NM, truth.low, truth.high),
    )


def parts(limit_mm: int, period_ms: int, oldest_ms: int, front: EndInputs, far: EndInputs) -> Parts:
    """Return fresh variables; places up to `limit_mm`, reports up to `oldest_ms`."""
    return Parts(
        limit_mm,
        period_ms,
        front,
        far,
        number("report_age_ms", MS, 0, oldest_ms),
        boolean("faces_upwards"),
        boolean("report_known"),
        number("known_age_ms", MS, 0, oldest_ms),
        number("train_low_mm", MM, -limit_mm, limit_mm),
        number("train_high_mm", MM, -limit_mm, limit_mm),
        boolean("low_end_believed"),
    )


def build(own: Parts) -> TrainSeen:
    """Build the machine over the given variables."""
    table = modes("SILENT", "FRONT_ONLY", "WHOLE")
    current = current_mode(table)
    front, far = own.front, own.far
    machine = Machine(
        name="trackside",
        modes=table,
        inputs=[*front.inputs, *far.inputs, own.age, own.upwards],
        state={own.known: False, own.known_age: 0, own.low: 0, own.high: 0, own.low_end_believed: False},
        outputs={
            "reported": current.ne(table[0]),
            "low_mm": own.low,
            "high_mm": own.high,
            "integer": current.eq(table[2]),
            "downwards": own.low_end_believed,
        },
        transitions=list(_table(own, table)),
        world=World(
            ghosts={front.truth: ANY, far.truth: ANY},
            choices=[front.next_truth, far.next_truth],
            moves={front.truth: front.next_truth, far.truth: far.next_truth},
            clauses={
                "a near end that comes holds the truth": _reported_truly(front.holds(), "near"),
                "a far end that comes holds the truth": _reported_truly(far.holds(), "far"),
            },
        ),
        lemmas=_lemmas(own, current, table),
        doc=(
            "The train as its new reports tell it. Assumed: the interval that the radio link reports for an end holds that end (the "
            "link's own proof discharges this)."
        ),
    )
    return TrainSeen(machine, own)


def _reported_truly(holds: Bool, end: str) -> Law:
    return Law(
        holds,
        f"The interval of the {end} end that the radio link reports holds that end.",
        source="[D] containment of the link, whose own proof it is",
        owner="supplier",
        check="replayed recordings with a known true position",
    )


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    silent, front_only, whole = table
    low, high = _bounds(own)
    last: Updates = {own.known: own.front.valid, own.known_age: ite(own.front.valid, own.age, 0)}
    reported = together(last, {own.low: low, own.high: high, own.low_end_believed: ~own.upwards})
    nothing = together(last, {own.low: as_num(0, MM), own.high: as_num(0, MM), own.low_end_believed: FALSE})
    fits = between(-own.limit_mm, low, own.limit_mm) & between(-own.limit_mm, high, own.limit_mm)
    yield Transition("new report of both ends", table, whole, own.new & own.far.valid & fits, reported, REQUIREMENTS, 0)
    yield Transition(
        "new report of the front end", table, front_only, own.new & ~own.far.valid & fits, reported, REQUIREMENTS, 0
    )
    yield Transition("new report beyond the line", table, silent, own.new & ~fits, nothing, REQUIREMENTS, 0)
    yield Transition("no new report", table, silent, TRUE, nothing, REQUIREMENTS, 1)


def _bounds(own: Parts) -> tuple[Num, Num]:
    """Both ends where both are known; else those of the front end, of which the outer one is believed."""
    front, far = own.front, own.far
    low = ite(far.valid & own.upwards, minimum(front.low, far.low), front.low)
    high = ite(far.valid & ~own.upwards, maximum(front.high, far.high), front.high)
    return low, high


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    reported, whole = current.ne(table[0]), current.eq(table[2])
    low, high = exact_to(own.low, NM), exact_to(own.high, NM)
    front, far, up = own.front.truth, own.far.truth, ~own.low_end_believed
    return {
        "the believed end is the front end's": all_of(
            [(reported & up).implies(front <= high), (reported & own.low_end_believed).implies(low <= front)]
        ),
        "a complete train's far end is inside": all_of(
            [(whole & up).implies(low <= far), (whole & own.low_end_believed).implies(far <= high)]
        ),
        "bounds in order": own.low <= own.high,
    }
