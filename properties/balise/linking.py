"""Properties of linking: windows, groups given up, and reactions (RFL-D4)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, ite, minimum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.models.balise import Balise
from safeloc.models.balise import variables as v
from safeloc.models.balise.linking import NO_REACTION, REPLACE, SERVICE_BRAKE, TRAIN_TRIP, WITHDRAW, Record
from safeloc.properties.balise.step import Step

for_all_inputs = partial(always, requirements=("RFL-D4",), unconditional=True)


def linking_properties(model: Balise) -> Iterator[Property]:
    """Return every property of linking."""
    yield from _kept(model)
    yield from _windows(model)
    yield from _reactions(model)
    yield from _other_reactions(model)


def _kept(model: Balise) -> Iterator[Property]:
    """The machine stores announced groups as they were announced: the world's law of the map rests on that."""
    slots = model.own.linking.slots
    for number, slot in enumerate(slots, 1):
        was = [_as_it_was(slot, before) for before in slots[number - 1 :]]
        yield for_all_inputs(
            f"announced group {number} stays stored as announced",
            slot.group.eq(0) | any_of([_as_announced(model, slot), *was]),
            statement="each stored announcement was stored before, unchanged and in the same or a later slot, or "
            "arrived in this very step: its place, accuracy, orientation and linking reaction",
        )


def _as_it_was(slot: Record, before: Record) -> Bool:
    pairs = zip(_figures(slot), _figures(before), strict=True)
    accurate = slot.accurate.iff(earlier_bool(before.accurate))
    return all_of([accurate, *(now.eq(earlier_num(then)) for now, then in pairs)])


def _as_announced(model: Balise, slot: Record) -> Bool:
    offered = model.own.linking.offered
    received = (offered.group, offered.place, offered.reaction, offered.orientation)
    kept = (slot.group, slot.place, slot.reaction, slot.orientation)
    accuracy = ite(
        slot.accurate, offered.accuracy.present & slot.accuracy.eq(offered.accuracy.value), ~offered.accuracy.present
    )
    same = [one.present & now.eq(one.value) for one, now in zip(received, kept, strict=True)]
    return all_of([offered.order.present, offered.order.value.ne(WITHDRAW), accuracy, *same])


def _figures(slot: Record) -> tuple[Num, ...]:
    return (slot.group, slot.place, slot.accuracy, slot.reaction, slot.orientation)


def _windows(model: Balise) -> Iterator[Property]:
    own, step = model.own, Step(model)
    held, seen, passed, kept = step.expecting, step.announced, step.passed, step.kept
    yield for_all_inputs(
        "window closes when the min safe front end has passed",
        (kept & held & ~seen & passed).implies(own.memory.given_up_now.eq(1) & _given_up(model)),
        statement="the machine gives up a group that was not read in the very step in which the min safe front end "
        "passes the last place where it can be read, and orders its linking reaction",
    )
    yield for_all_inputs(
        "no window closes early",
        (kept & (own.memory.given_up_now > 0)).implies(seen | (held & passed)),
        statement="the machine gives up an announced group only when it, or a later one, was read, or when its window has closed",
    )
    yield for_all_inputs(
        "expected until found or given up",
        (kept & held & ~seen & ~passed & ~_relinked(model)).implies(
            own.linking.slots[0].group.eq(earlier_num(own.linking.slots[0].group))
        ),
        statement="a group stays expected until it is read, its window closes, or linking is renewed",
    )


def _given_up(model: Balise) -> Bool:
    slot = model.own.linking.slots[0]
    strong = earlier_num(slot.reaction)
    acted = model.own.memory.linking_reaction_now
    enough = ite(strong.eq(TRAIN_TRIP), acted.eq(TRAIN_TRIP), strong.eq(NO_REACTION) | acted.ne(NO_REACTION))
    return model.own.memory.given_up_group.eq(earlier_num(slot.group)) & enough


def _relinked(model: Balise) -> Bool:
    order = model.own.linking.offered.order
    return order.present & order.value.one_of(REPLACE, WITHDRAW)


# ------------------------------------------------------------------ reactions


def _reactions(model: Balise) -> Iterator[Property]:
    machine, memory, step = model.machine, model.own.memory, Step(model)
    located = earlier_bool(machine.flag("valid"))
    braking = memory.linking_reaction_now.one_of(SERVICE_BRAKE, TRAIN_TRIP)
    misses = all_of([located, step.expecting, ~step.announced, step.passed])
    yield for_all_inputs(
        "two missed brake",
        (misses & (earlier_num(memory.missed_in_row) >= 1)).implies(braking),
        statement="when the second announced group in a row is missed, at least the service brake is ordered in the same "
        "step, whatever its linking reaction",
    )
    yield for_all_inputs(
        "missed groups are counted",
        step.kept.implies(memory.missed_in_row.eq(_count(step))),
        statement="the machine counts the groups given up in a row until it accepts one",
    )


def _other_reactions(model: Balise) -> Iterator[Property]:
    """Claim the reaction to a wrong direction, and that there is none without a linking error."""
    machine, memory, step = model.machine, model.own.memory, Step(model)
    located = earlier_bool(machine.flag("valid"))
    wrong = memory.verdict.eq(v.WRONG_DIRECTION) & located & step.announced
    yield for_all_inputs(
        "wrong direction trips",
        wrong.implies(memory.linking_reaction_now.eq(TRAIN_TRIP)),
        statement="an announced group passed in the other orientation trips the train in the same step (3.16.2.3.2)",
    )
    yield for_all_inputs(
        "no reaction without a linking error",
        memory.linking_reaction_now.ne(NO_REACTION).implies((memory.given_up_now > 0) & located),
        statement="a group that linking did not announce, or a damaged telegram, is rejected without a reaction "
        "(3.16.2.4.3); only a group given up causes one",
    )
    for name, event in _events(step).items():
        yield for_all_inputs(
            f"reported: {name}",
            (step.kept & event).implies(machine.fired(name)),
            statement=f"whenever it happens, the table says so: {name}",
        )


def _events(step: Step) -> dict[str, Bool]:
    """Properties of announced groups, by the transition that reports their outcome."""
    memory = step.model.own.memory
    counted = memory.verdict.eq(v.ACCEPTED) & step.announced
    first = step.read_of(step.model.own.linking.slots[0])
    free = memory.verdict.eq(v.ACCEPTED) & ~step.announced
    outside = memory.verdict.one_of(v.TOO_EARLY, v.TOO_LATE)
    unfit = memory.verdict.one_of(v.INCOMPLETE, v.MISMATCH)
    return {
        "expected group resets the position": counted & first,
        "later group resets the position": counted & ~first,
        "group passed in the wrong direction": step.announced & memory.verdict.eq(v.WRONG_DIRECTION),
        "group found outside its window": step.announced & outside,
        "group incomplete or not as announced": step.announced & unfit,
        "expected group missed": step.expecting & ~step.announced & step.passed & ~free,
    }


def _count(step: Step) -> Num:
    memory = step.model.own.memory
    reset = memory.verdict.eq(v.ACCEPTED) & step.announced
    return ite(reset, 0, minimum(earlier_num(memory.missed_in_row) + memory.given_up_now, 2))
