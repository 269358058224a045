"""The self-test: the distance from balise to reflector is the prescribed one (RFL-5, RFL-6, RFL-8)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, before, exact_to, ite, with_unit
from safeloc.language.spec import Property, always, since
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import FITS
from safeloc.models.reflector.variables import NO_ERROR, Parts
from safeloc.properties.reflector.figures import FAILED, PASSED, balise_read, begun, ran_mm, run_since, was

for_all_inputs = partial(always, requirements=("RFL-6",), unconditional=True)


def self_test(model: ReflectorMachine) -> Iterator[Property]:
    """Readiness, the test itself, what it is measured from, and what a failed one means."""
    for maker in (_ready, _prescribed, _fails_rightly, _begins, _goes_on, _from_the_line, _failed):
        yield from maker(model)


def _ready(model: ReflectorMachine) -> Iterator[Property]:
    machine = model.machine
    ready = machine.flag("ready")
    yield for_all_inputs(
        "ready only after the self-test",
        ready.implies(since(ready, machine.fired(*PASSED))),
        statement="precise positioning is possible only after a self-test that passed, and since then without a break",
    )
    yield for_all_inputs(
        "precise only when ready",
        machine.flag("precise").implies(ready),
        statement="no precise position without a passed self-test",
    )


def _told_distance(own: Parts) -> Num:
    """The distance from balise to reflector by telegram, else by the map, else by the system's variable, mm."""
    by_map, telegram = own.ahead.reference, own.balise.reference
    known = ite(~by_map.present, own.config.reference_distance_mm, by_map.value)
    return ite(~telegram.present, known, telegram.value)


def _run_now(own: Parts) -> Num:
    """The distance run since the balise, at the end of this cycle, mm."""
    return ite(begun(own), run_since(own), before(own.run) + ran_mm(own))


def _off(own: Parts, range_: Num, error: Num) -> tuple[Num, Num]:
    """By how much a range misses the prescribed distance, and by how much it may, nm."""
    prescribed = ite(begun(own), _told_distance(own), before(own.reference))
    missed = exact_to(range_ + _run_now(own), NM) - exact_to(prescribed + own.config.radar_offset_mm, NM)
    run = with_unit(_run_now(own) * own.config.odometer.rate_ppm, NM)
    own_error = exact_to(error + own.config.reference_tolerance_mm, NM)
    return missed, own_error + ite(run < 0, -run, run)


def _agrees(own: Parts, range_: Num, error: Num) -> Bool:
    missed, allowed = _off(own, range_, error)
    return (missed <= allowed) & (missed >= -allowed)


def _prescribed(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield for_all_inputs(
        "the test is the prescribed distance",
        machine.fired(*PASSED).implies(
            _agrees(own, machine.output("range_mm"), machine.output("range_error_mm")) & machine.flag("precise")
        ),
        statement="the self-test passes only with a measured reflector whose distance from the balise is the prescribed one, "
        "within the tolerance, the echo's error and the odometer's over the run since the balise",
    )
    yield for_all_inputs(
        "a test at the balise belongs to it",
        machine.fired("self-test passed at the balise", "self-test failed at the balise").implies(begun(own)),
        statement="a self-test that is decided at the balise is that of the balise just read",
    )


def _fails_rightly(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield for_all_inputs(
        "a test fails only on a wrong distance",
        machine.fired(*FAILED).implies(
            any_of(slot.judged.eq(FITS) & ~_agrees(own, slot.range.value, slot.error) for slot in own.slots)
        ),
        statement="the self-test fails only with a measured reflector whose distance from the balise is not the prescribed one",
    )


def _begins(model: ReflectorMachine) -> Iterator[Property]:
    own, tells = model.own, model.own.balise
    yield for_all_inputs(
        "a test begins with a balise",
        begun(own).implies(balise_read(own) & own.procedure.eq(tells.identity.value) & own.ahead.position.present),
        statement="a reference measurement begins with a balise that is read, and with the next reflector of the map",
        requirements=("RFL-5", "RFL-6"),
    )
    line = ite(~tells.search.present, as_num(0, MM), tells.search.value)
    yield for_all_inputs(
        "the test begins with the prescribed distance",
        (begun(own) & model.in_mode("REFERENCE")).implies(
            own.reference.eq(_told_distance(own)) & own.run.eq(run_since(own)) & own.search_from.eq(line)
        ),
        statement="the prescribed distance is that of the telegram, else of the map, else of the system; the run is counted "
        "from the balise, and the reflector is looked for from the telegram's line on",
        requirements=("RFL-5", "RFL-6", "RFL-8"),
    )


def _goes_on(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    kept = (own.reference, own.search_from, own.target.position, own.target.view_from, own.procedure)
    yield for_all_inputs(
        "the test goes on with the distance run",
        (was(model, "REFERENCE") & model.in_mode("REFERENCE") & ~begun(own)).implies(
            own.run.eq(before(own.run) + ran_mm(own)) & all_of(var.eq(before(var)) for var in kept)
        ),
        statement="while the reference reflector is waited for, the run since the balise grows by the measured distance, and "
        "what was prescribed stays",
        requirements=("RFL-6", "RFL-8"),
    )


def _from_the_line(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    line = ite(begun(own), ite(~own.balise.search.present, 0, own.balise.search.value), before(own.search_from))
    yield for_all_inputs(
        "looked for from the prescribed line",
        (machine.fired(*PASSED) & (line > 0)).implies(_run_now(own) >= line),
        statement="where the telegram says from which distance on the reflector is looked for, it is not found before",
        requirements=("RFL-8",),
    )


def _failed(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "no retry",
        (was(model, "NOT_READY") & ~model.in_mode("NOT_READY", "DELOCALIZED")).implies(
            balise_read(own) & own.balise.identity.value.ne(before(own.procedure))
        ),
        statement="after a failed self-test only a different balise starts another one",
        requirements=("RFL-6", "RFL-D3"),
    )
    yield for_all_inputs(
        "a mismatch ends the procedure",
        model.machine.fired(*FAILED).implies(model.in_mode("NOT_READY") & own.error.ne(NO_ERROR)),
        statement="a reference measurement that does not fit leaves the vehicle not ready, with an error",
        requirements=("RFL-6", "RFL-D3"),
    )
