"""What must hold of position from satellites (SAT-1, SAT-4, SAT-5, SAT-6)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields

from safeloc.language.expr import Bool, Lit, Num, abs_, all_of, any_of, as_num, between, exact_to, ite, maximum, minimum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable
from safeloc.language.units import COUNT, MM, MM_S, MS, NM, UM_S
from safeloc.models.satellite import Satellite
from safeloc.models.satellite.motion import predicted, solved
from safeloc.models.satellite.variables import ACCEPTED, LOCATED, SPARE, State, held
from safeloc.models.satellite_selection import EXCLUDED, USABLE, Channel

LAW = "greatest acceleration; a solution of usable satellites is within its protection level; a reference within its accuracy"
MOVES = "greatest acceleration"
FALSE_SIGNALS = (
    "greatest acceleration and speed; a reference within its accuracy; odometry within its error; nothing of signals"
)


def properties(model: Satellite) -> list[Property]:
    """Every property of selection and position together, where solutions of usable satellites can be trusted."""
    makers = (_safety, _solutions, _prediction, _coasting, _threshold_rule, _anchor)
    return [prop for maker in makers for prop in maker(model)]


def drift_properties(model: Satellite) -> list[Property]:
    """What holds although every signal may be false: model with `trusted="odometry"`."""
    of, machine, own = model.composition.of(model.machine), model.machine, model.own
    position, bound = (exact_to(of.num(machine.output(name)), NM) for name in ("position_mm", "drift_bound_mm"))
    bounded = always(
        "common drift is bounded",
        of.bool(own.anchored).implies(between(position - bound, of.num(own.truth), position + bound)),
        statement="however false the signals are, the position is no farther from the truth than the told bound: its "
        "distance from where odometry has carried the last reference, and what odometry may be wrong by",
        requirements=("SAT-1", "SAT-5"),
        assumption=FALSE_SIGNALS,
    )
    return [bounded, *_anchor(model)]


# ------------------------------------------------------------------ safety


def _safety(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    valid = of.bool(machine.flag("valid"))
    position, under, over = (
        exact_to(of.num(machine.output(f"{name}_mm")), NM) for name in ("position", "under", "over")
    )
    yield always(
        "containment",
        valid.implies(between(position - under, of.num(own.truth), position + over)),
        statement="the reported interval along the track holds the true position",
        requirements=("SAT-1", "SAT-5", "SAT-6"),
        assumption=LAW,
    )
    tolerance = own.config.tolerance_mm
    yield always(
        "tolerance",
        (of.num(machine.output("over_mm")) <= tolerance) & (of.num(machine.output("under_mm")) <= tolerance),
        statement="a reported interval is never wider than the tolerable error, on either side",
        requirements=("SAT-5",),
        unconditional=True,
    )
    yield always(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(of.bool(machine.fired("trusted reference"))),
        statement="a position is reported again only through a trusted reference: no solution starts it",
        requirements=("SAT-1", "SAT-5"),
        unconditional=True,
    )
    yield always(
        "reason stated",
        of.num(own.reason).eq(LOCATED).iff(valid),
        statement="a reason is stated exactly while nothing is reported",
        requirements=("SAT-5",),
        unconditional=True,
    )


# ------------------------------------------------------------------ what counts


def _solutions(model: Satellite) -> Iterator[Property]:
    own, of = model.own, model.composition.of(model.machine)
    accepted = of.num(own.judged).eq(ACCEPTED)
    used = [of.bool(flag) for flag in own.used]
    yield always(
        "only usable satellites count",
        accepted.implies(all_of(~flag | standing.eq(USABLE) for flag, (_, standing) in zip(used, _channels(model), strict=True))),
        statement="the state is computed only from satellites that are in the list of usable ones in the same cycle",
        requirements=("SAT-5",),
        unconditional=True,
    )  # fmt: skip
    yield always(
        "an excluded one never counts",
        any_of(flag & standing.eq(EXCLUDED) for flag, (_, standing) in zip(used, _channels(model), strict=True)).implies(~accepted),
        statement="a solution with a satellite that violates the criterion does not change the state",
        requirements=("SAT-1", "SAT-5"),
        unconditional=True,
    )  # fmt: skip
    valid = [model.composition.of(model.selection.machine).bool(one.ephemeris) for one, _ in _channels(model)]
    yield always(
        "no expired data count",
        accepted.implies(all_of(~flag | ephemeris for flag, ephemeris in zip(used, valid, strict=True))),
        statement="a solution with a satellite whose ephemeris has expired does not change the state",
        requirements=("SAT-6", "SAT-D1"),
        unconditional=True,
    )
    total = as_num(0, COUNT)
    for flag in used:
        total = total + ite(flag, as_num(1, COUNT), 0)
    yield always(
        "no fix below the minimum",
        accepted.implies(total >= of.num(own.unknowns) + SPARE[own.config.redundancy]),
        statement="fewer satellites than the unknowns, and those that the redundancy asks for beyond them, give no fix: "
        "along the track 2 solve, 3 detect, 4 exclude; free of it 4, 5, 6",
        requirements=("SAT-5",),
        unconditional=True,
    )
    yield always(
        "what does not count changes nothing",
        of.bool(model.machine.fired("solution counts")).implies(accepted),
        statement="the state takes on a solution only where it was accepted",
        requirements=("SAT-5",),
        unconditional=True,
    )


def _channels(model: Satellite) -> list[tuple[Channel, Num]]:
    """The channels with what each is after the step."""
    of = model.composition.of(model.selection.machine)
    return [(one, of.num(one.standing)) for one in model.selection.own.channels]


def _prediction(model: Satellite) -> Iterator[Property]:
    """E* from the state before alone, and how far the truth may be from it."""
    own, of = model.own, model.composition.of(model.machine)
    position, speed = (earlier_num(of.num(term)) for term in (predicted(own).position, predicted(own).speed))
    coasting = of.bool(model.machine.flag("coasting"))
    yield always(
        "the prediction is the state before",
        coasting.implies(of.num(own.position).eq(position) & of.num(own.speed).eq(speed)),
        statement="without a solution the state is E*(t): place, speed and change of the cycle before, and no input",
        requirements=("SAT-1", "SAT-D1"),
        unconditional=True,
    )
    found = _rewritten(solved(own), of.num)
    ahead = _rewritten(predicted(own), lambda term: earlier_num(of.num(term)))
    yield always(
        "a solution meets the prediction",
        of.num(own.judged).eq(ACCEPTED).implies(found.meets(ahead)),
        statement="a solution counts only where its interval and the predicted one have a place and a speed in common",
        requirements=("SAT-1", "SAT-5"),
        unconditional=True,
    )
    off, off_speed = _prediction_errors(model)
    within, within_speed = _error_bounds(model)
    yield always(
        "prediction error",
        earlier_bool(of.bool(model.machine.flag("valid"))).implies((off <= within) & (off_speed <= within_speed)),
        statement="the truth is off E*(t) by no more than the state was, its error of speed over the cycle, and A T2; its "
        "speed by no more than it was, and 2 A T: predictor and train may accelerate against each other",
        requirements=("SAT-1", "SAT-4", "SAT-D1"),
        assumption=MOVES,
    )


def _rewritten(state: State, rewrite: Callable[[Num], Num]) -> State:
    return State(*(rewrite(getattr(state, field.name)) for field in fields(state)))


def _prediction_errors(model: Satellite) -> tuple[Num, Num]:
    """How far the truth is from E*(t): nm, um/s."""
    own, of = model.own, model.composition.of(model.machine)
    position, speed = (earlier_num(of.num(term)) for term in (predicted(own).position, predicted(own).speed))
    return abs_(of.num(own.truth) - position), abs_(of.num(own.true_speed) - speed)


def _state_errors(model: Satellite) -> tuple[Num, Num]:
    """How far the state was from the truth in the cycle before."""
    own, of = model.own, model.composition.of(model.machine)
    off, off_speed = of.num(own.truth - own.position), of.num(own.true_speed - own.speed)
    return abs_(earlier_num(off)), abs_(earlier_num(off_speed))


def _error_bounds(model: Satellite) -> tuple[Num, Num]:
    config = model.own.config
    was_off, was_off_speed = _state_errors(model)
    way = was_off + exact_to(was_off_speed * Lit(config.period_ms, MS), NM) + 2 * config.way_nm
    return way, was_off_speed + 2 * config.speed_change_um_s


# ------------------------------------------------------------------ the threshold rule


def _threshold_rule(model: Satellite) -> Iterator[Property]:
    for one, standing in _channels(model):
        yield always(
            f"channel {one.number}: braking excludes no healthy one",
            standing.eq(EXCLUDED).implies(~_healthy_while_braking(model, one)),
            statement="a satellite whose errors are within the noise is kept through every change of speed that a train can "
            "make, while the state was no farther off than the configuration says: the threshold rule",
            requirements=("SAT-4",),
            assumption=f"{MOVES}; what the prediction's error makes of a difference is no greater than that error",
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
        (clock.speed_clock, chosen.speed_clock_mm_s),
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
            abs_(exact_to(of.num(one.offset), NM)) <= off,
            abs_(exact_to(of.num(one.speed_offset), UM_S)) <= off_speed,
        ]
    )


# ------------------------------------------------------------------ coasting


def _coasting(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    coasting, valid = of.bool(machine.flag("coasting")), of.bool(machine.flag("valid"))
    state, coasted = _rewritten(held(own), of.num), of.num(own.coasted)
    was = _rewritten(held(own), lambda term: earlier_num(of.num(term)))
    fast, gained = own.config.max_speed_mm_s * 1_000, own.config.speed_change_um_s
    wider = [state.under >= was.under, state.over >= was.over, state.high - state.low > was.high - was.low]
    faster = [
        state.fastest.eq(minimum(was.fastest + gained, fast)),
        state.slowest.eq(maximum(was.slowest - gained, -fast)),
    ]
    yield always(
        "coasting only grows",
        (coasting & earlier_bool(valid)).implies(all_of([*wider, *faster])),
        statement="without a solution that counts the interval grows in every cycle and shrinks on neither side; that of the "
        "speed grows by the greatest acceleration, until it holds every speed there is",
        requirements=("SAT-1",),
        unconditional=True,
    )
    yield always(
        "coasting ends",
        coasting.implies(coasted.eq(earlier_num(coasted) + 1)) & (coasted <= own.config.coast_limit_cycles),
        statement="cycles of coasting are counted one by one, and never more than the limit",
        requirements=("SAT-1",),
        unconditional=True,
    )


# ------------------------------------------------------------------ drift


def _anchor(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    state, margin = _rewritten(held(own), of.num), of.num(own.anchor_margin)
    yield always(
        "position and odometry meet",
        of.bool(own.anchored).implies(between(-(state.over + margin), of.num(own.anchor_offset), state.under + margin)),
        statement="a position is reported no farther from where odometry has carried the last reference than both may be "
        "wrong by",
        requirements=("SAT-1", "SAT-5"),
        unconditional=True,
    )
    if own.config.drift_check == "required":
        yield always(
            "nothing without odometry",
            of.bool(machine.flag("valid")).implies(of.bool(own.anchored)),
            statement="nothing is reported that is not held against odometry since a reference",
            requirements=("SAT-1", "SAT-5"),
            unconditional=True,
        )
    yield reachable(
        "a drift is found",
        of.bool(machine.fired("common drift")),
        statement="a position that has drifted away from odometry ends",
        requirements=("SAT-1", "SAT-5"),
    )
