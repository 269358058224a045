"""Properties of announced groups that are refused in a row: when they speak against the position, and when they cannot."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import FALSE, Bool, all_of, as_num, between, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import COUNT, NM
from safeloc.models.balise import Balise
from safeloc.models.balise import variables as v
from safeloc.models.balise.linking import Record
from safeloc.models.vocabulary.reasons import CONTRADICTION
from safeloc.properties.balise.step import LAW, Step

for_all_inputs = partial(always, requirements=("RFL-D4",), unconditional=True)


def refusal_properties(model: Balise) -> Iterator[Property]:
    """Return every property of groups refused in a row."""
    yield from _counted(model)
    yield from _ending(model)
    yield from _rightly(model)


def _disagrees(model: Balise) -> Bool:
    """An announced group was read whole, but in the wrong direction, with another place than announced, or outside its window.

    It is said from the reading and the announcement, not by the machine's verdict; of two equal announcements the nearer counts.
    """
    step = Step(model)
    found: Bool = FALSE
    for slot in reversed(model.own.linking.slots):
        announced = earlier_num(slot.group).ne(0) & step.read_of(slot)
        found = ite(announced, step.against(slot) | _elsewhere(model, slot) | ~step.inside(slot), found)
    return step.announced & step.complete & found


def _elsewhere(model: Balise, slot: Record) -> Bool:
    """The telegram gives another place than announced, by more than the location accuracy."""
    place, most = model.own.read.place, Step(model).accuracy_of(slot)
    apart = place.value - earlier_num(slot.place)
    return place.present & ~between(-most, apart, most)


def _counted(model: Balise) -> Iterator[Property]:
    step, refused = Step(model), model.machine.output("refused_in_row")
    one = ite(_disagrees(model), as_num(1, COUNT), as_num(0, COUNT))
    counted = ite(model.own.memory.verdict.eq(v.ACCEPTED), as_num(0, COUNT), earlier_num(refused) + one)
    yield for_all_inputs(
        "groups that disagree are counted",
        refused.eq(ite(step.kept, counted, 0)),
        statement="the machine counts the announced groups in a row that were read completely, but in the wrong "
        "direction, with another place than announced, or outside their windows; an accepted group, and the loss of the "
        "position, begin the count anew",
    )


def _ending(model: Balise) -> Iterator[Property]:
    machine, limit = model.machine, model.own.config.refusal_limit_groups
    valid, refused = machine.flag("valid"), machine.output("refused_in_row")
    was_valid = earlier_bool(valid)
    last = was_valid & _disagrees(model) & (earlier_num(refused) >= limit - 1)
    yield for_all_inputs(
        "groups that disagree in a row end the position",
        last.implies(~valid),
        statement="in the step in which as many announced groups in a row disagree with the position as configured, the "
        "machine stops reporting it",
    )
    contradicts = model.own.memory.verdict.eq(v.CONTRADICTED) | last
    yield for_all_inputs(
        "a contradiction is the reason only with groups that contradict",
        (was_valid & machine.output("reason").eq(CONTRADICTION)).implies(contradicts),
        statement="the machine withdraws a position for a contradiction only if a group and the interval exclude each "
        "other, or as many groups in a row disagree as configured",
    )


def _rightly(model: Balise) -> Iterator[Property]:
    own, step = model.own, Step(model)
    as_announced = all_of(_where_announced(model, slot) for slot in own.linking.slots)
    ran = between(as_num(0, NM), own.world.true_since, own.world.true_cycle_distance)
    read = all_of([earlier_bool(model.machine.flag("valid")), step.announced, step.complete, ran])
    yield always(
        "a group at its place is neither out of its window nor a contradiction",
        (read & as_announced).implies(~own.memory.verdict.one_of(v.TOO_EARLY, v.TOO_LATE, v.CONTRADICTED)),
        statement="a group that lies where it was announced, and that the vehicle passed in this cycle and forwards, is "
        "never refused as out of its window, and never contradicts the position",
        requirements=("RFL-D4",),
        assumption=LAW,
    )


def _where_announced(model: Balise, slot: Record) -> Bool:
    """If the group that was read is the one in a slot, it lies within its location accuracy of its place."""
    step = Step(model)
    off, most = model.own.world.read_place - exact_to(earlier_num(slot.place), NM), exact_to(step.accuracy_of(slot), NM)
    return step.read_of(slot).implies(between(-most, off, most))
