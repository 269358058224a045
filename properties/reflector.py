"""What must hold of position by reflectors and odometry between them (RFL-1 to RFL-3, -5, -6, -8, -10, -D2, -D3)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import (
    Bool,
    all_of,
    any_of,
    as_num,
    between,
    exact_to,
)
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable, since, within
from safeloc.language.units import MM, NM
from safeloc.models.layout_rules import LayoutConfig, separable_by_distance
from safeloc.models.reflector import BY_REFLECTOR, ReflectorMachine
from safeloc.models.reflector.dead_reckoning import Interval
from safeloc.models.reflector.echo import AMBIGUOUS, FITS, Judgement
from safeloc.models.reflector.map_data import Reflector, is_it
from safeloc.models.reflector.variables import NO_ERROR, ReflectorConfig
from safeloc.models.vocabulary.error_law import NM_PER_MM
from safeloc.properties.in_step import in_step, num_in_step

LAW = (
    "odometer and balise keep their error laws; echoes of reflectors give their range within the error bound; models "
    "are read correctly at the minimum intensity; the map's distances between equal models are right; no other thing "
    "shows the looked-for model with the minimum intensity where it fits"
)
READY = ("ODOMETRY", "SEARCH", "VIEW", "COAST", "PASSING")
PASSED = ("self-test passed", "self-test passed at the balise")
FAILED = ("self-test failed", "self-test failed at the balise")
SIGHTED = (*PASSED, "reflector found", "reflector tracked", "next reflector takes over")


def properties(model: ReflectorMachine) -> list[Property]:
    """Every property of the reflector machine."""
    makers = (_safety, _identity, _view, _search, _leaving, _self_test, _failed_test, _rejection, _availability)
    return [prop for maker in makers for prop in maker(model)]


def _safety(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, position = machine.flag("valid"), exact_to(machine.output("position_mm"), NM)
    over, under = exact_to(machine.output("over_mm"), NM), exact_to(machine.output("under_mm"), NM)
    yield always(
        "containment",
        valid.implies(between(position - under, own.ghosts.truth, position + over)),
        statement="in every zone the reported interval holds the true position of end A",
        requirements=("RFL-1", "RFL-2", "RFL-3", "RFL-5", "RFL-D2"),
        assumption=LAW,
    )
    tolerance = own.config.tolerance_mm
    yield always(
        "tolerance",
        (machine.output("over_mm") <= tolerance) & (machine.output("under_mm") <= tolerance),
        statement="a reported interval is never wider than the tolerable error, on either side",
        requirements=("RFL-1",),
        unconditional=True,
    )
    names = ("position_mm", "over_mm", "under_mm", "range_mm", "reflector_position_mm")
    yield always(
        "no report when invalid",
        (~valid).implies(all_of(machine.output(name).eq(0) for name in names) & ~machine.flag("precise")),
        statement="nothing is reported without a valid position",
        requirements=("RFL-1", "RFL-D3"),
        unconditional=True,
    )
    yield always(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(
            in_step(machine, own.balise.read & ~own.contradicted & ~own.odometer.failed)
        ),
        statement="a position is reported again only through a balise",
        requirements=("RFL-5", "RFL-D3"),
        unconditional=True,
    )
    yield always(
        "error stated",
        own.error.eq(NO_ERROR).iff(machine.flag("ready")),
        statement="whenever the machine is not ready for precise positioning, it says why",
        requirements=("RFL-6", "RFL-D3"),
        unconditional=True,
    )


def _identity(model: ReflectorMachine) -> Iterator[Property]:
    """A reflector is never taken for another, nor anything else for a reflector."""
    cycle, own = model.judged, model.own
    looked_for = (
        ("target", cycle.target.judgements, cycle.reflector),
        ("next reflector", cycle.ahead.judgements, own.ahead.reflector),
    )
    for name, judgements, reflector in looked_for:
        yield always(
            f"the {name} is never mistaken",
            all_of(_is_what_it_seems(model, one, reflector) for one in judgements),
            statement=f"an echo that fits the {name} was reflected by that very reflector, however many others the line "
            "has",
            requirements=("RFL-3", "RFL-10"),
            assumption=LAW,
        )


def _is_what_it_seems(model: ReflectorMachine, one: Judgement, reflector: Reflector) -> Bool:
    origin, config = model.own.ghosts.origin[one.slot.number - 1], model.own.config
    itself = is_it(reflector, origin, config.radar_offset_mm, config.accuracy_nm)
    return in_step(model.machine, one.fits.implies(itself))


def _view(model: ReflectorMachine) -> Iterator[Property]:
    """The view zone: what begins it, and whose margins count in it (RFL-1, figures 001 items 1 and 10)."""
    machine, own, cycle = model.machine, model.own, model.judged
    precise = machine.flag("precise")
    minimum = own.config.minimum_intensity_cdb
    strong = [
        slot.range.present
        & own.frame
        & (slot.intensity >= minimum)
        & (slot.judged.eq(FITS) | slot.judged_next.eq(FITS))
        for slot in own.slots
    ]
    yield always(
        "minimum intensity",
        (precise | machine.output("source").eq(BY_REFLECTOR)).implies(any_of(strong)),
        statement="only an echo with the minimum intensity, judged to fit, makes the reflector the source of the position; "
        "without one the source is never the reflector",
        requirements=("RFL-1", "RFL-10"),
        unconditional=True,
    )
    both = (*cycle.target.judgements, *cycle.ahead.judgements)
    yield always(
        "the radar's own bound",
        precise.implies(any_of(_reports(model, one) for one in both)),
        statement="in the view zone the interval is that of one fitting echo: its range from the reflector's place, its "
        "error bound and the survey's; never narrower because of what was known before",
        requirements=("RFL-2", "RFL-3", "RFL-D2"),
        unconditional=True,
    )


def _search(model: ReflectorMachine) -> Iterator[Property]:
    """Before the view zone: what is looked for, from where on, and what else is not (RFL-8, figures 001 items 6, 7, 19)."""
    machine, own, cycle = model.machine, model.own, model.judged
    precise = machine.flag("precise")
    yield always(
        "clutter is no reflector",
        (_was(model, "ODOMETRY", "NOT_READY", "DELOCALIZED") & ~in_step(machine, cycle.started)).implies(
            ~precise & ~own.recognised
        ),
        statement="in the odometry zone no echo, however strong, is taken for a reflector",
        requirements=("RFL-1", "RFL-10"),
        unconditional=True,
    )
    yield always(
        "never too early",
        (model.in_mode("SEARCH") & ~_was(model, "SEARCH")).implies(
            own.target.reflector.roomy(own.track.interval)
            & (own.track.interval.high >= own.target.reflector.view_begins())
        ),
        statement="the search begins as early as the odometry error asks for, and only if no other reflector of the model "
        "fits into the interval",
        requirements=("RFL-1", "RFL-8"),
        unconditional=True,
    )
    yield always(
        "no unfit neighbour",
        (model.in_mode("VIEW") & ~_was(model, "VIEW")).implies(machine.fired(*SIGHTED)),
        statement="the view zone begins with a measurement of the reflector that was looked for, and with nothing else",
        requirements=("RFL-1",),
        unconditional=True,
    )
    yield always(
        "error is constant",
        machine.fired("reflector tracked").implies(in_step(machine, cycle.steady)),
        statement="in the view zone each measured position agrees with the distance run since the reflector came into view",
        requirements=("RFL-D2",),
        unconditional=True,
    )


def _reports(model: ReflectorMachine, one: Judgement) -> Bool:
    own, fix = model.own, _in_step_interval(model.machine, one.fix)
    same = own.track.position.eq(fix.position) & own.track.over.eq(fix.over) & own.track.under.eq(fix.under)
    bound = exact_to(one.slot.error, NM) + own.config.accuracy_nm
    wide = (own.track.over >= bound) & (own.track.under >= bound)
    return in_step(model.machine, one.fits) & same & wide


def _in_step_interval(machine: Machine, interval: Interval) -> Interval:
    return Interval(*(num_in_step(machine, term) for term in (interval.position, interval.over, interval.under)))


def _was(model: ReflectorMachine, *labels: str) -> Bool:
    return earlier_bool(model.in_mode(*labels))


def _leaving(model: ReflectorMachine) -> Iterator[Property]:
    """Leaving the view zone: odometry goes on from the last position (RFL-D2)."""
    machine, own = model.machine, model.own
    valid, precise = machine.flag("valid"), machine.flag("precise")
    ran_on = own.track.position.eq(earlier_num(own.track.position) + num_in_step(machine, own.odometer.moved))
    grew = (own.track.over > earlier_num(own.track.over)) & (own.track.under > earlier_num(own.track.under))
    left = _was(model, "VIEW") & model.in_mode("COAST", "PASSING", "ODOMETRY") & ~own.balise.read
    yield always(
        "goes on from the last position",
        left.implies(ran_on & grew) if own.odometer.constant_nm else left.implies(ran_on),
        statement="after the view zone the position is the last measured one plus the distance run, and both margins grow",
        requirements=("RFL-D2",),
        unconditional=True,
    )
    unaided = valid & earlier_bool(valid) & ~precise & ~own.balise.read
    kept = (own.track.over >= earlier_num(own.track.over)) & (own.track.under >= earlier_num(own.track.under))
    yield always(
        "margins never shrink unaided",
        unaided.implies(ran_on & kept),
        statement="without a balise and without a measured reflector the position moves by the measured distance alone, and "
        "no margin shrinks",
        requirements=("RFL-1", "RFL-D2", "RFL-D3"),
        unconditional=True,
    )
    yield within(
        "a silent radar is noticed",
        own.config.pause_limit_cycles + 1,
        model.in_mode("VIEW", "COAST") & ~own.frame,
        own.frame | ~model.in_mode("VIEW", "COAST"),
        statement="missing frames are no lost reflector until the permitted pause is over; then odometry goes on",
        requirements=("RFL-D2",),
        unconditional=True,
        helper=lambda waited: (waited > 0).implies(model.in_mode("COAST") & (waited <= own.pauses + 1)),
    )


def _self_test(model: ReflectorMachine) -> Iterator[Property]:
    """No precise positioning without a passed self-test (RFL-6)."""
    machine, cycle = model.machine, model.judged
    ready = machine.flag("ready")
    yield always(
        "ready only after the self-test",
        ready.implies(since(ready, machine.fired(*PASSED))),
        statement="precise positioning is possible only after a self-test that passed, and since then without a break",
        requirements=("RFL-6",),
        unconditional=True,
    )
    yield always(
        "precise only when ready",
        machine.flag("precise").implies(ready),
        statement="no precise position without a passed self-test",
        requirements=("RFL-6",),
        unconditional=True,
    )
    yield always(
        "the test is the prescribed distance",
        machine.fired(*PASSED).implies(in_step(machine, cycle.reference_holds & cycle.target.accepted)),
        statement="the self-test passes only with a measured reflector whose distance from the balise is the prescribed one",
        requirements=("RFL-6",),
        unconditional=True,
    )


def _failed_test(model: ReflectorMachine) -> Iterator[Property]:
    """What a failed self-test means, and from where on its reflector is looked for (RFL-6, RFL-8, RFL-D3)."""
    machine, own = model.machine, model.own
    yield always(
        "no retry",
        (_was(model, "NOT_READY") & ~model.in_mode("NOT_READY", "DELOCALIZED")).implies(
            own.balise.read & own.balise.identity.value.ne(earlier_num(own.procedure))
        ),
        statement="after a failed self-test only a different balise starts another one",
        requirements=("RFL-6", "RFL-D3"),
        unconditional=True,
    )
    yield always(
        "a mismatch ends the procedure",
        machine.fired(*FAILED).implies(model.in_mode("NOT_READY") & own.error.ne(NO_ERROR)),
        statement="a reference measurement that does not fit leaves the vehicle not ready, with an error",
        requirements=("RFL-6", "RFL-D3"),
        unconditional=True,
    )
    line = own.balise.search.value_or(as_num(0, MM))
    early = machine.fired("self-test passed at the balise") & (line > 0) & (own.balise.run < line)
    later = machine.fired("self-test passed") & (earlier_num(own.search_from) > 0)
    yield always(
        "looked for from the prescribed line",
        ~early
        & later.implies(
            earlier_num(own.run) + num_in_step(machine, own.odometer.moved) >= earlier_num(own.search_from)
        ),
        statement="where the telegram says from which distance on the reflector is looked for, it is not found before",
        requirements=("RFL-8",),
        unconditional=True,
    )


def _rejection(model: ReflectorMachine) -> Iterator[Property]:
    """Implausible input moves nothing."""
    machine, own = model.machine, model.own
    unfit = all_of(~slot.judged.eq(FITS) & ~slot.judged_next.eq(FITS) for slot in own.slots)
    yield always(
        "unfit echoes change nothing",
        (unfit & ~own.balise.read & machine.flag("valid")).implies(
            ~machine.flag("precise")
            & own.track.position.eq(earlier_num(own.track.position) + num_in_step(machine, own.odometer.moved))
        ),
        statement="a weak, foreign, too near, too coarse, ambiguous or out-of-window echo leaves position and source to "
        "odometry",
        requirements=("RFL-1", "RFL-10", "RFL-D3"),
        unconditional=True,
    )
    yield always(
        "a missing reflector ends the procedure",
        machine.fired("reflector not found", "reference reflector not found", "reflector passed unseen").implies(
            model.in_mode("NOT_READY") & ~machine.flag("ready")
        ),
        statement="a reflector that is not found where the map has it leaves the vehicle not ready, with an error",
        requirements=("RFL-D3",),
        unconditional=True,
    )
    yield always(
        "a contradicted route is not reported",
        own.contradicted.implies(~machine.flag("valid")),
        statement="when direction or turn-off contradict the map, nothing is reported from that step on",
        requirements=("RFL-12", "RFL-D5"),
        unconditional=True,
    )


def _availability(model: ReflectorMachine) -> Iterator[Property]:
    own, cycle, layout = model.own, model.judged, layout_of(model.own.config)
    room = separable_by_distance(cycle.reflector.clear, layout)
    fine = layout.reflector_fix_mm * NM_PER_MM
    yield always(
        "the layout leaves room",
        in_step(
            model.machine,
            (cycle.tolerable & room).implies(
                all_of((one.fix.margin <= fine).implies(one.verdict.ne(AMBIGUOUS)) for one in cycle.target.judgements)
            ),
        ),
        statement="where the spacing of equal models keeps the layout rule, no measurement within the radar's error is "
        "refused as ambiguous",
        requirements=("RFL-8", "RFL-10"),
        unconditional=True,
    )
    yield always(
        "nothing is skipped",
        (_was(model, "ODOMETRY") & model.in_mode("ODOMETRY") & own.ahead.known).implies(
            in_step(model.machine, ~cycle.passed_unseen & ~cycle.search_opens)
        ),
        statement="in the odometry zone a reflector of the map is either ahead, or was found before; none is passed in silence",
        requirements=("RFL-D3",),
        unconditional=True,
    )
    for label, text in (("VIEW", "a reflector can be measured"), ("PASSING", "a reflector can be passed")):
        yield reachable(
            f"{label.lower()} happens", model.in_mode(label), statement=text, requirements=("RFL-1", "RFL-3")
        )


def layout_of(config: ReflectorConfig) -> LayoutConfig:
    """The layout that suits the machine: a measured reflector's error holds the frame's latency at top speed."""
    lag_mm = -(-config.max_step_mm * config.share_ppm(config.frame_latency_ms) // 1_000_000) + 1
    return LayoutConfig(
        tolerance_mm=config.tolerance_mm,
        odometry_constant_mm=config.odometer.constant_mm,
        odometry_rate_ppm=config.odometer.rate_ppm,
        radar_error_mm=LayoutConfig().radar_error_mm + lag_mm,
        map_accuracy_mm=config.map_accuracy_mm,
    )
