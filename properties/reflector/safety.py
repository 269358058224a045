"""Containment, and the loss and return of the position."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import abs_, all_of, as_num, before, between, exact_to, ite, minimum
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.variables import BALISE_CONTRADICTS, DRIFT, ECHOES_CONTRADICT, NO_ERROR
from safeloc.models.vocabulary.absent import NO_POSITION_MM
from safeloc.properties.no_interval import no_interval
from safeloc.properties.reflector.figures import LAW, balise_accuracy, balise_read, counts, run_since, without_sign

FAR_STEPS = 24
"""Distance at the highest speed, in cycles: more than any error that a cycle adds."""
for_all_inputs = partial(always, requirements=("RFL-1",), unconditional=True)
under_assumption = partial(always, requirements=("RFL-5", "RFL-D3"), assumption=LAW)


def safety(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of the interval, its loss, and its return."""
    for maker in (_contained, _tolerable, _silent, _located_again, _stated, _no_false_alarm, _stray, _silent_odometer):
        yield from maker(model)


def _contained(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    position = exact_to(machine.output("position_mm"), NM)
    above, below = exact_to(machine.output("margin_above_mm"), NM), exact_to(machine.output("margin_below_mm"), NM)
    yield under_assumption(
        "containment",
        machine.flag("valid").implies(between(position - below, own.ghosts.truth, position + above)),
        statement="in every zone the reported interval contains the true position of end A",
        requirements=("RFL-1", "RFL-2", "RFL-3", "RFL-5", "RFL-D2"),
    )


def _tolerable(model: ReflectorMachine) -> Iterator[Property]:
    machine, tolerance = model.machine, model.own.config.tolerance_mm
    yield for_all_inputs(
        "tolerance",
        machine.flag("valid").implies(
            (machine.output("margin_above_mm") <= tolerance) & (machine.output("margin_below_mm") <= tolerance)
        ),
        statement="a reported interval is never wider than the tolerable error, on either side",
    )


def _silent(model: ReflectorMachine) -> Iterator[Property]:
    machine, track = model.machine, model.own.track
    no_reflector = machine.output("reflector_position_mm").eq(NO_POSITION_MM) & machine.output("range_mm").eq(0)
    kept = (track.position, track.above, track.below)
    yield for_all_inputs(
        "no report when invalid",
        (~machine.flag("valid")).implies(
            no_interval(machine) & no_reflector & all_of(one.eq(0) for one in kept) & ~machine.flag("precise")
        ),
        statement="without a valid position the machine reports none, and stores none",
        requirements=("RFL-1", "RFL-D3"),
    )


def _located_again(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, distance_known = (
        machine.flag("valid"),
        counts(own) | (before(own.odometer.gap) < own.config.gap_limit_cycles),
    )
    yield for_all_inputs(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(balise_read(own) & ~own.contradicted & distance_known),
        statement="after a loss the machine reports a position again only by a balise, and only with an odometer",
        requirements=("RFL-5", "RFL-D3"),
    )
    config, tells = own.config, own.balise
    given = balise_accuracy(own) + without_sign(run_since(own))
    ran = as_num(config.odometer.constant_mm + 2 * config.max_cycle_distance_mm, MM)
    more = as_num(0, NM) if own.odometer.more is None else own.odometer.more
    fine = exact_to(given + ran, NM) + more <= exact_to(as_num(config.tolerance_mm, MM), NM)
    on_map = (
        abs_(tells.position.value)
        <= config.position_limit_mm - 2 * config.max_cycle_distance_mm - config.range_limit_mm
    )
    yield for_all_inputs(
        "a balise locates",
        (~earlier_bool(valid) & balise_read(own) & ~own.contradicted & distance_known & fine & on_map).implies(valid),
        statement="without a position, a balise of tolerable accuracy gives one, unless the odometer failed or the route is contradicted",
        requirements=("RFL-5",),
    )


def _stated(model: ReflectorMachine) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield for_all_inputs(
        "error stated",
        own.error.eq(NO_ERROR).iff(machine.flag("ready")),
        statement="the machine reports an error exactly while it is not ready for precise positioning",
        requirements=("RFL-6", "RFL-D3"),
    )


def _no_false_alarm(model: ReflectorMachine) -> Iterator[Property]:
    own, tells = model.own, model.own.balise
    yield under_assumption(
        "a sound radar raises no alarm",
        ~own.error.one_of(DRIFT, ECHOES_CONTRADICT),
        statement="while radar, odometer and map keep their laws, the machine reports no drift and no contradiction of echoes",
        requirements=("RFL-D2", "RFL-D3"),
    )
    off = own.ghosts.truth - exact_to(run_since(own) + tells.position.value, NM)
    accuracy = exact_to(balise_accuracy(own), NM)
    new = own.error.eq(BALISE_CONTRADICTS) & before(own.error).ne(BALISE_CONTRADICTS)
    yield under_assumption(
        "only a stray balise contradicts",
        new.implies(balise_read(own) & ((off > accuracy) | (-off > accuracy))),
        statement="the machine reports that a balise contradicts the position only if the reading is wrong by more than its accuracy",
    )


def _stray(model: ReflectorMachine) -> Iterator[Property]:
    own, config, tells = model.own, model.own.config, model.own.balise
    farthest = 2 * (config.tolerance_mm + config.odometer.constant_mm) + FAR_STEPS * config.max_cycle_distance_mm
    floor = 2 * config.odometer.floor_mm_s * config.period_ms // 1_000 + 1
    away = exact_to(balise_accuracy(own) + without_sign(run_since(own)) + (farthest + floor), NM)
    off = own.ghosts.truth - exact_to(run_since(own) + tells.position.value, NM)
    yield under_assumption(
        "a balise far away is noticed",
        (balise_read(own) & earlier_bool(model.machine.flag("valid")) & ((off > away) | (-off > away))).implies(
            ~model.machine.flag("valid")
        ),
        statement="a reading that is wrong by more than any position error ends the report of a position",
    )


def _silent_odometer(model: ReflectorMachine) -> Iterator[Property]:
    own, limit = model.own, model.own.config.gap_limit_cycles
    longer = minimum(before(own.odometer.gap) + 1, limit + 1)
    yield for_all_inputs(
        "cycles without a distance are counted",
        own.odometer.gap.eq(ite(counts(own), 0, longer)),
        statement="the machine counts the cycles since the last distance that a vehicle can have run, up to one more than permitted",
    )
    yield for_all_inputs(
        "without an odometer nothing is reported",
        model.machine.flag("valid").implies(own.odometer.gap <= limit),
        statement="after more cycles without a distance than permitted there is no position",
    )
