"""Beyond the window, before it, and held: each state needs a measurement, and each such measurement leads to it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, before, exact_to
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import BRAKE, NO_POSITION
from safeloc.properties.stop_point.place import (
    REQUIREMENTS,
    far_end,
    foremost,
    near_end,
    ordered_before,
    rearmost,
    stands,
)

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def beyond(model: StopPoint) -> Iterator[Property]:
    """Yield the properties of the beginning and end of OVERRUN, SHORT and HELD."""
    for maker in (_overrun, _overrun_ends, _short, _too_far, _measured_again):
        yield from maker(model)


def _measured(model: StopPoint) -> Bool:
    """Return whether the distance to the reflector is measured in this cycle."""
    return model.own.valid & model.own.precise


_TOWARDS, _STOOD = ("APPROACH", "BRAKING", "CREEPING"), ("STOPPED", "SHORT")


def _overrun(model: StopPoint) -> Iterator[Property]:
    own, overrun = model.own, model.in_mode("OVERRUN")
    towards, stood = (earlier_bool(model.in_mode(*some)) for some in (_TOWARDS, _STOOD))
    past = _measured(model) & (foremost(own) > far_end(own))
    yield for_all_inputs(
        "an overrun is reported on a measurement only",
        (overrun & towards).implies(past),
        statement="the machine reports an overrun of a vehicle on its way to the stop only if the vehicle, as measured, is possibly beyond the window",
    )
    yield for_all_inputs(
        "a measured overrun is reported",
        (towards & past & own.pending_number.eq(before(own.pending_number))).implies(overrun),
        statement="the machine reports an overrun if a vehicle on its way to the pending stop, as measured, is possibly beyond the window",
    )
    yield for_all_inputs(
        "found beyond only by a fine measurement",
        (overrun & stood).implies(past & stands(own) & (rearmost(own) >= near_end(own))),
        statement="the machine reports an overrun of a vehicle that stood in the window or before it only if the vehicle, as "
        "measured, is possibly beyond the window and surely not before it",
    )


def _overrun_ends(model: StopPoint) -> Iterator[Property]:
    own, was_beyond = model.own, earlier_bool(model.in_mode("OVERRUN"))
    back = _measured(model) & (foremost(own) <= far_end(own))
    yield for_all_inputs(
        "an overrun is taken back on a measurement only",
        (was_beyond & model.in_mode("BRAKING")).implies(back),
        statement="after an overrun the machine brakes for the stop again only if the vehicle, as measured, is surely not beyond the "
        "window",
    )
    yield for_all_inputs(
        "an overrun is taken back",
        (was_beyond & back & ~own.released).implies(~model.in_mode("OVERRUN")),
        statement="the machine ends the overrun of a vehicle that, as measured, is surely not beyond the window",
    )


def _short(model: StopPoint) -> Iterator[Property]:
    own, short = model.own, model.in_mode("SHORT")
    before_it = _measured(model) & stands(own) & (rearmost(own) < near_end(own))
    yield for_all_inputs(
        "short only on a measurement",
        (short & ~earlier_bool(short)).implies(before_it),
        statement="the machine reports that a vehicle stopped short only if the vehicle, as measured, stands possibly before the window",
    )
    yield for_all_inputs(
        "stopping short is reported",
        (ordered_before(model).eq(BRAKE) & before_it & (foremost(own) <= far_end(own))).implies(short),
        statement="the machine reports that a braked vehicle stopped short if the vehicle, as measured, stands possibly before the "
        "window and surely not beyond it",
    )


def _too_far(model: StopPoint) -> Iterator[Property]:
    own, held = model.own, model.in_mode("HELD")
    limit = exact_to(own.stop + own.after + own.config.reposition_limit_mm, NM)
    enters = held & ~earlier_bool(held) & own.valid
    yield for_all_inputs(
        "too far only on a measurement",
        enters.implies(own.precise & stands(own) & (foremost(own) > limit)),
        statement="the machine holds a vehicle for being too far beyond the window only if the vehicle, as measured, stands possibly "
        "farther beyond it than it may reposition",
    )
    yield for_all_inputs(
        "how much too far is shown",
        enters.implies((model.machine.output("distance_mm") + own.position).eq(own.stop)),
        statement="in the cycle in which the machine finds a vehicle too far beyond the window, it shows the distance to the stop",
    )


def _measured_again(model: StopPoint) -> Iterator[Property]:
    own, was_held = model.own, earlier_bool(model.in_mode("HELD"))
    again = _measured(model) & stands(own) & before(own.reason).eq(NO_POSITION)
    yield for_all_inputs(
        "held until measured again",
        (was_held & model.in_mode("BRAKING")).implies(again),
        statement="the machine brakes a held vehicle for its stop again only if it held it for a lost position and measures a standstill",
    )
    yield for_all_inputs(
        "measured again, the stop goes on",
        (was_held & again & ~own.released).implies(model.in_mode("BRAKING")),
        statement="the machine brakes a vehicle held for a lost position for its stop again when it measures a standstill",
    )
    yield for_all_inputs(
        "braked for the stop, it is ordered to brake",
        model.in_mode("BRAKING").implies(model.machine.output("order").eq(BRAKE)),
        statement="in BRAKING the machine orders to brake",
    )
