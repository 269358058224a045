"""A wrong edit of a term of the machine that tells whose a pattern is, is noticed by a proof."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import TRUE, Bool, Num, all_of, as_num, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.units import COUNT
from safeloc.models.train_order import TrainOrderConfig, build, parts
from safeloc.models.train_order.cycle import Cycle
from safeloc.properties.train_order import properties
from tests.models.edited_terms import edited, keeps

HELD, TRUE_ORDER = "a pattern holds its train", "the order is that on the track"
AS_MANY, OTHERS = (
    "as many patterns as trains belong to them in their order",
    "another number of patterns belongs to nobody",
)
REASON = "an order ends only for a reason"


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(TrainOrderConfig()))
    return model.machine, properties(model)


def in_last(cycle: Cycle) -> tuple[Num, ...]:
    """A train that comes in at the high end goes to the last place, behind a gap."""
    *others, last = cycle.own.order
    return (*others, ite(cycle.own.enters_high > 0, cycle.own.enters_high, last))


def in_low_for_high(cycle: Cycle, right: tuple[Num, ...]) -> tuple[Num, ...]:
    """A train that comes in at the high end is taken for one at the low end."""
    own = cycle.own
    up = (own.enters_high, *own.order[:-1])
    return tuple(ite(own.enters_high > 0, wrong, one) for wrong, one in zip(up, right, strict=True))


def out_low_for_high(cycle: Cycle, right: tuple[Num, ...]) -> tuple[Num, ...]:
    """A train that leaves at the high end is taken for the one at the low end."""
    down = (*cycle.own.order[1:], as_num(0, COUNT))
    return tuple(ite(cycle.own.leaves_high, wrong, one) for wrong, one in zip(down, right, strict=True))


def counted(cycle: Cycle, *, apart: Bool) -> Bool:
    """As many patterns as trains, by another test of apart."""
    trains = [one.ne(0).iff(cycle.own.patterns > rank) for rank, one in enumerate(cycle.after)]
    return all_of([*trains, cycle.own.patterns <= len(cycle.own.order), apart])


def no_more(cycle: Cycle) -> Bool:
    """No more patterns than trains; fewer are taken as well."""
    trains = [(cycle.own.patterns > rank).implies(one.ne(0)) for rank, one in enumerate(cycle.after)]
    return all_of([*trains, cycle.own.patterns <= len(cycle.own.order), cycle.apart])


def touching(cycle: Cycle) -> Bool:
    """Patterns may begin where the one before them ends."""
    own = cycle.own
    pairs = zip(own.highs, own.lows[1:], strict=False)
    orderly = [(own.patterns > n).implies(a <= b) for n, (a, b) in enumerate(zip(own.lows, own.highs, strict=True))]
    return all_of([*orderly, *((own.patterns > n).implies(end <= begin) for n, (end, begin) in enumerate(pairs, 1))])


def again(cycle: Cycle) -> Bool:
    """A train that is there may enter once more."""
    own = cycle.own
    enters, leaves = (own.enters_low > 0) | (own.enters_high > 0), own.leaves_low | own.leaves_high
    single = [~(enters & leaves), ~((own.enters_low > 0) & (own.enters_high > 0)), ~(own.leaves_low & own.leaves_high)]
    return all_of([*single, enters.implies(own.order[-1].eq(0)), ~(leaves & own.order[0].eq(0))])


Wrong = Callable[..., object]
EDITS: dict[str, tuple[str, Wrong, str]] = {
    "in at the high end is in at the low end": ("after", in_low_for_high, TRUE_ORDER),
    "out at the high end is out at the low end": ("after", out_low_for_high, TRUE_ORDER),
    "in behind a gap": ("after", lambda c, _: in_last(c), TRUE_ORDER),
    "the order is not kept up": ("after", lambda c, _: c.own.order, "the order follows: in at the low end"),
    "the order is turned round": ("after", lambda _c, right: right[::-1], TRUE_ORDER),
    "patterns need not lie apart": ("matched", lambda c, _: counted(c, apart=TRUE), OTHERS),
    "patterns may touch": ("apart", lambda c, _: touching(c), OTHERS),
    "fewer patterns are enough": ("matched", lambda c, _: no_more(c), OTHERS),
    "any number of patterns": ("matched", lambda _c, _r: TRUE, HELD),
    "one pattern is never a train's": ("matched", lambda c, right: right & (c.own.patterns > 1), AS_MANY),
    "any event is possible": ("possible", lambda _c, _r: TRUE, "two events at once ends the order"),
    "a train enters twice": ("possible", lambda c, _: again(c), "a train that is there already ends the order"),
    "only two trains are possible": ("possible", lambda c, right: right & c.own.order[1].eq(0), REASON),
}


@pytest.mark.thorough(ordinary=5)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, Cycle, name, wrong)
    assert not keeps(made(), claim)
