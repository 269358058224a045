"""Selection of a stop point, its refusal, and the end of a pending stop."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, any_of, before, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import NO_ORDER, NO_REASON, NOT_AHEAD, PROCEED, UNKNOWN_STOP
from safeloc.properties.stop_point.place import LAW, REQUIREMENTS, far_end, foremost, ordered_before

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def selection(model: StopPoint) -> Iterator[Property]:
    """Yield the properties of selection, refusal, and the end of a pending stop."""
    for maker in (_as_the_map_has_it, _ahead, _kept, _left, _served, _anew, _accepted, _unknown, _behind, _unrefused):
        yield from maker(model)


def _selects(model: StopPoint) -> Bool:
    """Return whether another stop is pending than before."""
    return model.own.pending_number.ne(before(model.own.pending_number)) & (model.own.pending_number > 0)


def _mapped(model: StopPoint, number: int) -> Bool:
    """Return whether the pending stop is the selected one, with the place and window of that number on the map."""
    own, stop = model.own, model.own.stops[number - 1]
    return (
        stop.position.present
        & own.stop.eq(stop.position.value)
        & own.before.eq(stop.before)
        & own.after.eq(stop.after)
        & own.selected_stop.present
        & own.selected_stop.value.eq(number)
    )


def _as_the_map_has_it(model: StopPoint) -> Iterator[Property]:
    own, order = model.own, model.machine.output("order")
    yield for_all_inputs(
        "the pending stop is the selected one of the map",
        all_of(
            (_selects(model) & own.pending_number.eq(number)).implies(_mapped(model, number))
            for number in range(1, len(own.stops) + 1)
        ),
        statement="a stop that becomes pending is the one that the mission selects, with its place and window on the map",
    )
    yield for_all_inputs(
        "an order belongs to a stop",
        ite(own.pending_number > 0, order.ne(NO_ORDER), order.eq(NO_ORDER)),
        statement="the machine gives an order exactly while a stop is pending",
    )


def _ahead(model: StopPoint) -> Iterator[Property]:
    own = model.own
    yield always(
        "only a stop ahead is selected",
        _selects(model).implies(own.valid & (own.truth <= far_end(own))),
        statement="a stop becomes pending only on a valid position, and while the vehicle stands or runs before the far end "
        "of its window",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )


def _kept(model: StopPoint) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "the stop stays after the brake order",
        (~ordered_before(model).one_of(NO_ORDER, PROCEED) & ~model.in_mode("IDLE")).implies(
            all_of(var.eq(before(var)) for var in (own.stop, own.before, own.after, own.pending_number))
        ),
        statement="after the brake order another selection no longer changes the stop",
    )
    yield for_all_inputs(
        "the stop moves only with another selection",
        (own.pending_number.eq(before(own.pending_number))).implies(
            all_of(var.eq(before(var)) for var in (own.stop, own.before, own.after))
        ),
        statement="while the same stop is pending, its place and window stay the same",
    )


def _left(model: StopPoint) -> Iterator[Property]:
    own, idle = model.own, model.in_mode("IDLE")
    yield for_all_inputs(
        "a stop is left only when served or released",
        (earlier_bool(model.in_mode("BRAKING", "STOPPED", "SHORT", "CREEPING", "OVERRUN", "REPOSITIONING", "HELD")) & idle)
        .implies(
            (own.departure & own.valid & earlier_bool(model.in_mode("STOPPED")))
            | (own.released & earlier_bool(model.in_mode("HELD", "SHORT", "OVERRUN")))
        ),
        statement="from the brake order on a pending stop ends only by departure from its place, or if the person in charge releases a "
        "vehicle that stands elsewhere")  # fmt: skip
    yield for_all_inputs(
        "served or released, a stop is left",
        (
            (own.valid & own.departure & earlier_bool(model.in_mode("STOPPED")))
            | (own.released & earlier_bool(model.in_mode("HELD", "SHORT", "OVERRUN")))
        ).implies(idle),
        statement="a departure order in place ends the stop, and so does the release of a vehicle that stands elsewhere",
    )


def _served(model: StopPoint) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "a served stop is not selected at once again",
        (_selects(model) & earlier_bool(model.in_mode("IDLE"))).implies(
            own.pending_number.ne(before(own.served_number))
        ),
        statement="a stop that was just served becomes pending again only after another selection, or none",
    )
    left = earlier_bool(~model.in_mode("APPROACH", "IDLE")) & model.in_mode("IDLE")
    yield for_all_inputs(
        "a stop that was left counts as served",
        left.implies(own.served_number.eq(before(own.pending_number))),
        statement="a stop that ended by departure or release counts as served",
    )
    yield for_all_inputs(
        "a stop that was left leaves no reason",
        left.implies(own.reason.eq(NO_REASON)),
        statement="when a stop ends, its reason is no longer shown",
    )


def _anew(model: StopPoint) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "a stop begins anew",
        _selects(model).implies(own.served_number.eq(0) & own.reason.eq(NO_REASON)),
        statement="when a stop becomes pending, no reason is shown, and the stop that was served before may be selected again",
    )
    yield for_all_inputs(
        "served is forgotten with the selection",
        (model.in_mode("IDLE") & (~own.selected_stop.present)
         & earlier_bool(model.in_mode("APPROACH", "IDLE"))).implies(own.served_number.eq(0) | ~own.valid),
        statement="with no stop selected, the stop that was served before may be selected again")  # fmt: skip


def _selectable(model: StopPoint, number: int) -> Bool:
    own, stop = model.own, model.own.stops[number - 1]
    ends = exact_to(stop.position.value, NM) + exact_to(stop.after, NM)
    named = own.selected_stop.present & own.selected_stop.value.eq(number) & stop.position.present
    return named & own.valid & (foremost(own) <= ends) & before(own.served_number).ne(number)


def _accepted(model: StopPoint) -> Iterator[Property]:
    own, free = model.own, earlier_bool(model.in_mode("IDLE"))
    yield for_all_inputs(
        "a stop ahead is selected",
        all_of(
            (free & _selectable(model, number)).implies(own.pending_number.eq(number))
            for number in range(1, len(own.stops) + 1)
        ),
        statement="a selected stop that is on the map, surely lies ahead and was not just served becomes pending",
    )


def _waits(model: StopPoint) -> Bool:
    """Return whether no stop is pending, neither before nor after the step."""
    return model.in_mode("IDLE") & earlier_bool(model.in_mode("IDLE"))


def _not_on_the_map(model: StopPoint) -> Bool:
    own = model.own
    return own.selected_stop.present & ~any_of(
        stop.position.present & own.selected_stop.value.eq(number) for number, stop in enumerate(own.stops, 1)
    )


def _unknown(model: StopPoint) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "a stop that is not on the map is refused",
        (_waits(model) & _not_on_the_map(model)).implies(own.reason.eq(UNKNOWN_STOP)),
        statement="the machine refuses a selected stop that is not on the map, with that reason",
    )


def _behind(model: StopPoint) -> Iterator[Property]:
    own, waits, unknown = model.own, _waits(model), _not_on_the_map(model)
    yield for_all_inputs(
        "a stop that is not ahead is refused",
        all_of(
            (waits & own.valid & ~unknown & own.selected_stop.value.eq(number) & before(own.served_number).ne(number)
             & (foremost(own) > exact_to(stop.position.value, NM) + exact_to(stop.after, NM)))
            .implies(own.reason.eq(NOT_AHEAD) | ~own.selected_stop.present)
            for number, stop in enumerate(own.stops, 1)
        ),
        statement="the machine refuses a selected stop that possibly lies behind, with that reason")  # fmt: skip
    yield for_all_inputs(
        "refused for lying behind only when it may",
        (own.reason.eq(NOT_AHEAD) & before(own.reason).ne(NOT_AHEAD)).implies(
            own.valid & own.selected_stop.present & any_of(
                stop.position.present & own.selected_stop.value.eq(number) & before(own.served_number).ne(number)
                & (foremost(own) > exact_to(stop.position.value, NM) + exact_to(stop.after, NM))
                for number, stop in enumerate(own.stops, 1)
            )
        ),
        statement="the machine refuses a stop for lying behind only with a valid position, and only if the stop is on the map, was "
        "not just served, and possibly lies behind")  # fmt: skip


def _unrefused(model: StopPoint) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "a pending stop is not refused",
        model.machine.output("order").eq(PROCEED).implies(~own.reason.one_of(UNKNOWN_STOP, NOT_AHEAD))
        & (~own.selected_stop.present & _waits(model)).implies(own.reason.eq(NO_REASON)),
        statement="the machine gives no reason for a refusal while the vehicle may proceed to a stop, or while none is selected",
    )
