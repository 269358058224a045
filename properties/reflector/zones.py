"""Ends of zones without a measurement: too close, gone by, backed out of the search; and echoes that exclude each other."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, as_num, before, between, exact_to, with_unit
from safeloc.language.spec import Property, always
from safeloc.language.units import NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import FITS, Slot
from safeloc.models.reflector.variables import Parts
from safeloc.properties.reflector.figures import begun, foremost, looked_for, rearmost, seen_from, was

for_all_inputs = partial(always, requirements=("RFL-D2",), unconditional=True)


def zones(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of the ends of zones, in both directions of travel."""
    for maker in (_too_close, _gone_by, _search_left, _one_story):
        yield from maker(model)


def _too_close(model: ReflectorMachine) -> Iterator[Property]:
    own, target = model.own, model.own.target
    close = seen_from(own, target.position, target.view_to)
    yield for_all_inputs(
        "no echo is waited for when too close",
        model.in_mode("COAST").implies(foremost(own) < close),
        statement="the machine waits for an echo of an unmeasured reflector only while the vehicle surely is before the end of the view "
        "zone",
    )
    yield for_all_inputs(
        "too close only when it may be",
        (model.in_mode("PASSING") & was(model, "COAST", "VIEW")).implies(foremost(own) >= close),
        statement="passing begins only if the vehicle may be beyond the end of the view zone",
    )


def _gone_by(model: ReflectorMachine) -> Iterator[Property]:
    own, target = model.own, model.own.target
    offset = own.config.radar_offset_mm
    place, passed = exact_to(target.position + offset, NM), before(target.position)
    yield for_all_inputs(
        "passing goes on until it lies behind",
        (was(model, "PASSING") & model.in_mode("PASSING")).implies(rearmost(own) < place),
        statement="passing lasts until the whole interval lies beyond the reflector",
    )
    yield always(
        "a passed reflector lies behind the vehicle",
        (was(model, "PASSING") & model.in_mode("ODOMETRY")).implies(own.ghosts.truth >= exact_to(passed + offset, NM)),
        statement="when passing ends, the radar truly is beyond the reflector's place on the map",
        requirements=("RFL-D2",),
        assumption="odometer, balise, radar and map keep their laws",
    )


def _search_left(model: ReflectorMachine) -> Iterator[Property]:
    own, target = model.own, model.own.target
    begins = seen_from(own, target.position, target.view_from)
    yield for_all_inputs(
        "a reflector is searched only where it may be in view",
        model.in_mode("SEARCH").implies(foremost(own) >= begins),
        statement="the search lasts only while the vehicle may be in the view zone",
        requirements=("RFL-8",),
    )
    was_begun = seen_from(own, before(target.position), before(target.view_from))
    yield always(
        "the search is left only before the view zone",
        (was(model, "SEARCH") & model.in_mode("ODOMETRY")).implies(own.ghosts.truth < was_begun),
        statement="the search ends without an error only if the vehicle truly is before the view zone",
        requirements=("RFL-8", "RFL-D3"),
        assumption="odometer, balise, radar and map keep their laws",
    )


def _one_story(model: ReflectorMachine) -> Iterator[Property]:
    own, machine = model.own, model.machine
    of_target = machine.output("reflector_position_mm").eq(looked_for(own))
    alone = begun(own) | before(own.target.position).ne(own.ahead.position.value)
    by_target = machine.flag("precise") & of_target & alone
    first, *others = own.slots
    yield for_all_inputs(
        "echoes that exclude each other give no position",
        all_of(
            (by_target & first.last_verdict.eq(FITS) & other.last_verdict.eq(FITS)).implies(_agree(own, first, other))
            for other in others
        ),
        statement="a reflector gives the position only if every echo that fits it agrees with the reported one",
        requirements=("RFL-D3", "RFL-10"),
    )


def _agree(own: Parts, one: Slot, other: Slot) -> Bool:
    """Return whether both ranges agree, within the errors of echoes, survey and radar and the travel since the frame."""
    config = own.config
    share = -(-config.frame_latency_ms * 1_000_000 // config.period_ms)
    run_mm = -(-config.max_cycle_distance_mm * share // 1_000_000)
    more = as_num(0, NM) if own.odometer.more is None else own.odometer.more
    scale = with_unit((one.range.value + other.range.value) * config.radar_scale_ppm, NM)
    most = exact_to(one.error + other.error + 2 * (config.map_accuracy_mm + run_mm), NM) + more * 2 + scale
    apart = exact_to(one.range.value, NM) - exact_to(other.range.value, NM)
    return between(-most, apart, most)
