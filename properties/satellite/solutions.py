"""Claims of which solutions count, and why one does not (SAT-1, SAT-5)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from safeloc.language.expr import Bool, Lit, Num, all_of, any_of, as_num, exact_to, ite, maximum, minimum
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import COUNT, MM, NM
from safeloc.models.satellite import Satellite
from safeloc.models.satellite.variables import (
    ACCEPTED,
    DISJOINT,
    DRIFTED,
    MISSING,
    NO_FIX,
    NOT_LOCATED,
    NOT_USABLE,
    SPARE,
    TOO_COARSE,
    TOO_FEW,
)
from safeloc.models.satellite_selection.variables import EXCLUDED, USABLE
from safeloc.properties.satellite.state import (
    channels,
    kept_before,
    meets,
    most_change,
    most_off,
    most_speed_off,
    most_way,
    now_kept,
    run_at,
)
from safeloc.properties.satellite_selection import violated

for_all_inputs = partial(always, requirements=("SAT-5",), unconditional=True)


def solutions(model: Satellite) -> Iterator[Property]:
    own, of = model.own, model.composition.of(model.machine)
    accepted = of.num(own.last_verdict).eq(ACCEPTED)
    used = [of.bool(flag) for flag in own.used]
    yield for_all_inputs(
        "only usable satellites count",
        accepted.implies(all_of(~flag | standing.eq(USABLE) for flag, (_, standing) in zip(used, channels(model), strict=True))),
        statement="the state is computed only from satellites that are in the list of usable ones in the same cycle")  # fmt: skip
    yield for_all_inputs(
        "an excluded one never counts",
        any_of(flag & standing.eq(EXCLUDED) for flag, (_, standing) in zip(used, channels(model), strict=True)).implies(~accepted),
        statement="a solution that uses a satellite that violates the criterion does not change the state",
        requirements=("SAT-1", "SAT-5"))  # fmt: skip


def used(model: Satellite) -> Iterator[Property]:
    """Return the properties of each satellite of an accepted solution, by its measured values."""
    own, of, chosen = model.own, model.composition.of(model.machine), model.composition.of(model.selection.machine)
    accepted = of.num(own.last_verdict).eq(ACCEPTED)
    used = [of.bool(flag) for flag in own.used]
    config = model.selection.own.config
    bad = [chosen.bool(violated(one, config, config.removal)) for one, _ in channels(model)]
    yield for_all_inputs(
        "a satellite that violates the criterion never counts",
        accepted.implies(all_of(~flag | ~violation for flag, violation in zip(used, bad, strict=True))),
        statement="an accepted solution uses no satellite whose measurement of this cycle violates the criterion",
        requirements=("SAT-1", "SAT-4", "SAT-5"),
    )
    valid = [model.composition.of(model.selection.machine).bool(one.ephemeris_valid) for one, _ in channels(model)]
    yield for_all_inputs(
        "no expired data count",
        accepted.implies(all_of(~flag | ephemeris for flag, ephemeris in zip(used, valid, strict=True))),
        statement="a solution with a satellite whose ephemeris has expired does not change the state",
        requirements=("SAT-6", "SAT-D1"),
    )
    yield for_all_inputs(
        "no fix below the minimum",
        accepted.implies(_satellites(used) - SPARE[own.config.redundancy] >= of.num(own.unknowns)),
        statement="fewer satellites than the unknowns, and those that the redundancy asks for beyond them, give no fix: "
        "along the track 2 solve, 3 detect, 4 exclude; free of it 4, 5, 6",
    )
    yield for_all_inputs(
        "a solution that does not count changes nothing",
        of.bool(model.machine.fired("solution counts")).implies(accepted),
        statement="the state takes on a solution only where it was accepted",
    )


def exact(model: Satellite) -> Iterator[Property]:
    """Claim that a solution that counts changes the state, where the interval is then narrow enough to be reported."""
    own, of = model.own, model.composition.of(model.machine)
    low, high = _common(model)
    widest, end = (exact_to(Lit(mm, MM), NM) for mm in (own.config.tolerance_mm - 2, own.config.position_limit_mm))
    alone = of.num(own.last_verdict).eq(ACCEPTED) & ~of.bool(own.reference.present)
    yield for_all_inputs(
        "a solution that is exact enough counts",
        (alone & (high - low <= widest) & (low >= -end) & (high <= end)).implies(
            of.bool(model.machine.fired("solution counts"))
        ),
        statement="in a cycle without a reference, an accepted solution with which the interval is no wider than the tolerance of one "
        "side changes the state",
    )


def _common(model: Satellite) -> tuple[Num, Num]:
    """Return the ends of what the predicted interval and a solution with its protection level have in common, nm."""
    was, level, way = kept_before(model), most_off(model), most_way(model)
    place = exact_to(model.composition.of(model.machine).num(model.own.fix.value), NM)
    low = maximum(place - level, was.low - way + run_at(model, was.slowest))
    return low, minimum(place + level, was.high + way + run_at(model, was.fastest))


def _satellites(used: Sequence[Bool]) -> Num:
    """Return the number of satellites that a solution uses."""
    total = as_num(0, COUNT)
    for flag in used:
        total = total + ite(~flag, as_num(0, COUNT), 1)
    return total


def narrowed(model: Satellite) -> Iterator[Property]:
    """Return the properties of the interval after an accepted solution: its protection level covers the greatest error of
    usable signals.
    """
    own, of, now, was = model.own, model.composition.of(model.machine), now_kept(model), kept_before(model)
    low, high = _common(model)
    speed, speed_level, gained = of.num(own.fix_speed), most_speed_off(model), most_change(model)
    fast = own.config.max_speed_mm_s * 1_000
    ends = [
        now.low.eq(low),
        now.high.eq(high),
        now.slowest.eq(maximum(maximum(speed - speed_level, was.slowest - gained), -fast)),
        now.fastest.eq(minimum(minimum(speed + speed_level, was.fastest + gained), fast)),
    ]
    yield for_all_inputs(
        "a solution narrows to its protection level and no farther",
        of.bool(model.machine.fired("solution counts")).implies(all_of(ends)),
        statement="an accepted solution narrows the predicted interval to its own protection level and no farther: dilution times "
        "the sum of threshold, prediction error and clock error, plus the further error; likewise for the speed",
        requirements=("SAT-4", "SAT-5"),
    )


def outcomes(model: Satellite) -> Iterator[Property]:
    """Return the properties of the verdict on a solution, and of the reason for none: in this order of reasons."""
    own, of = model.own, model.composition.of(model.machine)
    verdict, located = of.num(own.last_verdict), earlier_bool(of.bool(model.machine.flag("valid")))
    used = [of.bool(flag) for flag in own.used]
    foreign = [flag & standing.ne(USABLE) for flag, (_, standing) in zip(used, channels(model), strict=True)]
    few = _satellites(used) - SPARE[own.config.redundancy] < of.num(own.unknowns)
    coarse = most_off(model) >= exact_to(Lit(own.config.protection_limit_mm, MM), NM) + 1
    apart = ite(meets(model), verdict.one_of(ACCEPTED, DRIFTED), verdict.eq(DISJOINT))
    apart = ite(few, verdict.eq(TOO_FEW), ite(coarse, verdict.eq(TOO_COARSE), apart))
    apart = ite(located, ite(any_of(foreign), verdict.eq(NOT_USABLE), apart), verdict.eq(NOT_LOCATED))
    there = of.bool(own.fix.present)
    yield for_all_inputs(
        "a solution counts or has the first reason against it",
        ite(there, apart, verdict.eq(NO_FIX)),
        statement="a solution counts, or has drifted away from odometry, where a position is known, all its satellites are "
        "usable and enough, it is not too coarse and meets the prediction; otherwise the first of these is the reason",
        requirements=("SAT-1", "SAT-5"),
    )
    yield for_all_inputs(
        "the reason for a missing solution is reported",
        of.num(own.why_missing).eq(ite(there, MISSING[0], of.num(own.missing))),
        statement="the machine gives a reason for each cycle without a solution",
    )
