"""A reflector that is missing at its place on the map, and implausible input (RFL-D3)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, before, between
from safeloc.language.spec import Property, always
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import FITS
from safeloc.models.reflector.variables import NOT_FOUND
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector.figures import balise_read, begun, found_by, ran_mm, rearmost, was, width

for_all_inputs = partial(always, requirements=("RFL-D3",), unconditional=True)
under_assumption = partial(
    always, requirements=("RFL-D3",), assumption="odometer, balise, radar and map keep their laws"
)


def not_found(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of missing reflectors and implausible input."""
    for maker in (_in_time, _reference_in_time, _not_before, _reference_not_before, _ends, _found_last, _unfit, _route):
        yield from maker(model)


def _in_time(model: ReflectorMachine) -> Iterator[Property]:
    own, target, truth = model.own, model.own.target, model.own.ghosts.truth
    yield under_assumption(
        "the search for a reflector ends in time",
        model.in_mode("SEARCH").implies(truth - width(own) <= found_by(own, target.position, target.view_from)),
        statement="the search for a reflector ends, at the latest, one search run and one interval width behind the beginning of "
        "its view zone",
    )


def _reference_in_time(model: ReflectorMachine) -> Iterator[Property]:
    own, target, config = model.own, model.own.target, model.own.config
    late = rearmost(own) > found_by(own, target.position, target.view_from)
    searched = own.run_since_balise - own.search_from > config.search_run_mm
    waits = was(model, "REFERENCE") & model.in_mode("REFERENCE") & ~begun(own)
    far = config.reference_run_mm
    yield for_all_inputs(
        "the reference reflector is found in time",
        waits.implies(~(late & searched) & between(-far, own.run_since_balise, far)),
        statement="the self-test waits for its reflector until one search run behind the beginning of its view zone and behind the "
        "prescribed distance, and never beyond the longest reference run",
        requirements=("RFL-6", "RFL-D3"),
    )


def _missed(model: ReflectorMachine, *modes: str) -> Bool:
    """Return whether the machine, in one of these modes before, reports that the reflector was not found."""
    return was(model, *modes) & model.in_mode("NOT_READY") & model.own.error.eq(NOT_FOUND)


def _not_before(model: ReflectorMachine) -> Iterator[Property]:
    own, target, ahead = model.own, model.own.target, model.own.ahead
    by = found_by(own, before(target.position), before(target.view_from))
    yield under_assumption(
        "not found is reported only beyond the search run",
        _missed(model, "SEARCH").implies(own.ghosts.truth > by),
        statement="the machine reports a searched reflector as not found only if the vehicle truly is beyond the search run",
    )
    by_next = found_by(own, ahead.position.value, ahead.view_from)
    yield under_assumption(
        "passed unseen is reported only beyond the search run",
        _missed(model, "ODOMETRY").implies((own.ghosts.truth > by_next) & (ahead.position.value > before(own.found))),
        statement="the machine reports a reflector as passed unseen only if the vehicle truly is beyond its search run, and if the "
        "reflector was not found before",
    )


def _reference_not_before(model: ReflectorMachine) -> Iterator[Property]:
    own, target, config = model.own, model.own.target, model.own.config
    by = found_by(own, before(target.position), before(target.view_from))
    run: Num = before(own.run_since_balise) + ran_mm(own)
    far = (run > config.reference_run_mm) | (run < -config.reference_run_mm)
    searched = run > before(own.search_from) + config.search_run_mm
    yield under_assumption(
        "the reference is missed only beyond the search",
        (_missed(model, "REFERENCE") & ~begun(own)).implies(far | (searched & (own.ghosts.truth > by))),
        statement="the machine reports the reference reflector as not found only beyond the search run, by the true place and by the "
        "run since the balise, or beyond the longest reference run",
        requirements=("RFL-6", "RFL-D3"),
    )


def _ends(model: ReflectorMachine) -> Iterator[Property]:
    machine = model.machine
    yield for_all_inputs(
        "a missing reflector ends the procedure",
        machine.fired("reflector not found", "reference reflector not found", "reflector passed unseen").implies(
            model.in_mode("NOT_READY") & ~machine.flag("ready") & model.own.error.eq(NOT_FOUND)
        ),
        statement="if a reflector is not found at its place on the map, the machine is not ready and reports an error",
    )


def _found_last(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of the memory of the reflector found last: by it the next one counts as passed unseen, or as found."""
    own, nothing = model.own, model.own.found.eq(model.own.found.low)
    yield for_all_inputs(
        "the reflector found last is stored",
        own.recognised_now.implies(own.found.eq(own.target.position)),
        statement="when a reflector comes into view, its place on the map is stored as that of the reflector found last",
    )
    yield for_all_inputs(
        "without a reflector found the last one stays",
        (~own.recognised_now).implies(nothing | own.found.eq(before(own.found))),
        statement="without another reflector in view the one found last stays stored, or is forgotten",
    )


def _unfit(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of implausible input: it changes nothing."""
    machine, own = model.machine, model.own
    unfit = all_of(~slot.last_verdict.eq(FITS) & ~slot.last_verdict_for_next.eq(FITS) for slot in own.slots)
    yield for_all_inputs(
        "unfit echoes change nothing",
        (unfit & ~balise_read(own) & machine.flag("valid")).implies(
            ~machine.flag("precise") & own.track.position.eq(ran_mm(own) + before(own.track.position))
        ),
        statement="with only weak, foreign, too near, too coarse, ambiguous or out-of-window echoes, odometry alone gives the position",
        requirements=("RFL-1", "RFL-10", "RFL-D3"),
    )
    nothing = model.own.target.model.eq(NO_MODEL) & machine.output("reflector_model").eq(NO_MODEL)
    yield for_all_inputs(
        "nothing is sighted outside its zones",
        model.in_mode("DELOCALIZED", "NOT_READY", "ODOMETRY").implies(nothing),
        statement="the machine reports no reflector in modes in which it searches none",
    )


def _route(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "a contradicted route is not reported",
        own.contradicted.implies(~model.machine.flag("valid")),
        statement="while direction or turn-off contradict the map, there is no position",
        requirements=("RFL-12", "RFL-D5"),
    )
