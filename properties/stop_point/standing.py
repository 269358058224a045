"""Standing: in the window, before it or beyond it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import between
from safeloc.language.spec import Property, always, earlier_bool, once, reachable
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import BRAKE, HOLD
from safeloc.properties.stop_point.place import (
    LAW,
    REQUIREMENTS,
    far_end,
    fits,
    near_end,
    ordered_before,
    stands,
    width,
)

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def standing(model: StopPoint) -> Iterator[Property]:
    """Yield the properties of a standing vehicle."""
    for maker in (_in_position, _comes_to_stand, _reported_when_it_stands, _found_short_or_beyond):
        yield from maker(model)
    yield reachable(
        "repositioned",
        model.machine.flag("in_position") & once(model.machine.fired("repositions")),
        statement="a vehicle that ran too far can come to stand in position",
        requirements=REQUIREMENTS,
    )


def _in_position(model: StopPoint) -> Iterator[Property]:
    own, place = model.own, model.machine.flag("in_position")
    fine = width(own) <= far_end(own) - near_end(own)
    yield under_assumption(
        "in position within the window",
        (place & own.precise & fine).implies(between(near_end(own), own.truth, far_end(own))),
        statement="a vehicle reported in position is within the stop window, whenever the measurement is no coarser than the window",
    )
    slowest = own.config.standstill_mm_s + own.config.speed_error_mm_s
    yield under_assumption(
        "in position it stands",
        place.implies(between(-slowest, own.true_speed, slowest)),
        statement="a vehicle reported in position truly stands, up to the speed error",
    )


def _comes_to_stand(model: StopPoint) -> Iterator[Property]:
    own, place = model.own, model.machine.flag("in_position")
    comes = place & ~earlier_bool(place)
    yield for_all_inputs(
        "in position only on a measurement",
        comes.implies(own.valid & own.precise & stands(own)),
        statement="the machine first reports a vehicle in position only at standstill and with a measured distance",
    )
    yield under_assumption(
        "it comes to stand within the window",
        comes.implies(between(near_end(own), own.truth, far_end(own))),
        statement="when the machine first reports a vehicle in position, its front end truly is within the stop window",
    )


def _reported_when_it_stands(model: StopPoint) -> Iterator[Property]:
    own, place = model.own, model.machine.flag("in_position")
    measured = own.valid & own.precise & stands(own) & ~own.released
    yield for_all_inputs(
        "in position when it stands there",
        ((ordered_before(model).eq(BRAKE) | earlier_bool(model.in_mode("OVERRUN", "SHORT"))) & measured & fits(own)).implies(
            place
        ),
        statement="the machine reports a braked or stopped vehicle in position if the vehicle, as measured, stands within the window")  # fmt: skip
    yield for_all_inputs(
        "it stays in position",
        (earlier_bool(place) & own.valid & stands(own) & ~own.departure & (fits(own) | ~own.precise)).implies(place),
        statement="a vehicle stays in position while it stands and no measurement contradicts that, until it departs",
    )


def _found_short_or_beyond(model: StopPoint) -> Iterator[Property]:
    own, place = model.own, model.machine.flag("in_position")
    order = model.machine.output("order")
    yield for_all_inputs(
        "out of the window it is not in position",
        (earlier_bool(place) & own.valid & own.precise & ~fits(own) & (width(own) <= far_end(own) - near_end(own))
         & ~own.departure).implies(~place),
        statement="a vehicle that, as measured, is not surely within the window is no longer in position")  # fmt: skip
    yield for_all_inputs(
        "out of the window it is held or braked",
        (earlier_bool(place) & ~place & ~own.departure).implies(order.one_of(BRAKE, HOLD)),
        statement="if a vehicle is no longer in position and did not depart, the machine orders to hold or to brake",
    )
