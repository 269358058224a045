"""When a train comes into the area and when its reference is due (FVA-2, FVA-D1; figures, 003 items 3 and 14).

    OUTSIDE  the train is not in the area
    AWAITED  it was counted in; its reference has to come within `record_wait_cycles`
    TOLD     its reference came
    MISSING  its reference did not come in time

A reference is an axle counter's record, or the record handed over by the neighbouring area. It is due in the cycle in
which it comes, or in which it is overdue; then from nobody. What becomes of it is the verification's to judge.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    NumVar,
    Var,
    as_num,
    boolean,
    choice,
    enumeration,
    number,
)
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.units import COUNT
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, EVENT, LEAVES_HIGH, LEAVES_LOW
from safeloc.models.verification.variables import AXLE_COUNTER, FROM, NEIGHBOUR, NOBODY

REQUIREMENTS = ("FVA-2", "FVA-11", "FVA-D1")


@dataclass(frozen=True, eq=False)
class Entry:
    """The machine and its variables.

    event   the axle counters at both ends: this train enters, or has left completely
    comes   a reference for this train comes in this cycle, and from whom (NOBODY: none comes)
    waited  cycles since it was counted in without one
    due, source  what the verification is told
    """

    machine: Machine
    event: NumVar
    comes: NumVar
    waited: NumVar
    due: BoolVar
    source: NumVar

    @property
    def leaves(self) -> Bool:
        """The train has left in this cycle."""
        return self.event.one_of(LEAVES_LOW, LEAVES_HIGH)


def entry(wait_cycles: int) -> Entry:
    """The machine of one train."""
    table = modes("OUTSIDE", "AWAITED", "TOLD", "MISSING")
    event, comes = choice("event", enumeration(EVENT)), choice("reference_comes", enumeration(FROM))
    waited = number("waited_cycles", COUNT, 0, wait_cycles)
    due, source = boolean("due"), choice("from", enumeration(FROM))
    current = current_mode(table)
    machine = Machine(
        name="entry",
        modes=table,
        inputs=[event, comes],
        state={waited: 0, due: False, source: NOBODY},
        outputs={
            "reference_due": due,
            "reference_from": source,
            "in_area": current.ne(table[0]),
            "reference_missing": current.eq(table[3]),
            "waited_cycles": waited,
        },
        transitions=list(_table(table, event, comes, waited, due, source)),
        lemmas={"nothing is due from nobody but once": (due & source.eq(NOBODY)).implies(current.eq(table[3]))},
        mode_variable=current,
        doc="When a train is counted in, and when its reference came or is overdue.",
    )
    return Entry(machine, event, comes, waited, due, source)


def _table(
    table: tuple[Lit, ...], event: NumVar, comes: NumVar, waited: NumVar, due: BoolVar, source: NumVar
) -> Iterator[Transition]:
    outside, awaited, told, missing = table
    none = as_num(0, COUNT)
    quiet: dict[Var, Expr | bool] = {waited: none, due: False, source: NOBODY}
    heard: dict[Var, Expr | bool] = {waited: none, due: True, source: comes}
    overdue: dict[Var, Expr | bool] = {waited: none, due: True, source: NOBODY}
    waits: dict[Var, Expr | bool] = {**quiet, waited: waited + 1}
    leaves, enters = event.one_of(LEAVES_LOW, LEAVES_HIGH), event.one_of(ENTERS_LOW, ENTERS_HIGH)
    came = comes.one_of(AXLE_COUNTER, NEIGHBOUR)
    yield Transition("train leaves", table, outside, leaves, quiet, REQUIREMENTS, 0)
    yield Transition("reference comes", table, told, came, heard, REQUIREMENTS, 1)
    yield Transition("train enters", table, awaited, enters, quiet, REQUIREMENTS, 2)
    yield Transition("reference overdue", awaited, missing, waited >= waited.high, overdue, REQUIREMENTS, 3)
    yield Transition("wait for the reference", awaited, awaited, TRUE, waits, REQUIREMENTS, 4)
    yield Transition("train is not here", outside, outside, TRUE, quiet, REQUIREMENTS, 4)
    yield Transition("reference is known", told, told, TRUE, quiet, REQUIREMENTS, 4)
    yield Transition("reference is missing", missing, missing, TRUE, quiet, REQUIREMENTS, 4)
