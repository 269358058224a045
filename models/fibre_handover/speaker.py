"""Choice between two neighbouring areas for the report of a train's position (FVA-D1).

    NOBODY  neither area trusts the train where it may report it
    GIVING  the area from which the train comes: it trusts the train, which is certainly not beyond the shared stretch
    TAKING  the area into which it runs: it trusts the train, which has certainly come to the shared stretch
    BOTH    both areas report it; the output is the intersection of their intervals

An area reports a position only if the whole interval lies in its own stretch of line. Of a train that runs upwards, the giving area
reports up to the end of the shared stretch, and the taking one from its beginning on; downwards it is the other way round. So both
report a position only of a train that is in the shared stretch; if their intervals have nothing in common, no position is reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    NumVar,
    as_num,
    boolean,
    floor_div,
    ite,
    maximum,
    minimum,
    number,
)
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.units import MM
from safeloc.models.vocabulary.absent import margin_if, position_if

REQUIREMENTS = ("FVA-D1", "FVA-1", "FVA-10")


@dataclass(frozen=True, eq=False)
class Side:
    """Inputs from one area's verification: its trust in the train, and its interval of the front."""

    trusts: BoolVar
    low: NumVar
    high: NumVar


@dataclass(frozen=True, eq=False)
class Speaker:
    """The machine and its variables; shared stretch and direction come from the border; low and high bound the reported interval."""

    machine: Machine
    giving: Side
    taking: Side
    shared_from: NumVar
    shared_to: NumVar
    downwards: BoolVar
    low: NumVar
    high: NumVar


def speaker(far_mm: int) -> Speaker:
    """Return the machine of one train, on a line within `far_mm` to either side."""
    declared = Declared()
    giving, taking = (_side(declared, side, far_mm) for side in ("giving", "taking"))
    begins = declared.sensor(number("shared_from_mm", MM, -far_mm, far_mm))
    ends = declared.sensor(number("shared_to_mm", MM, -far_mm, far_mm))
    downwards = declared.sensor(boolean("downwards"))
    low = declared.state(number("given_low_mm", MM, -far_mm, far_mm), first=0)
    high = declared.state(number("given_high_mm", MM, -far_mm, far_mm), first=0)
    table = modes("NOBODY", "GIVING", "TAKING", "BOTH")
    current = current_mode(table)
    machine = declared.machine(
        name="speaker",
        modes=table,
        outputs={"given": current.ne(table[0]), **_interval(current.ne(table[0]), low, high)},
        transitions=list(
            _table(table, giving, taking, _own_stretches(giving, taking, begins, ends, downwards), (low, high))
        ),
        doc="Choice between two neighbouring areas for the report of a train's position.",
    )
    return Speaker(machine, giving, taking, begins, ends, downwards, low, high)


def _own_stretches(giving: Side, taking: Side, begins: NumVar, ends: NumVar, downwards: Bool) -> tuple[Bool, Bool]:
    """Return the conditions that each area trusts the train, and that its whole interval lies in its own stretch of line."""

    def lower(side: Side) -> Bool:
        return side.high <= ends

    def upper(side: Side) -> Bool:
        return side.low >= begins

    return (
        giving.trusts & ite(downwards, upper(giving), lower(giving)),
        taking.trusts & ite(downwards, lower(taking), upper(taking)),
    )


def _side(declared: Declared, name: str, far_mm: int) -> Side:
    return Side(
        declared.sensor(boolean(f"{name}_trusts")),
        declared.sensor(number(f"{name}_low_mm", MM, -far_mm, far_mm)),
        declared.sensor(number(f"{name}_high_mm", MM, -far_mm, far_mm)),
    )


def _interval(given: Bool, low: NumVar, high: NumVar) -> dict[str, Expr]:
    """Return the bounds as a position with its margins."""
    middle = floor_div(low + high, 2)
    return {
        "position_mm": position_if(given, middle),
        "margin_below_mm": margin_if(given, middle - low),
        "margin_above_mm": margin_if(given, high - middle),
    }


def _table(
    table: tuple[Lit, ...], giving: Side, taking: Side, own: tuple[Bool, Bool], given: tuple[NumVar, NumVar]
) -> Iterator[Transition]:
    nobody, first, second, both = table
    mine, theirs = own
    low, high = maximum(giving.low, taking.low), minimum(giving.high, taking.high)

    def row(name: str, target: Lit, when: Bool, bounds: tuple[Expr, Expr], rank: int) -> Transition:
        return Transition(name, table, target, when, dict(zip(given, bounds, strict=True)), REQUIREMENTS, rank)

    none = as_num(0, MM)
    yield row("both agree", both, mine & theirs & (low <= high), (low, high), 0)
    yield row("both contradict each other", nobody, mine & theirs & (low > high), (none, none), 0)
    yield row("the giving area reports", first, mine & ~theirs, (giving.low, giving.high), 0)
    yield row("the taking area reports", second, ~mine & theirs, (taking.low, taking.high), 0)
    yield row("neither area reports", nobody, TRUE, (none, none), 1)
