"""The self-test: the distance from balise to reflector is the prescribed one (RFL-5, RFL-6, RFL-8)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, before, exact_to, ite
from safeloc.language.spec import Property, always, since
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import FITS
from safeloc.models.reflector.variables import MISMATCH, NO_ERROR, Parts
from safeloc.properties.reflector.figures import (
    FAILED,
    LAW,
    PASSED,
    READY,
    balise_read,
    begun,
    echo_sides,
    foremost,
    in_test,
    known_place,
    known_sides,
    looked_for,
    ran_mm,
    rearmost,
    run_since,
    was,
)

for_all_inputs = partial(always, requirements=("RFL-6",), unconditional=True)
under_assumption = partial(always, requirements=("RFL-6",), assumption=LAW)


def self_test(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of the self-test: readiness, the test itself, its beginning, its failure, its age."""
    makers = (
        _ready,
        _prescribed,
        _fails_rightly,
        _begins,
        _goes_on,
        _from_the_line,
        _failed,
        _found_out,
        _left_open,
        _ages,
    )
    for maker in makers:
        yield from maker(model)


def _ready(model: ReflectorMachine) -> Iterator[Property]:
    machine = model.machine
    ready = machine.flag("ready")
    yield for_all_inputs(
        "ready only after the self-test",
        ready.implies(since(ready, machine.fired(*PASSED))),
        statement="the machine is ready only after a self-test that passed, and without a break since then",
    )
    yield for_all_inputs(
        "precise only when ready",
        machine.flag("precise").implies(ready),
        statement="a position is precise only while the machine is ready, that is, after a self-test that passed",
    )


def _prescribed_distance(own: Parts) -> Num:
    """Return the prescribed distance from balise to reflector: by telegram, else by map, else by the system's variable, mm."""
    by_map, telegram = own.ahead.reference, own.balise.reference
    known = ite(~by_map.present, own.config.reference_distance_mm, by_map.value)
    return ite(~telegram.present, known, telegram.value)


def _run_now(own: Parts) -> Num:
    """Return the distance run since the balise, at the end of this cycle, mm."""
    return ite(begun(own), run_since(own), before(own.run_since_balise) + ran_mm(own))


def _most(own: Parts, range_: Num, error: Num) -> tuple[Num, Num]:
    """Return how much a sound radar may seem to measure (too short, too long), nm: by the errors of the known place and the echo."""
    (ahead, behind), (early, late) = known_sides(own), echo_sides(own, range_, error)
    return late + ahead, early + behind


def _prescribed_kept(own: Parts, range_: Num, error: Num) -> Bool:
    """Return whether the distance from balise to reflector is the prescribed one, within its measuring error and the survey's."""
    prescribed = ite(begun(own), _prescribed_distance(own), before(own.reference))
    missed = exact_to(range_ + _run_now(own), NM) - exact_to(prescribed + own.config.radar_offset_mm, NM)
    short, long = _most(own, range_, error)
    survey = exact_to(as_num(own.config.map_accuracy_mm, MM), NM)
    return (missed <= survey + long) & (missed >= -(survey + short))


def _place_kept(own: Parts, range_: Num, error: Num) -> Bool:
    """Return whether the reflector is measured at its place on the map, as far as the vehicle's place is known without the radar."""
    missed = exact_to(known_place(own) + range_, NM) - exact_to(looked_for(own) + own.config.radar_offset_mm, NM)
    short, long = _most(own, range_, error)
    return (missed <= long) & (missed >= -short)


def _agrees(own: Parts, range_: Num, error: Num) -> Bool:
    return _prescribed_kept(own, range_, error) & _place_kept(own, range_, error)


