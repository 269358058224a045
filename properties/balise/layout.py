"""Properties of the balise machine on a line that passes the audit, in the audit's own rules (RFL-D4)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import pairwise

from safeloc.language.expr import Bool, Num, abs_, all_of, between, exact_to, minimum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable
from safeloc.language.units import NM, NM_PER_MM
from safeloc.models.balise import Balise
from safeloc.models.balise import variables as v
from safeloc.models.balise.linking import Record
from safeloc.models.balise.reckoning import as_reckoned, layout, reckoned_nm
from safeloc.models.layout_rules import expectation_windows_apart
from safeloc.properties.balise.step import Step

for_all_inputs = partial(always, requirements=("RFL-D4",), unconditional=True)


def layout_properties(model: Balise) -> Iterator[Property]:
    """Return the properties that rest on the layout."""
    yield from _windows(model)
    if not model.own.config.odometer.floor_mm_s:
        yield from _reckoning(model)


# ------------------------------------------------------------------ expectation windows


def _windows(model: Balise) -> Iterator[Property]:
    valid, slots = model.machine.flag("valid"), model.own.linking.slots
    for number, (nearer, farther) in enumerate(pairwise(slots), 1):
        both = _open(model, nearer) & _open(model, farther)
        yield for_all_inputs(
            f"one window at a time: groups {number} and {number + 1} ahead",
            all_of([valid, farther.held, _apart(model, nearer, farther)]).implies(~both),
            statement="if the audit found the expectation windows of two announced groups apart, the vehicle is "
            "never inside both (3.4.4.4.5)",
        )
    first, second = slots[:2]
    yield reachable(
        "two groups ahead on an audited line",
        all_of([valid, second.held, _apart(model, first, second), _open(model, first)]),
        statement="the layout rule leaves room for two announced groups, the first of them inside its window",
        requirements=("RFL-D4",),
    )


def _accuracy(model: Balise, slot: Record) -> Num:
    """The location accuracy of the group in a slot, after the step, mm."""
    return slot.accuracy_or(Step(model).accuracy_in_force)


def _open(model: Balise, slot: Record) -> Bool:
    """The window of the group in a slot is open, after the step."""
    interval, config = model.own.held.interval, model.own.config
    spread = exact_to(config.detection_mm + _accuracy(model, slot), NM)
    nominal = exact_to(config.antenna_mm + slot.place, NM)
    return (nominal - interval.high <= spread) & (interval.low - nominal <= spread)


def _apart(model: Balise, nearer: Record, farther: Record) -> Bool:
    """The layout rule holds for the groups in two slots, at the location accuracies in force."""
    accuracies = (_accuracy(model, nearer), _accuracy(model, farther))
    return expectation_windows_apart(farther.place - nearer.place, *accuracies, layout(model.own.config))


# ------------------------------------------------------------------ odometry between groups


def _reckoning(model: Balise) -> Iterator[Property]:
    own, step = model.own, Step(model)
    yield for_all_inputs(
        "margin as the audit reckons it",
        as_reckoned(own),
        statement="if the whole distance since the last group was measured, the margin is at most the audit's "
        "odometry error for that distance",
    )
    line, limit = own.config.position_limit_mm * NM_PER_MM, (own.config.tolerance_mm - 1) * NM_PER_MM
    on_line = between(-line, step.moved.position, line)
    measured = earlier_bool(own.memory.measured) & step.admitted
    lost = model.machine.fired("tolerance exceeded") & own.memory.verdict.ne(v.ACCEPTED) & on_line & measured
    run = minimum(earlier_num(own.memory.run) + abs_(step.distance), v.FARTHEST_MM)
    yield for_all_inputs(
        "no loss within the audited stretch",
        lost.implies(reckoned_nm(own.config, run, earlier_num(own.memory.accuracy)) > limit),
        statement="if the whole distance since the last group was measured, the machine withdraws the position for "
        "its tolerance only at a distance at which the audit's odometry error exceeds it",
    )
