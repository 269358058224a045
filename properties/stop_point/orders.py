"""Orders without a position and after braking, and the outputs shown with orders."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, never
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import (
    BRAKE,
    CREEP,
    HOLD,
    NO_ORDER,
    NO_POSITION,
    NO_REASON,
    PROCEED,
    REVERSE,
    TOO_COARSE,
    TOO_FAR,
)
from safeloc.properties.stop_point.place import REQUIREMENTS, far_end, foremost, near_end, rearmost

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def orders(model: StopPoint) -> Iterator[Property]:
    """Yield the properties of holding, and of the driver's display."""
    for maker in (_without_a_position, _held, _after_braking, _limit, _distance, _coarse):
        yield from maker(model)


def _without_a_position(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield for_all_inputs(
        "without a position nothing moves",
        (~own.valid).implies(order.one_of(NO_ORDER, HOLD)),
        statement="without a valid position the machine orders to hold, or nothing if no stop is pending",
    )
    yield for_all_inputs(
        "a lost position does not end a stop",
        (~own.valid & earlier_num(order).ne(NO_ORDER) & ~own.released).implies(order.eq(HOLD)),
        statement="when the position is lost, a pending stop stays pending and the machine orders to hold",
    )


def _held(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield for_all_inputs(
        "held with a reason",
        model.in_mode("HELD").implies(own.reason.one_of(NO_POSITION, TOO_FAR) & order.eq(HOLD)),
        statement="in HELD the machine orders to hold and gives the reason",
    )
    enters = model.in_mode("HELD") & ~earlier_bool(model.in_mode("HELD"))
    yield for_all_inputs(
        "the reason for holding is right",
        enters.implies(ite(own.valid, own.reason.eq(TOO_FAR), own.reason.eq(NO_POSITION))),
        statement="when holding begins, the reason is a lost position if the position is invalid, else being too far beyond the window",
    )


def _after_braking(model: StopPoint) -> Iterator[Property]:
    order = model.machine.output("order")
    yield never(
        "no movement out of the brake order",
        earlier_num(order).eq(BRAKE) & order.one_of(PROCEED, CREEP, REVERSE),
        statement="an order to move never follows the brake order directly",
        requirements=REQUIREMENTS,
        unconditional=True,
    )


def _limit(model: StopPoint) -> Iterator[Property]:
    own, machine = model.own, model.machine
    slow = machine.output("order").one_of(CREEP, REVERSE)
    yield for_all_inputs(
        "the reduced speed is shown",
        machine.output("speed_limit_mm_s").eq(ite(slow, own.config.reduced_speed_mm_s, 0 * own.speed)),
        statement="the shown speed limit is the reduced speed with the order to creep or to reverse, else there is none",
    )


def _distance(model: StopPoint) -> Iterator[Property]:
    own, machine = model.own, model.machine
    shown = machine.output("distance_mm")
    yield for_all_inputs(
        "the distance to the stop is shown",
        (~model.in_mode("IDLE", "HELD")).implies((shown + own.position).eq(own.stop)),
        statement="while a stop is pending and not held, the machine shows the distance from the reported position to it",
    )
    yield for_all_inputs(
        "no distance without a stop that can be made",
        (model.in_mode("IDLE") | earlier_bool(model.in_mode("HELD")) & model.in_mode("HELD") | ~own.valid).implies(
            shown.eq(0)
        ),
        statement="without a pending stop or a position, and while the vehicle stays held, the machine shows no distance",
    )


def _coarse(model: StopPoint) -> Iterator[Property]:
    own = model.own
    coarse = (rearmost(own) < near_end(own)) & (foremost(own) > far_end(own))
    moved = ~earlier_bool(model.in_mode("IDLE")) & ~model.in_mode("IDLE", "HELD")
    chosen = model.machine.fired("another stop selected")
    yield for_all_inputs(
        "too coarse a measurement is reported",
        (moved & ~chosen).implies(own.reason.eq(ite(coarse, TOO_COARSE, NO_REASON))),
        statement="while a stop is pending, the machine reports TOO_COARSE exactly if the interval reaches beyond both ends of the window",
    )
