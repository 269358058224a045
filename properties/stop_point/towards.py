"""Moving: on towards the platform's end, forward into the window, and back into it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, any_of, before, exact_to, ite, product, with_unit
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM, UM, UM_PER_MM
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import BRAKE, CREEP, PROCEED, REVERSE
from safeloc.properties.stop_point.place import (
    LAW,
    REQUIREMENTS,
    far_end,
    foremost,
    near_end,
    ordered_before,
    rearmost,
    stands,
    width,
)

_ROUNDING_MM = 1
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def towards(model: StopPoint) -> Iterator[Property]:
    """Yield the properties of every order to move."""
    for maker in (_on, _brakes_for_the_window, _brakes_for_the_stop, _no_early_brake, _creeping, _reversing, _may_move):
        yield from maker(model)
    for begins in (_begins_to_reverse, _keeps_reversing, _reverses_when_it_may, _creeps_when_it_may):
        yield from begins(model)


def _on(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield under_assumption(
        "never on beyond the window",
        order.one_of(PROCEED, CREEP).implies(own.truth <= far_end(own)),
        statement="while a stop is pending, the machine never orders a vehicle beyond the stop window to go on or to start towards the "
        "platform's end",
    )


def _proceeds(model: StopPoint) -> Bool:
    """Return whether the order is to proceed to a stop that was pending before: at its selection it may be too late to brake."""
    own = model.own
    return model.machine.output("order").eq(PROCEED) & own.pending_number.eq(before(own.pending_number))


def _brakes_for_the_window(model: StopPoint) -> Iterator[Property]:
    own = model.own
    yield under_assumption(
        "brake order in time",
        _proceeds(model).implies(own.truth + own.run_out <= far_end(own)),
        statement="the vehicle may proceed only while the guaranteed brake, ordered in the next cycle, still stops the true front end "
        "within the stop window or before it",
    )


def _brakes_for_the_stop(model: StopPoint) -> Iterator[Property]:
    own, stop = model.own, exact_to(model.own.stop, NM)
    yield under_assumption(
        "brakes to the stop by the measurement",
        (_proceeds(model) & own.precise).implies(own.run_out <= stop - exact_to(own.position, NM)),
        statement="with a measured distance the vehicle may proceed only while the guaranteed brake stops it at or before the stop, "
        "counted from the measured position",
    )
    yield under_assumption(
        "brakes to the stop by odometry",
        (_proceeds(model) & ~own.precise).implies(own.run_out <= stop - foremost(own)),
        statement="without a measured distance the vehicle may proceed only while the guaranteed brake stops it at or before the stop, "
        "counted from the foremost possible place",
    )


def _no_early_brake(model: StopPoint) -> Iterator[Property]:
    """Yield that the brake order is not early: twice deceleration x distance left, against the highest possible speed squared."""
    own, config = model.own, model.own.config
    fastest = own.speed + config.speed_error_mm_s
    squared = with_unit(product(fastest, fastest) * UM_PER_MM, UM)
    beyond = own.position - own.stop + own.above
    to_stop, to_end = ite(own.precise, own.stop - own.position, -beyond), own.after - beyond
    due = any_of(
        (left <= 0)
        | (fastest > 0)
        & (squared >= (exact_to(left - _ROUNDING_MM, UM) - _reaction_um(model)) * (2 * config.brake_mm_s2))
        for left in (to_stop, to_end)
    )
    yield for_all_inputs(
        "no brake order before it is due",
        (ordered_before(model).eq(PROCEED) & model.machine.output("order").eq(BRAKE)).implies(
            due | (rearmost(own) >= near_end(own))
        ),
        statement="the machine orders the brake only if the vehicle has surely reached the window, or if a distance ahead is at "
        "most the braking distance at the highest possible speed, plus 1 mm for rounding. That distance is from the "
        "measured position (without one, from the foremost possible place) to the stop, or from the foremost possible "
        "place to the window's far end",
    )


def _reaction_um(model: StopPoint) -> Num:
    """Return the distance at the highest possible speed before the brake acts, um."""
    config = model.own.config
    return with_unit((model.own.speed + config.speed_error_mm_s) * config.reaction_ms, UM)


def _creeping(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield under_assumption(
        "creeping is slow",
        order.eq(CREEP).implies(own.true_speed <= own.config.reduced_speed_mm_s),
        statement="while the order is to creep, the vehicle truly runs no faster than the reduced speed",
    )
    yield for_all_inputs(
        "creeping begins at standstill",
        (order.eq(CREEP) & ordered_before(model).ne(CREEP)).implies(stands(own) & (foremost(own) <= far_end(own))),
        statement="creeping begins only at standstill, and only if the vehicle surely is before the window's far end",
    )
    yield under_assumption(
        "creeping ends in the window",
        order.eq(CREEP).implies(own.truth < near_end(own) + width(own)),
        statement="the order to creep ends when the vehicle is surely no longer before the window",
    )


def _reversing(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield under_assumption(
        "reversing is slow",
        order.eq(REVERSE).implies(-own.true_speed <= own.config.reduced_speed_mm_s),
        statement="while the order is to reverse, the vehicle truly runs no faster backwards than the reduced speed",
    )
    yield under_assumption(
        "never back before the window",
        order.eq(REVERSE).implies(own.truth >= near_end(own)),
        statement="the machine never orders a vehicle before the stop window to reverse",
    )


def _may_move(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    for name, given in (("reversing", REVERSE), ("creeping", CREEP)):
        yield for_all_inputs(
            f"{name} is permitted and measured",
            order.eq(given).implies(own.permitted & own.precise & own.valid),
            statement=f"{name} needs, in every cycle, the permission and a measured distance to the reflector",
        )


def _begins_to_reverse(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    limit = exact_to(own.after + own.stop + own.config.reposition_limit_mm, NM)
    begins = order.eq(REVERSE) & ordered_before(model).ne(REVERSE)
    yield for_all_inputs(
        "reversing begins at standstill",
        begins.implies(stands(own) & (foremost(own) > far_end(own)) & (foremost(own) <= limit)),
        statement="reversing begins only at standstill, possibly beyond the window, and no farther beyond it than allowed",
    )
    slowest = own.config.standstill_mm_s + own.config.speed_error_mm_s
    yield under_assumption(
        "reversing begins near the window",
        begins.implies((own.truth <= limit) & (own.true_speed <= slowest) & (own.true_speed >= -slowest)),
        statement="when the order to reverse begins, the vehicle truly stands, up to the speed error, no farther beyond the window than "
        "allowed",
    )


def _keeps_reversing(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield under_assumption(
        "reversing ends in the window",
        order.eq(REVERSE).implies(own.truth + width(own) > far_end(own)),
        statement="the order to reverse ends when the vehicle is surely no longer beyond the window",
    )


def _reverses_when_it_may(model: StopPoint) -> Iterator[Property]:
    own = model.own
    limit = exact_to(own.after + own.stop + own.config.reposition_limit_mm, NM)
    may = own.valid & own.precise & own.permitted & stands(own) & ~own.released
    where = (rearmost(own) >= near_end(own)) & (foremost(own) > far_end(own)) & (foremost(own) <= limit)
    yield for_all_inputs(
        "repositions when it may",
        (earlier_bool(model.in_mode("OVERRUN")) & may & where).implies(model.machine.output("order").eq(REVERSE)),
        statement="after an overrun the machine orders a standing, measured vehicle to reverse if that is permitted and the vehicle is "
        "surely not before the window, and possibly beyond it by no more than allowed",
    )


def _creeps_when_it_may(model: StopPoint) -> Iterator[Property]:
    own = model.own
    may = own.valid & own.precise & own.permitted & stands(own) & ~own.released
    where = (rearmost(own) < near_end(own)) & (foremost(own) <= far_end(own))
    yield for_all_inputs(
        "creeps when it may",
        (earlier_bool(model.in_mode("SHORT")) & may & where).implies(model.machine.output("order").eq(CREEP)),
        statement="after a short stop the machine orders a standing, measured vehicle to creep if that is permitted",
    )
