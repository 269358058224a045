"""What must hold of the precise stop at a platform (RFL-D7)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import all_of, between, exact_to
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, never, once, reachable
from safeloc.language.units import NM
from safeloc.models.stop_point import BRAKE, CREEP, HOLD, NO_ORDER, PROCEED, REVERSE, StopPoint
from safeloc.models.stop_point.variables import NO_REASON, TOO_COARSE
from safeloc.properties.in_step import in_step

LAW = "a valid interval holds the true position; speed is measured within its error"
TRACE = ("RFL-D7",)


def properties(model: StopPoint) -> list[Property]:
    """Every property of the stop-point machine."""
    return [prop for maker in (_forwards, _backwards, _stopping, _order) for prop in maker(model)]


def _forwards(model: StopPoint) -> Iterator[Property]:
    """Towards the platform's end."""
    own, cycle = model.own, model.judged
    order = model.machine.output("order")
    ends = exact_to(own.stop + own.after, NM)
    yield always(
        "never on beyond the window",
        order.one_of(PROCEED, CREEP).implies(own.truth <= ends),
        statement="while a stop is pending, no order to go on or to start towards the platform's end is given to a vehicle "
        "that stands or runs beyond the stop window",
        requirements=TRACE,
        assumption=LAW,
    )
    yield always(
        "creeping is slow",
        order.eq(CREEP).implies(own.true_speed <= own.config.reduced_speed_mm_s),
        statement="the order to creep into the window is taken back before the vehicle can be faster than the reduced speed",
        requirements=TRACE,
        assumption=LAW,
    )
    yield always(
        "brake order in time",
        (order.eq(PROCEED) & earlier_num(model.machine.output("order")).eq(PROCEED) & own.pending.eq(
            earlier_num(own.pending))).implies(
            model.machine.fired("another stop selected") | in_step(model.machine, ~cycle.brake_now)
        ),
        statement="the vehicle may proceed only while the braking distance from its speed, with reaction and speed error, is "
        "shorter than the distance to the stop",
        requirements=TRACE,
        unconditional=True,
    )  # fmt: skip


def _backwards(model: StopPoint) -> Iterator[Property]:
    own, machine = model.own, model.machine
    order = machine.output("order")
    yield always(
        "reversing is slow",
        order.eq(REVERSE).implies(-own.true_speed <= own.config.reduced_speed_mm_s),
        statement="the order to reverse is never given, and never upheld, to a vehicle that may run backwards faster than the "
        "reduced speed",
        requirements=TRACE,
        assumption=LAW,
    )
    yield always(
        "reversing is permitted and measured",
        order.eq(REVERSE).implies(own.permitted & own.precise & own.valid),
        statement="reversing needs, in every cycle, the permission and a measured distance to the reflector",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "reversing begins at standstill",
        (order.eq(REVERSE) & earlier_num(order).ne(REVERSE)).implies(
            in_step(machine, model.judged.standing & model.judged.beyond & ~model.judged.too_far)
            & earlier_bool(model.in_mode("OVERRUN"))
        ),
        statement="reversing begins only at standstill, after an overrun, and no farther beyond the window than allowed",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "reversing ends in the window",
        order.eq(REVERSE).implies(in_step(machine, model.judged.beyond)),
        statement="the order to reverse ends when the vehicle is no longer possibly beyond the window",
        requirements=TRACE,
        unconditional=True,
    )


def _stopping(model: StopPoint) -> Iterator[Property]:
    own, machine = model.own, model.machine
    place = machine.flag("in_position")
    window = between(exact_to(own.stop - own.before, NM), own.truth, exact_to(own.stop + own.after, NM))
    yield always(
        "in position within the window",
        (place & own.precise & own.reason.ne(TOO_COARSE)).implies(window),
        statement="a vehicle that is said to be in position stands within the stop window, whenever the measurement is fine "
        "enough to tell",
        requirements=TRACE,
        assumption=LAW,
    )
    yield always(
        "in position only on a measurement",
        (place & ~earlier_bool(place)).implies(own.precise & in_step(machine, model.judged.standing)),
        statement="a vehicle is said to be in position only at standstill and on a measured distance",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "the stop stays after the brake order",
        (earlier_bool(model.in_mode("BRAKING")) & ~model.in_mode("IDLE")).implies(
            all_of(var.eq(earlier_num(var)) for var in (own.stop, own.before, own.after, own.pending))
        ),
        statement="after the brake order another selection no longer moves the stop",
        requirements=TRACE,
        unconditional=True,
    )
    yield reachable(
        "repositioned",
        place & once(machine.fired("repositions")),
        statement="a vehicle that ran too far comes to stand in position",
        requirements=TRACE,
    )


def _order(model: StopPoint) -> Iterator[Property]:
    own, machine = model.own, model.machine
    order = machine.output("order")
    yield always(
        "without a position nothing moves",
        (~own.valid).implies(order.one_of(NO_ORDER, HOLD)),
        statement="in the step in which the position is lost, a pending stop holds the vehicle",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "held with a reason",
        model.in_mode("HELD").implies(own.reason.ne(NO_REASON) & order.eq(HOLD)),
        statement="a stop that cannot be made holds the vehicle and says why",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "a stop is left only when served or released",
        (earlier_bool(model.in_mode("STOPPED", "SHORT", "OVERRUN", "HELD")) & model.in_mode("IDLE")).implies(
            own.departure | own.released
        ),
        statement="a pending stop ends by departure from its place, or because whoever is in charge releases it",
        requirements=TRACE,
        unconditional=True,
    )
    yield never(
        "no movement out of the brake order",
        earlier_num(order).eq(BRAKE) & order.one_of(PROCEED, CREEP, REVERSE),
        statement="after the brake order comes standstill, an overrun or a hold; never at once an order to move",
        requirements=TRACE,
        unconditional=True,
    )
