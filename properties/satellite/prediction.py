"""Claims of the map-bound prediction, its error, and the threshold rule (SAT-D1)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Lit, Num, abs_, all_of, as_num, between, exact_to, ite, maximum, minimum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import MM, MM_S, NM, UM_S
from safeloc.models.satellite import Satellite
from safeloc.models.satellite.variables import (
    ACCEPTED,
)
from safeloc.models.satellite_selection.variables import EXCLUDED, Channel
from safeloc.properties.satellite.state import (
    MOVES,
    channels,
    kept_before,
    meets,
    most_change,
    most_way,
    now_kept,
    run_at,
)

for_all_inputs = partial(always, requirements=("SAT-1", "SAT-D1"), unconditional=True)


def prediction(model: Satellite) -> Iterator[Property]:
    """E* from the state before alone: the way at the speed, and half of what the last change of speed adds."""
    machine, now, was = model.machine, now_kept(model), kept_before(model)
    of = model.composition.of(machine)
    coasting, valid = of.bool(machine.flag("coasting")), of.bool(machine.flag("valid"))
    fast = model.own.config.max_speed_mm_s * 1_000
    twice = run_at(model, was.speed * 2 + was.change)
    kept_speed = maximum(minimum(was.speed + was.change, fast), -fast)
    yield for_all_inputs(
        "the prediction is the state before",
        coasting.implies(((now.position - was.position) * 2).eq(twice) & now.speed.eq(kept_speed)),
        statement="without a solution the state is E*(t): place, speed and change of the cycle before, and no input",
    )
    sped, most = now.speed - was.speed, most_change(model)
    possible = (sped <= most) & (sped >= -most)
    yield for_all_inputs(
        "the prediction goes on with the change of speed",
        (valid & earlier_bool(valid)).implies(now.change.eq(ite(possible, sped, as_num(0, UM_S)))),
        statement="the acceleration that the next prediction goes on with is that of the last cycle, if a vehicle can have it",
        requirements=("SAT-D1",),
    )
    yield for_all_inputs(
        "a solution meets the prediction",
        of.num(model.own.last_verdict).eq(ACCEPTED).implies(meets(model)),
        statement="a solution counts only where its interval and the predicted one have a place and a speed in common",
        requirements=("SAT-1", "SAT-5"),
    )


def prediction_error(model: Satellite) -> Iterator[Property]:
    """Return the properties of the prediction E*: its distance from the truth is bounded."""
    off, off_speed = _prediction_errors(model)
    within, within_speed = _error_bounds(model)
    yield always(
        "prediction error",
        earlier_bool(model.composition.of(model.machine).bool(model.machine.flag("valid"))).implies(
            (off <= within) & (off_speed <= within_speed)
        ),
        statement="the truth is off E*(t) by no more than the state was, its error of speed over the cycle, and A T2; its "
        "speed by no more than it was, and 2 A T: predictor and train may accelerate against each other",
        requirements=("SAT-1", "SAT-4", "SAT-D1"),
        assumption=MOVES,
    )


def _prediction_errors(model: Satellite) -> tuple[Num, Num]:
    """Return the distance of the truth from E*(t): twice the way in nm, and the speed in um/s."""
    own, of, was = model.own, model.composition.of(model.machine), kept_before(model)
    fast = own.config.max_speed_mm_s * 1_000
    speed = minimum(maximum(was.speed + was.change, -fast), fast)
    twice = (of.num(own.truth) - was.position) * 2 - run_at(model, was.speed * 2 + was.change)
    return abs_(twice), abs_(of.num(own.true_speed) - speed)


def _state_errors(model: Satellite) -> tuple[Num, Num]:
    """Return the distance of the state from the truth in the cycle before."""
    own, of = model.own, model.composition.of(model.machine)
    off, off_speed = of.num(own.truth - own.position), of.num(own.true_speed - own.speed)
    return abs_(earlier_num(off)), abs_(earlier_num(off_speed))


def _error_bounds(model: Satellite) -> tuple[Num, Num]:
    """Return the bounds of these errors: twice the way, and the speed."""
    was_off, was_off_speed = _state_errors(model)
    way = was_off + run_at(model, was_off_speed) + 2 * most_way(model)
    return way * 2, was_off_speed + 2 * most_change(model)


def threshold_rule(model: Satellite) -> Iterator[Property]:
    for one, standing in channels(model):
        yield always(
            f"channel {one.number}: braking excludes no healthy one",
            standing.eq(EXCLUDED).implies(~_healthy_while_braking(model, one)),
            statement="the selection keeps a satellite whose errors are within the noise through every change of speed that a "
            "train can make, as long as the state's error was within the configured figure: the threshold rule",
            requirements=("SAT-4",),
            assumption=f"{MOVES}; the prediction's error changes a difference by no more than that error",
        )


def _healthy_while_braking(model: Satellite, one: Channel) -> Bool:
    config, chosen = model.own.config, model.own.config.selection
    of, clock = model.composition.of(model.selection.machine), model.selection.own
    was_off, was_off_speed = _state_errors(model)
    off, off_speed = _prediction_errors(model)
    machine = model.composition.of(model.machine)
    noise = (
        (one.error, chosen.range_noise_mm),
        (one.speed_error, chosen.speed_noise_mm_s),
        (clock.clock, chosen.range_clock_mm),
        (clock.clock_mm_s, chosen.speed_clock_mm_s),
    )
    covariances = (
        (one.covariance, chosen.range_covariance_mm2),
        (one.speed_covariance, chosen.speed_covariance_mm2_s2),
    )
    return all_of(
        [
            earlier_bool(machine.bool(model.machine.flag("valid"))),
            was_off <= exact_to(Lit(config.state_error_mm, MM), NM),
            was_off_speed <= exact_to(Lit(config.state_speed_error_mm_s, MM_S), UM_S),
            *(between(-most, of.num(term), most) for term, most in noise),
            *(of.num(item.value) < most for item, most in covariances),
            abs_(exact_to(of.num(one.prediction * 2), NM)) <= off,
            abs_(exact_to(of.num(one.prediction_mm_s), UM_S)) <= off_speed,
        ]
    )