def _prescribed(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield for_all_inputs(
        "the test is the prescribed distance",
        machine.fired(*PASSED).implies(
            _agrees(own, machine.output("range_mm"), machine.output("range_error_mm")) & machine.flag("precise")
        ),
        statement="the self-test passes only if the measured reflector has the prescribed distance from the balise and its place on the "
        "map, within the errors of balise, echo, survey and the odometer since the balise",
    )
    yield for_all_inputs(
        "a test at the balise belongs to it",
        machine.fired("self-test passed at the balise", "self-test failed at the balise").implies(begun(own)),
        statement="a self-test that ends in the cycle of a balise reading is that of the balise just read",
    )


def _fails_rightly(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield for_all_inputs(
        "a test fails only on a wrong distance",
        machine.fired(*FAILED).implies(
            any_of(slot.last_verdict.eq(FITS) & ~_agrees(own, slot.range.value, slot.error) for slot in own.slots)
        ),
        statement="the self-test fails only if the measured reflector does not have the prescribed distance from the balise, or not its "
        "place on the map",
    )
    yield under_assumption(
        "a right radar passes the self-test",
        machine.fired(*FAILED).implies(own.ghosts.bias.ne(0)),
        statement="a radar without a systematic error never fails the self-test, with any errors of noise, scale, survey, balise and "
        "odometer that their laws allow",
    )


def _begins(model: ReflectorMachine) -> Iterator[Property]:
    own, tells = model.own, model.own.balise
    yield for_all_inputs(
        "a test begins with a balise",
        begun(own).implies(
            balise_read(own) & own.procedure_balise.eq(tells.identity.value) & own.ahead.position.present
        ),
        statement="a self-test begins only with a balise reading, and only if the map has a next reflector",
        requirements=("RFL-5", "RFL-6"),
    )
    line = ite(~tells.search_from.present, as_num(0, MM), tells.search_from.value)
    yield for_all_inputs(
        "the test begins with the prescribed distance",
        (begun(own) & model.in_mode("REFERENCE")).implies(
            own.reference.eq(_prescribed_distance(own))
            & own.run_since_balise.eq(run_since(own))
            & own.search_from.eq(line)
        ),
        statement="the prescribed distance is that of the telegram, else of the map, else of the system; the run counts from the "
        "balise, and the search begins at the telegram's distance",
        requirements=("RFL-5", "RFL-6", "RFL-8"),
    )


def _goes_on(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    kept = (own.reference, own.search_from, own.target.position, own.target.view_from, own.procedure_balise)
    yield for_all_inputs(
        "the test goes on with the distance run",
        (was(model, "REFERENCE") & model.in_mode("REFERENCE") & ~begun(own)).implies(
            own.run_since_balise.eq(before(own.run_since_balise) + ran_mm(own))
            & all_of(var.eq(before(var)) for var in kept)
        ),
        statement="while the self-test waits for its reflector, the run since the balise grows by the measured distance, and the "
        "prescribed figures stay",
        requirements=("RFL-6", "RFL-8"),
    )


def _from_the_line(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    line = ite(
        begun(own), ite(~own.balise.search_from.present, 0, own.balise.search_from.value), before(own.search_from)
    )
    yield for_all_inputs(
        "no self-test passes before the prescribed search distance",
        (machine.fired(*PASSED) & (line > 0)).implies(_run_now(own) >= line),
        statement="if the telegram gives the distance at which the search begins, the self-test does not pass before it",
        requirements=("RFL-8",),
    )


def _beyond(own: Parts, most: Num) -> Bool:
    """Return whether the radar's systematic error exceeds this bound, nm."""
    return (own.ghosts.bias > most) | (own.ghosts.bias < -most)


def _found_out(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of a self-test under any systematic error of the radar."""
    machine, own = model.machine, model.own
    figure = exact_to(as_num(own.config.reference_tolerance_mm, MM), NM)
    yield under_assumption(
        "a radar that errs is found out by the self-test",
        (in_test(model) & _beyond(own, figure)).implies(~machine.flag("ready") & ~machine.flag("precise")),
        statement="if the radar's systematic error exceeds the reference tolerance at a self-test, the machine is neither ready nor precise in that cycle",
    )
    measured = any_of(slot.last_verdict.eq(FITS) for slot in own.slots)
    yield under_assumption(
        "a radar that errs is reported",
        (in_test(model) & machine.flag("valid") & measured & _beyond(own, figure)).implies(own.error.eq(MISMATCH)),
        statement="if a radar whose systematic error exceeds the reference tolerance measures the reference reflector, the machine reports a mismatch",
    )
    short, long = _most(own, machine.output("range_mm"), machine.output("range_error_mm"))
    yield under_assumption(
        "a radar that passes errs no more than the test can detect",
        machine.fired(*PASSED).implies(~_beyond(own, short + long)),
        statement="a radar passes the self-test only if its systematic error is within twice the errors of balise, echo, survey and the "
        "odometer since the balise",
    )
    yield under_assumption(
        "precise only with a radar that is nearly right",
        machine.flag("ready").implies(~_beyond(own, figure)),
        statement="while the machine is ready for precise positioning, the radar's systematic error is within the reference tolerance",
    )


def _left_open(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the property of the interval after a test that passed."""
    machine, own = model.machine, model.own
    place = exact_to(known_place(own), NM)
    ahead, behind = known_sides(own)
    yield for_all_inputs(
        "a test that passed makes nothing better known",
        machine.fired(*PASSED).implies((foremost(own) >= place + ahead) & (rearmost(own) <= place - behind)),
        statement="the interval after a self-test contains the interval that was known without the radar",
    )


def _ages(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of the age of a test."""
    machine, own, config = model.machine, model.own, model.own.config
    drift = as_num(config.radar_drift_mm_s * config.period_ms * 1_000, NM)
    most = exact_to(as_num(config.reference_tolerance_mm, MM), NM)
    sides = (own.open_long, own.open_short)
    later = was(model, *READY) & model.in_mode(*READY) & ~machine.fired(*PASSED)
    yield for_all_inputs(
        "the error that a test left open grows by the drift",
        later.implies(all_of((side - before(side)).eq(drift) for side in sides)),
        statement="in each cycle after a self-test the bounds on the systematic error grow by the greatest drift, on either side",
    )
    yield for_all_inputs(
        "a test is out of date only when it is",
        machine.fired("self-test too long ago").implies(any_of(before(side) > most - drift for side in sides)),
        statement="the machine stops being ready for the age of the self-test only if the radar may have drifted beyond the reference "
        "tolerance",
    )


def _failed(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "no retry",
        (was(model, "NOT_READY") & ~model.in_mode("NOT_READY", "DELOCALIZED")).implies(
            balise_read(own) & own.balise.identity.value.ne(before(own.procedure_balise))
        ),
        statement="after a failed self-test only a different balise starts another one",
        requirements=("RFL-6", "RFL-D3"),
    )
    yield for_all_inputs(
        "a mismatch ends the procedure",
        model.machine.fired(*FAILED).implies(model.in_mode("NOT_READY") & own.error.ne(NO_ERROR)),
        statement="after a failed self-test the machine is not ready and reports an error",
        requirements=("RFL-6", "RFL-D3"),
    )
