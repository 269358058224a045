"""The reports and their absence: tolerance, silence of the odometer, reasons, the movement authority."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, any_of, as_num, between, ite, maximum, minimum, with_unit
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.route import Route
from safeloc.models.route.variables import NO_REASON, SENSOR_FAILURE, TOLERANCE, Hypothesis, Parts
from safeloc.models.vocabulary.absent import NO_POSITION_MM
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.no_interval import no_interval
from safeloc.properties.route.figures import REQUIREMENTS, CycleEvidence, bounds, carried, given_up, ran

for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def reports(model: Route) -> Iterator[Property]:
    """Yield the properties of the outputs."""
    for maker in (_silent, _wide, _odometer, _reasons, _authority):
        yield from maker(model)


def _silent(model: Route) -> Iterator[Property]:
    machine, silent = model.machine, all_of(~route.possible for route in model.own.routes)
    yield for_all_inputs(
        "nothing is reported without a start",
        carried(model) | (silent & machine.output("route").eq(0)),
        statement="in IDLE and LOST the machine reports no route and no interval",
    )
    yield for_all_inputs(
        "no route left is no report",
        silent.implies(~carried(model)),
        statement="in a cycle in which no route is possible, the machine reports nothing",
    )
    yield for_all_inputs(
        "no place on a route that is refuted",
        all_of(
            [machine.flag("valid") | no_interval(machine), *(_no_place(model, route) for route in model.own.routes)]
        ),
        statement="an impossible route has no reported interval, and while no route is decided there is no position",
    )
    yield for_all_inputs(
        "no resurrection",
        (carried(model) & ~earlier_bool(carried(model))).implies(model.own.start_error.present),
        statement="after a loss the machine reports again only from a new start on, with a reference of its own",
    )


def _no_place(model: Route, route: Hypothesis) -> Bool:
    ends = (model.machine.output(f"route_{route.number}_{end}_mm") for end in ("low", "high"))
    return route.possible | all_of(end.eq(NO_POSITION_MM) for end in ends)


def _wide(model: Route) -> Iterator[Property]:
    own, most = model.own, as_num(2 * model.own.config.tolerance_mm * NM_PER_MM, NM)
    widths = [high - low <= most for low, high in (bounds(model, route) for route in own.routes)]
    yield for_all_inputs(
        "tolerance",
        all_of(widths),
        statement="no reported interval is wider than twice the tolerable error",
        requirements=("RFL-D6", "RFL-D1"),
    )
    lost = given_up(model) & own.reason.eq(TOLERANCE)
    yield for_all_inputs(
        "given up for its width only where it may be too wide",
        lost.implies(any_of(_may_be_too_wide(own, CycleEvidence(own, route)) for route in own.routes)),
        statement="the machine gives the routes up for tolerance only if the interval of one that is left, run on and narrowed by what is sighted, may be "
        "wider than tolerable to the mm, or reach beyond the line",
        requirements=("RFL-D6", "RFL-D1"),
    )


def _may_be_too_wide(own: Parts, evidence: CycleEvidence) -> Bool:
    (least, most), config, line = ran(own), own.config, own.config.length_limit_mm * NM_PER_MM
    low, high, unheard = evidence.low + least, evidence.high + most, evidence.silent
    low = ite(unheard, low, maximum(low, evidence.place - evidence.slack))
    high = ite(unheard, high, minimum(high, evidence.place + evidence.slack))
    wide = high - low > 2 * ((config.tolerance_mm - 1) * NM_PER_MM - own.half_nm)
    return ~evidence.refuted & any_of([wide, low < -line, high > line])


def _odometer(model: Route) -> Iterator[Property]:
    own, odometer = model.own, model.own.odometer
    yield for_all_inputs(
        "a distance is admitted just if it can have been run",
        odometer.last_verdict.eq(ADMITTED).iff(all_of([odometer.measured.present, *_can_be_run(own)])),
        statement="a distance is used exactly if the top speed allows it and, where no other machine checked it, the greatest change of speed "
        "since the last one",
    )
    counted = odometer.gap.eq(earlier_num(odometer.gap) + 1) | odometer.gap.eq(own.config.gap_limit_cycles + 1)
    yield for_all_inputs(
        "silent cycles are counted",
        (odometer.last_verdict.eq(ADMITTED) & odometer.gap.eq(0)) | (odometer.last_verdict.ne(ADMITTED) & counted),
        statement="the machine counts the cycles without a usable distance, up to one more than permitted",
    )
    too_long = odometer.gap > own.config.gap_limit_cycles
    yield for_all_inputs(
        "a silent odometer ends the report",
        (earlier_bool(carried(model)) & ~own.start_error.present).implies(own.reason.eq(SENSOR_FAILURE).iff(too_long)),
        statement="the machine gives the routes up for the odometer exactly if that was silent for longer than permitted",
        requirements=("RFL-D6", "RFL-D1"),
    )


def _can_be_run(own: Parts) -> tuple[Bool, ...]:
    """Return whether top speed and, of a distance that nobody checked, greatest acceleration allow it, rounded up to mm, with the measuring steps."""
    config, step = own.config, own.odometer.measured.value
    farthest = config.measuring_step_mm + math.ceil(config.max_speed_mm_s * config.period_ms / 1_000)
    change = 2 * config.measuring_step_mm + math.ceil(config.max_acceleration_mm_s2 * config.period_ms**2 / 1_000_000)
    silent, faster = earlier_num(own.odometer.gap), step - earlier_num(own.odometer.last)
    allowed = with_unit(silent * change, MM) + change
    measured_lately = silent <= config.gap_limit_cycles
    if config.checked_distance:
        return (between(-farthest, step, farthest),)
    return between(-farthest, step, farthest), measured_lately.implies((faster <= allowed) & (-faster <= allowed))


def _reasons(model: Route) -> Iterator[Property]:
    yield for_all_inputs(
        "reason stated",
        model.own.reason.eq(NO_REASON).iff(carried(model)),
        statement="the machine gives a reason exactly while it reports no route",
    )


def _authority(model: Route) -> Iterator[Property]:
    own, machine = model.own, model.machine
    refuted = any_of(own.authorised_route.eq(route.number) & ~route.possible for route in own.routes)
    yield for_all_inputs(
        "authority",
        carried(model).implies(machine.flag("refutes_authority").iff(refuted)),
        statement="the machine reports in the same cycle that the route of the movement authority is refuted",
        requirements=("RFL-D6", "RFL-12"),
    )


def reached(model: Route) -> Iterator[Property]:
    """Yield, for each route, that it can be decided; and that the world has reflectors of other tracks."""
    for route in model.own.routes:
        yield reachable(
            f"route {route.number} is decided after others were possible",
            model.machine.fired("one route is left") & route.possible,
            statement="sightings can distinguish the route from the others",
            requirements=REQUIREMENTS,
        )
    own, first = model.own, model.own.routes[0]
    foreign = all_of([own.ghosts.elsewhere, own.sighting_range.present, own.sighting_model.ne(NO_MODEL)])
    yield reachable(
        "another track's reflector is sighted on route 1",
        all_of([foreign, own.ghosts.route.eq(first.number), first.possible, ~own.start_error.present]),
        statement="the world has reflectors of other tracks in view: such a sighting leaves the route on which the vehicle runs possible",
        requirements=REQUIREMENTS,
    )
