"""In and after the view zone: the error stays constant, and odometry goes on from the last position (RFL-D2)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, as_num, before, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, within
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.vocabulary.interval import StoredInterval
from safeloc.properties.reflector.figures import IN_ZONE, foremost, law_nm, ran_mm, rearmost, was

for_all_inputs = partial(always, requirements=("RFL-D2",), unconditional=True)


def leaving(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of constant error, passing, loss, and odometry after it."""
    for maker in (_constant, _steps, _anchored, _goes_on, _unaided, _silent_radar):
        yield from maker(model)


def _constant(model: ReflectorMachine) -> Iterator[Property]:
    own, anchor = model.own, model.own.anchor
    tracked = model.machine.flag("precise") & ~own.recognised_now
    reaches = exact_to(anchor.position, NM) + anchor.above >= rearmost(own) + own.open_short
    yield for_all_inputs(
        "error is constant",
        tracked.implies(reaches & (foremost(own) - own.open_long >= exact_to(anchor.position, NM) - anchor.below)),
        statement="in the view zone each measured position agrees with the distance run since the reflector came into view; the "
        "bound on the systematic error hides no disagreement",
    )


def _steps(model: ReflectorMachine) -> Iterator[Property]:
    own, drift = model.own, as_num(model.own.config.radar_drift_mm_s * model.own.config.period_ms * 1_000, NM)
    again = was(model, "VIEW") & model.in_mode("VIEW") & ~own.balise.position.present
    more = law_nm(own) + drift + exact_to(as_num(own.config.odometer.constant_mm, MM), NM)
    apart = exact_to(own.track.position - before(own.track.position) - ran_mm(own), NM)
    front, back = (own.track.above - own.open_long, own.track.below - own.open_short)
    last_front = before(own.track.above) - before(own.open_long)
    last_back = before(own.track.below) - before(own.open_short)
    yield for_all_inputs(
        "no measurement jumps",
        again.implies((apart <= last_front + back + more) & (-apart <= last_back + front + more)),
        statement="two measured positions in a row differ by the distance run, within the errors of echoes, survey, odometer and "
        "drift; the bound on the systematic error hides no jump",
    )


def _anchored(model: ReflectorMachine) -> Iterator[Property]:
    own, anchor = model.own, model.own.anchor
    stays = was(model, *IN_ZONE) & model.in_mode(*IN_ZONE) & ~own.recognised_now
    constant = exact_to(as_num(own.config.odometer.constant_mm, MM), NM)
    unseen = (own.track.above + own.open_short, own.track.below + own.open_long)
    afresh = _no_wider(anchor, own.track.position, unseen, constant)
    drift = as_num(own.config.radar_drift_mm_s * own.config.period_ms * 1_000, NM)
    ran_on = _no_wider(
        anchor, before(anchor.position) + ran_mm(own), (before(anchor.above), before(anchor.below)), law_nm(own) + drift
    )
    yield for_all_inputs(
        "the anchor runs on by the odometer alone",
        stays.implies(ran_on | afresh),
        statement="the anchor moves by the measured distance, and its margins grow by no more than the odometer's law and the radar's "
        "drift; an anchor that has grown too wide begins anew at the last position",
    )


def _no_wider(anchor: StoredInterval, position: Num, sides: tuple[Num, Num], by: Num) -> Bool:
    """Return whether the anchor is at this position, and its margins exceed these ones by at most `by`."""
    above, below = sides
    return anchor.position.eq(position) & (anchor.above - above <= by) & (anchor.below - below <= by)


def _goes_on(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    ran_on = own.track.position.eq(ran_mm(own) + before(own.track.position))
    grew = (own.track.above > before(own.track.above)) & (own.track.below > before(own.track.below))
    left = was(model, "VIEW") & model.in_mode("COAST", "PASSING", "ODOMETRY") & ~own.balise.position.present
    yield for_all_inputs(
        "goes on from the last position",
        left.implies(ran_on & grew) if own.config.odometer.constant_mm else left.implies(ran_on),
        statement="after the view zone the position is the last measured one plus the distance run, and both margins grow",
    )


def _unaided(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    unaided = valid & earlier_bool(valid) & ~machine.flag("precise") & ~own.balise.position.present
    ran_on = own.track.position.eq(ran_mm(own) + before(own.track.position))
    kept = (own.track.above >= before(own.track.above)) & (own.track.below >= before(own.track.below))
    yield for_all_inputs(
        "margins never shrink unaided",
        unaided.implies(ran_on & kept),
        statement="without a balise and without a measured reflector the position moves by the measured distance alone, and "
        "no margin shrinks",
        requirements=("RFL-1", "RFL-D2", "RFL-D3"),
    )


def _silent_radar(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    yield within(
        "a silent radar is noticed",
        own.config.pause_limit_cycles + 1,
        ~own.frame_present & model.in_mode("COAST", "VIEW"),
        own.frame_present | ~model.in_mode("COAST", "VIEW"),
        statement="a reflector counts as lost for missing frames only after the permitted pause; then odometry goes on",
        requirements=("RFL-D2",),
        unconditional=True,
        helper=lambda waited: (waited > 0).implies(model.in_mode("COAST") & (waited <= own.pauses + 1)),
    )
    yield for_all_inputs(
        "pauses and misses are counted",
        (was(model, "COAST") & model.in_mode("COAST")).implies(
            own.pauses.eq(ite(own.frame_present, before(own.pauses), before(own.pauses) + 1))
            & own.misses.eq(ite(own.frame_present, before(own.misses) + 1, before(own.misses)))
        ),
        statement="while the radar does not measure the reflector, the machine counts cycles without a frame and frames without its "
        "echo apart",
    )
