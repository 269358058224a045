"""Duration of an order to move: exactly as long as its conditions hold."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, before
from safeloc.language.spec import Property, always
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import CREEP, PROCEED, REVERSE
from safeloc.properties.stop_point.place import REQUIREMENTS, far_end, foremost, near_end, ordered_before, rearmost

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def going_on(model: StopPoint) -> Iterator[Property]:
    """Yield the properties of creeping on, reversing on, and proceeding no farther than to the window."""
    for maker in (_creeps_on, _reverses_on, _proceeds_to_the_window):
        yield from maker(model)


def _may(model: StopPoint) -> Bool:
    own = model.own
    return own.valid & own.precise & own.permitted


def _creeps_on(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    slow = own.speed <= own.config.reduced_speed_mm_s - own.config.speed_error_mm_s
    before_it = (rearmost(own) < near_end(own)) & (foremost(own) <= far_end(own)) & (own.position < own.stop)
    yield for_all_inputs(
        "creeps on while it may",
        (ordered_before(model).eq(CREEP) & _may(model) & slow & before_it).implies(order.eq(CREEP)),
        statement="the order to creep stays while the vehicle is permitted to move and measured, surely no faster than the reduced "
        "speed, possibly before the window and surely not beyond it, and before the stop by the measurement",
    )
    yield for_all_inputs(
        "creeping ends at the stop",
        (ordered_before(model).eq(CREEP) & order.eq(CREEP)).implies(own.position < own.stop),
        statement="the order to creep ends when the measured position reaches the stop",
    )


def _reverses_on(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    slow = own.speed >= own.config.speed_error_mm_s - own.config.reduced_speed_mm_s
    past_it = (foremost(own) > far_end(own)) & (rearmost(own) >= near_end(own))
    yield for_all_inputs(
        "reverses on while it may",
        (ordered_before(model).eq(REVERSE) & _may(model) & slow & past_it).implies(order.eq(REVERSE)),
        statement="the order to reverse stays while the vehicle is permitted to move and measured, surely no faster backwards than "
        "the reduced speed, possibly beyond the window and surely not before it",
    )


def _proceeds_to_the_window(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield for_all_inputs(
        "proceeds no farther than to the window",
        (ordered_before(model).eq(PROCEED) & (rearmost(own) >= near_end(own)) & own.pending_number.eq(before(own.pending_number)))
        .implies(order.ne(PROCEED)),
        statement="the order to proceed ends when the vehicle has surely reached the window of the pending stop")  # fmt: skip
