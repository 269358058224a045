"""Mutants that do the same as the machine, proved by two copies side by side."""

from __future__ import annotations

from functools import cache

import pytest

from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.judge_machine_mutant import Bench, bench, judged
from safeloc.assurance.mutation.mutants import Mutant, mutants
from safeloc.assurance.mutation.places import Places
from safeloc.language.expr import boolean, ite, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.units import MM
from safeloc.proof.provers.limits import Limits
from safeloc.target import Target

COMES, SENT_MM = boolean("comes"), number("sent_mm", MM, 0, 99)
THERE, STORED_MM = boolean("there"), number("stored_mm", MM, 0, 99)


@cache
def mailbox() -> tuple[Bench, list[Mutant]]:
    """A report that is stored while it is there; one step later it is removed, and a zero takes its place."""
    (on,) = modes("ON")
    rows = [
        Transition("stores", on, on, COMES, {THERE: True, STORED_MM: SENT_MM}, rank=0),
        Transition("removes", on, on, set={THERE: False, STORED_MM: 0}, rank=1),
    ]
    told = {"told_mm": ite(THERE, STORED_MM, 0)}
    machine = Machine("mailbox", (on,), [COMES, SENT_MM], {THERE: False, STORED_MM: 0}, told, rows)
    made = Declared(machine, ())
    return bench(Target("mailbox", (machine,), made.lowered(), ()), made, Limits(seconds=2), 0), mutants(made, Places())


@pytest.mark.parametrize(
    ("words", "where", "fate"),
    [
        ("0 becomes 1", "row 'removes'", "equivalent"),
        ("stored_mm keeps its value", "row 'removes'", "equivalent"),
        ("there keeps its value", "row 'removes'", "survived"),
        ("stored_mm keeps its value", "row 'stores'", "survived"),
        ("0 becomes 1", "output told_mm", "survived"),
    ],
)
def test_what_is_not_there_may_have_any_content(words: str, where: str, fate: str) -> None:
    """The stored number is the same only while the flag says that it is there; no mode says so."""
    on, every = mailbox()
    [one] = [one for one in every if words in one.words and where in str(one.where)]
    assert fate == judged(on, one).alone.fate
