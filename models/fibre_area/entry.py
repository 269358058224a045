"""Trains at both ends of the area: entry of this train, its reference, and its complete exit (FVA-2, FVA-D1; figures, 003 items 3 and 14).

    OUTSIDE  the train is not in the area
    AWAITED  it was counted in; its reference has to come within `record_wait_cycles`
    TOLD     its reference came
    MISSING  its reference did not come in time

The counters report that a train comes in, with its number from train control, or that one has passed out; which one that is follows
from the order of the trains. So do the axles: those that pass at an end belong to the train that is the outermost there. Axles that are
counted in while no train is known in the area, and none comes in, are nobody's: somebody is there, and it is not known who.

So is somebody there who nobody announced if more axles came in than are the outermost train's: more, where that train came in, than its first sound reference has;
more at the other end than it had put out there; any after the exit of its running part was reported; or more out than in. Before its reference
comes it is not known how many axles a train has; until then nothing is known of the ground behind it either.

A reference is an axle counter's record, or the record handed over by the neighbouring area. It is due in the cycle in
which it comes, or in which it is overdue; then its sender is NOBODY. The verification accepts or refuses it. One that comes while the area is
empty, as that of the counter at the exit, is forgotten in the next cycle; one of an earlier train, in the cycle in which the next one comes in.

A train has left when the counters report its exit and as many of its axles were counted out as in since it entered, in every
cycle by undisturbed counters. If fewer axles leave, the train has left a part behind: its exit is not passed on until the
rest is counted out and reported too. It has left as well when undisturbed counters report an empty area.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import FALSE, TRUE, Bool, Lit, Num, all_of, any_of, as_num, ite
from safeloc.language.machine import Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT
from safeloc.models.fibre_area.entry_variables import THIS, Parts, parts
from safeloc.models.fibre_area.entry_world import EMPTY, EXACT, world
from safeloc.models.verification.variables import AXLE_COUNTER, NEIGHBOUR, NOBODY

__all__ = ["EMPTY", "EXACT", "THIS", "Entry", "Parts", "build", "parts"]
REQUIREMENTS = ("FVA-2", "FVA-11", "FVA-D1")


Entry = Model[Parts]


def build(own: Parts) -> Entry:
    """Return the machine over the given variables."""
    table = modes("OUTSIDE", "AWAITED", "TOLD", "MISSING")
    current = current_mode(table)
    machine = own.declared.machine(
        name="entry",
        modes=table,
        outputs={
            "reference_due": own.due,
            "reference_from": own.source,
            "in_area": current.ne(table[0]),
            "reference_missing": current.eq(table[3]),
            "waited_cycles": own.waited,
            "axles_inside": own.inside,
            "left": own.left,
            "left_in_part": own.in_part,
            "axles_come_in": own.come_in,
            "own_axles": own.own_axles,
            "axles_of_others": own.of_others,
            "unannounced": own.unannounced,
            **{one.name: one for one in own.events},
            **{one.name: one for one in own.gone},
            "forgets": own.forgets,
        },
        transitions=list(_table(own, table)),
        world=world(own),
        lemmas={
            "nothing is due from nobody but once": (own.due & own.source.eq(NOBODY)).implies(current.eq(table[3])),
            "only a train that is there has a sure balance": own.sure.implies(current.ne(table[0])),
            **_balance_lemmas(own),
        },
        doc="Entry of a train, arrival of its reference or the lack of it, and its exit with as many axles as came in.",
    )
    return Entry(machine, own)


def _balance_lemmas(own: Parts) -> dict[str, Bool]:
    """Return what a sure balance says of the train's axles, and of those of vehicles beside it that nobody announced."""
    balance = own.inside.eq(own.true_axles_inside + own.behind + own.ahead)
    return {
        "a sure balance is true": own.sure.implies(balance & own.there),
        "only a train that is there has axles in the area": own.there
        | all_of(one.eq(0) for one in (own.true_axles_inside, own.behind, own.ahead)),
        "a sure count of axles that came in is true": own.sure.implies(own.come_in.eq(own.true_come_in + own.behind)),
        "the train came in where it is told": own.sure.implies(own.from_high.iff(own.true_from_high)),
        "axles in the area came in": (own.true_axles_inside <= own.true_come_in) & (own.true_come_in <= own.true_axles),
        "an exit that was reported is remembered": (own.sure & own.part_out).implies(own.in_part),
        "nobody is ahead of a train with a sure balance": own.sure.implies(own.ahead.eq(0)),
        "all of a train is in before another is behind it": (own.sure & (own.behind > 0)).implies(
            own.true_come_in.eq(own.true_axles)
        ),
        "the reference has no more axles than the train": (own.sure & own.known).implies(
            own.own_axles <= own.true_axles
        ),
        "no more axles came in than the reference has": (own.sure & own.known).implies(own.come_in <= own.own_axles),
    }


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    outside, awaited, referenced, missing = table
    none, known = as_num(0, COUNT), own.was_known | own.reference_comes_now
    stays: Updates = {
        own.inside: ite(own.counted, own.balance, none),
        own.come_in: ite(own.counted, own.come_in_now, none),
        own.from_high: own.is_from_high,
        own.sure: own.counted,
        own.known: known,
        own.own_axles: ite(known, own.most, none),
        own.in_part: ~own.enters_now & (own.in_part | own.leaving),
        own.of_others: own.has_more,
        own.unannounced: own.someone_unannounced,
        **_passed_on(own, FALSE),
    }
    gone: Updates = {
        **dict.fromkeys((own.inside, own.come_in, own.own_axles), 0),
        **dict.fromkeys((own.sure, own.from_high, own.known, own.in_part, own.of_others), FALSE),
        own.unannounced: own.beside_others,
        **_passed_on(own, TRUE),
    }
    not_due: Updates = {own.due: False, own.source: NOBODY}
    answered = together(stays, {own.waited: 0, own.due: True, own.source: own.comes})
    overdue = together(stays, {own.waited: 0, own.due: True, own.source: NOBODY})
    waits = together(stays, not_due, {own.waited: own.waited + 1})
    same = together(stays, not_due, {own.waited: 0})
    left_now = together(gone, not_due, {own.waited: 0})
    came = own.comes.one_of(AXLE_COUNTER, NEIGHBOUR)
    there = (awaited, referenced, missing)
    yield Transition("train leaves", table, outside, own.complete, left_now, REQUIREMENTS, 0)
    yield Transition("area is empty", there, outside, own.emptied, left_now, REQUIREMENTS, 1)
    yield Transition("reference comes", table, referenced, came, answered, REQUIREMENTS, 2)
    yield Transition("train enters", table, awaited, own.enters_now, same, REQUIREMENTS, 3)
    yield Transition("reference overdue", awaited, missing, own.waited >= own.waited.high, overdue, REQUIREMENTS, 4)
    yield Transition("wait for the reference", awaited, awaited, TRUE, waits, REQUIREMENTS, 5)
    yield Transition("train is not here", outside, outside, TRUE, same, REQUIREMENTS, 5)
    yield Transition("reference is known", referenced, referenced, TRUE, same, REQUIREMENTS, 5)
    yield Transition("reference is missing", missing, missing, TRUE, same, REQUIREMENTS, 5)


def _passed_on(own: Parts, left: Bool) -> Updates:
    """Return what the later machines read in a cycle in which all of this train has `left`, or not.

    A train that has left because the counters are clear is gone at the low end, whichever it left by, so that the order drops it.
    """
    low, high = (
        out & any_of([last.eq(0), last.eq(THIS) & left, *_others_left(own, last)]) for _, out, last in own.ends
    )
    cleared = left & ~own.leaving & own.outermost[0].eq(THIS)
    others = [own.event(number, whole) for number, whole in enumerate(own.all_left, THIS + 1)]
    return {
        own.left: left,
        **dict(zip(own.events, [own.event(THIS, left), *others], strict=True)),
        **dict(zip(own.gone, (low | cleared, high), strict=True)),
        own.forgets: left | (own.enters_now & own.comes.eq(NOBODY)),
    }


def _others_left(own: Parts, outermost: Num) -> list[Bool]:
    return [outermost.eq(number) & left for number, left in enumerate(own.all_left, THIS + 1)]
