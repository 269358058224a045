"""Terms that are right at a glance are right by the rules."""

from __future__ import annotations

from itertools import product
from typing import Any

from safeloc.language.checks.terms import _PLAINLY_RIGHT, _wrong, malformed
from safeloc.language.expr import boolean, number
from safeloc.language.nodes import Add, And, Bool, Choose, ChooseBool, Compare, Lit, Max, Min, Not, Num, Or, Sub
from safeloc.language.units import COUNT, MM, Enumeration

ENUMERATION = Enumeration("light", ("red", "green"))
OPERANDS: tuple[Any, ...] = (
    number("place", MM, 0, 9),
    number("uses", COUNT, 0, 9),
    Lit(0, COUNT),
    Lit(1, ENUMERATION),
    boolean("go"),
    3,
)
PLACE, USES, ZERO, GREEN, GO, _ = OPERANDS


def built() -> list[Any]:
    """A node of each of these kinds, of any operands."""
    made: list[Any] = [Not(one) for one in OPERANDS]
    for one, other in product(OPERANDS, repeat=2):
        made += [kind(one, other, MM) for kind in (Add, Sub, Min, Max)]
        made += [kind((one, other)) for kind in (And, Or)]
        made += [Compare(op, one, other) for op in ("<", "<=", "==", ">")]  # type: ignore[arg-type] # that is the point
        made += [Choose(condition, one, other, MM) for condition in OPERANDS]
        made += [ChooseBool(condition, one, other) for condition in OPERANDS]
    return made


def test_what_is_right_at_a_glance_is_right() -> None:
    """Whatever the operands are; and some of each kind are seen at a glance, otherwise it would save nothing."""
    seen = {type(node) for node in built() if _PLAINLY_RIGHT[type(node)](node)}
    assert _PLAINLY_RIGHT.keys() == seen == {type(node) for node in built()}
    assert [] == [node for node in built() if _PLAINLY_RIGHT[type(node)](node) and _wrong(node)]


def test_what_is_wrong_is_told() -> None:
    """Units that differ, an order of members, a number for a truth value; whatever is right beside it."""
    wrong: list[Num | Bool] = [Add(PLACE, USES, MM), Compare("<", GREEN, GREEN), Not(USES), And((GO, PLACE))]
    for node in wrong:
        assert 1 == len([*malformed([Or((GO, GO)), node])]), type(node)
    assert [] == [*malformed([Add(PLACE, ZERO, MM), Compare("==", GREEN, GREEN), Not(GO)])]
