"""Beyond the window, before it, and held: each is told on a measurement only, and told whenever it is measured."""

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
    """When a stop is overrun, short or held, and when it is so no more."""
    for maker in (_overrun, _overrun_ends, _short, _too_far, _measured_again):
        yield from maker(model)


def _measured(model: StopPoint) -> Bool:
    """The distance to the reflector is measured in this cycle."""
    return model.own.valid & model.own.precise


def _overrun(model: StopPoint) -> Iterator[Property]:
    own, overrun = model.own, model.in_mode("OVERRUN")
    towards = earlier_bool(model.in_mode("APPROACH", "BRAKING", "CREEPING"))
    past = _measured(model) & (foremost(own) > far_end(own))
    yield for_all_inputs(
        "an overrun is told on a measurement only",
        (overrun & towards).implies(past),
        statement="a vehicle on its way to the stop is said to have overrun it only when it is measured to be possibly beyond "
        "the window",
    )
    yield for_all_inputs(
        "a measured overrun is told",
        (towards & past & own.pending.eq(before(own.pending))).implies(overrun),
        statement="a vehicle on its way to the pending stop that is measured to be possibly beyond the window is said to have "
        "overrun it",
    )
    yield for_all_inputs(
        "found beyond only by a fine measurement",
        (overrun & earlier_bool(model.in_mode("STOPPED", "SHORT"))).implies(
            past & stands(own) & (rearmost(own) >= near_end(own))
        ),
        statement="a vehicle that stood in the window or before it is said to stand beyond it only when it is measured to "
        "stand surely not before the window",
    )


def _overrun_ends(model: StopPoint) -> Iterator[Property]:
    own, was_beyond = model.own, earlier_bool(model.in_mode("OVERRUN"))
    back = _measured(model) & (foremost(own) <= far_end(own))
    yield for_all_inputs(
        "an overrun is taken back on a measurement only",
        (was_beyond & model.in_mode("BRAKING")).implies(back),
        statement="after an overrun the vehicle is braked for the stop again only when it is measured to be surely not beyond "
        "the window",
    )
    yield for_all_inputs(
        "an overrun is taken back",
        (was_beyond & back & ~own.released).implies(~model.in_mode("OVERRUN")),
        statement="a vehicle that is measured to be surely not beyond the window is no longer said to have overrun it",
    )


def _short(model: StopPoint) -> Iterator[Property]:
    own, short = model.own, model.in_mode("SHORT")
    before_it = _measured(model) & stands(own) & (rearmost(own) < near_end(own))
    yield for_all_inputs(
        "short only on a measurement",
        (short & ~earlier_bool(short)).implies(before_it),
        statement="a vehicle is said to have stopped short only when it is measured to stand possibly before the window",
    )
    yield for_all_inputs(
        "stopped short is told",
        (ordered_before(model).eq(BRAKE) & before_it & (foremost(own) <= far_end(own))).implies(short),
        statement="a braked vehicle that is measured to stand possibly before the window, and surely not beyond it, is said to "
        "have stopped short",
    )


def _too_far(model: StopPoint) -> Iterator[Property]:
    own, held = model.own, model.in_mode("HELD")
    limit = exact_to(own.stop + own.after + own.config.reposition_limit_mm, NM)
    enters = held & ~earlier_bool(held) & own.valid
    yield for_all_inputs(
        "too far only on a measurement",
        enters.implies(own.precise & stands(own) & (foremost(own) > limit)),
        statement="a vehicle is held for being too far beyond the window only when it is measured to stand possibly farther "
        "beyond it than may be repositioned",
    )
    yield for_all_inputs(
        "how much too far is shown",
        enters.implies((model.machine.output("distance_mm") + own.position).eq(own.stop)),
        statement="in the cycle in which a vehicle is found too far beyond the window, its distance to the stop is shown",
    )


def _measured_again(model: StopPoint) -> Iterator[Property]:
    own, was_held = model.own, earlier_bool(model.in_mode("HELD"))
    again = _measured(model) & stands(own) & before(own.reason).eq(NO_POSITION)
    yield for_all_inputs(
        "held until measured again",
        (was_held & model.in_mode("BRAKING")).implies(again),
        statement="a held vehicle is braked for its stop again only if it was held for a lost position, and is measured to stand",
    )
    yield for_all_inputs(
        "measured again, the stop goes on",
        (was_held & again & ~own.released).implies(model.in_mode("BRAKING")),
        statement="a vehicle that was held for a lost position is braked for its stop again when it is measured to stand",
    )
    yield for_all_inputs(
        "braked for the stop, it is ordered to brake",
        model.in_mode("BRAKING").implies(model.machine.output("order").eq(BRAKE)),
        statement="from the brake order until the vehicle stands, the order to brake is given",
    )
