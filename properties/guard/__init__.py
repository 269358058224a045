"""Properties of the guard of a receiver (MRK-D6)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, as_num, before, between, exact_to, ite, maximum, minimum
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import COUNT, NM, NM_PER_MM
from safeloc.models.guard import Guard
from safeloc.models.guard.variables import ACROSS, AGAINST, NO_FAULT, OUT_OF_REACH, PASSED, UNCONFIRMED
from safeloc.properties.guard.step import HALF_TURN_MRAD, Step

LAW = (
    "the vehicle keeps its figures; a fix that completes a row, near the way, along it, each reachable from the one before and from "
    "where the vehicle was last known, is within its error"
)
REQUIREMENTS = ("MRK-D6",)
BEGINS = ("first fix", "fix agrees", "fix begins anew", "receiver believed")
BACK = ("receiver believed", "receiver believed again")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(model: Guard) -> list[Property]:
    """Return all properties of the guard."""
    makers = (
        _safety,
        _added_error,
        _withheld,
        _gates,
        _course,
        _carried,
        _new_start,
        _begun_by_a_fix,
        _reported,
        _trust,
        _stored,
        _recovering,
        _coming_back,
        _use,
    )
    return [prop for maker in makers for prop in maker(model)]


def _safety(model: Guard) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, position = machine.flag("valid"), machine.output("position_mm")
    below, above = machine.output("margin_below_mm"), machine.output("margin_above_mm")
    yield always(
        "containment",
        valid.implies(between(exact_to(position - below, NM), own.truth, exact_to(position + above, NM))),
        statement="the reported interval along the way contains the vehicle",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )
    yield always(
        "window",
        machine.flag("holding").implies(_between_mm(machine.output("window_from_mm"), own.truth, machine.output("window_to_mm"))),
        statement="the window with which fixes are compared contains the vehicle, also while it is too wide to report",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )  # fmt: skip
    tolerance = own.config.tolerance_mm
    yield for_all_inputs(
        "tolerance",
        valid.implies(between(0, below, tolerance) & between(0, above, tolerance)),
        statement="a reported interval is never wider than the tolerable error, on either side",
    )
    yield for_all_inputs(
        "a fix that is passed on is reported",
        machine.flag("passed").implies(valid),
        statement="a fix that is passed on comes with a valid interval",
    )


def _between_mm(low: Num, truth: Num, high: Num) -> Bool:
    return between(exact_to(low, NM), truth, exact_to(high, NM))


def _added_error(model: Guard) -> Iterator[Property]:
    """Properties of the error bound of a fix, computed independently of the machine."""
    machine, own, step = model.machine, model.own, Step(model)
    low, high = step.place - step.added_error, step.place + step.added_error
    yield for_all_inputs(
        "an interval begun by a fix covers the fix's whole error",
        machine.fired(*BEGINS).implies((own.low <= low) & (own.high >= high)),
        statement="an interval that begins with a fix is as wide as its error, its distance off the track, and its age at full "
        "speed make it",
    )
    narrowed = (own.low <= maximum(step.low, low)) & (own.high >= minimum(step.high, high))
    yield for_all_inputs(
        "a fix narrows no further than to its own error",
        (_was_holding(model) & machine.flag("passed")).implies(narrowed),
        statement="a fix that is passed on narrows the stored interval no further than to its own error",
    )


def _begun_by_a_fix(model: Guard) -> Iterator[Property]:
    """Properties of the reported last known place: it is rounded outward to a millimetre and no farther."""
    machine, own = model.machine, model.own
    behind = own.known_low - exact_to(machine.output("known_from_mm"), NM) - own.config.rollback_mm * NM_PER_MM
    ahead = exact_to(machine.output("known_to_mm"), NM) - own.known_high
    yield for_all_inputs(
        "the whole of the place last known is reported",
        between(0, behind, NM_PER_MM - 1) & between(0, ahead, NM_PER_MM - 1),
        statement="the reported last known place contains all of it, with the distance that a vehicle may roll back, to a millimetre",
    )


def _was_holding(model: Guard) -> Bool:
    return before(model.machine.mode).one_of(*model.machine.modes[2:])


def _withheld(model: Guard) -> Iterator[Property]:
    machine, own, step = model.machine, model.own, Step(model)
    passed, holding, was_holding = machine.flag("passed"), machine.flag("holding"), _was_holding(model)
    slow, fast = step.speeds
    yield for_all_inputs(
        "a fix that is withheld narrows nothing",
        (was_holding & holding & ~passed).implies(
            own.low.eq(step.low) & own.high.eq(step.high) & own.slow.eq(slow) & own.fast.eq(fast)
        ),
        statement="after a delivery that is not passed on, the stored place and speed are exactly as if nothing had "
        "been delivered",
    )
    grown = (own.low <= before(own.low)) | (before(own.slow) > 0)
    yield for_all_inputs(
        "without a fix it only widens",
        (was_holding & holding & ~passed).implies(
            (own.high - own.low >= before(own.high) - before(own.low)) | (before(own.slow) > before(own.fast))
        )
        & (grown | ~was_holding | ~holding | passed),
        statement="without a fix that is passed on, the interval never becomes narrower",
    )


def _gates(model: Guard) -> Iterator[Property]:
    machine, own, step = model.machine, model.own, Step(model)
    passed, was_holding = machine.flag("passed"), _was_holding(model)
    yield for_all_inputs(
        "faults are never passed",
        (own.fault.ne(NO_FAULT) | ~own.fix.present).implies(~passed),
        statement="the machine does not pass on a delivery that is no fix, not finite, stale, late, repeated or out of order",
    )
    off = own.offset > own.config.offset_limit_mm
    yield for_all_inputs(
        "a fix that is passed on agrees with the map",
        (off | own.ambiguous | own.elsewhere).implies(~passed),
        statement="the machine does not pass on a fix off the track, on no clear track, or at a place to which no way leads in the time",
    )
    yield for_all_inputs(
        "the place itself is inside",
        passed.implies(between(own.low, exact_to(own.fix.value, NM), own.high)),
        statement="a position that is passed on lies in the interval that is passed on with it",
    )
    yield for_all_inputs(
        "where the vehicle can be",
        (passed & was_holding).implies(between(step.low, own.low, step.high) & between(step.low, own.high, step.high)),
        statement="a fix that is passed on while an interval is stored lies in the stretch that the vehicle can have reached",
    )


def _course(model: Guard) -> Iterator[Property]:
    """Properties of a course across the way or against its direction: it is refused, and no other course is."""
    machine, own, step = model.machine, model.own, Step(model)
    passed, only, most = machine.flag("passed"), own.forwards_only, own.config.confirmations
    yield for_all_inputs(
        "a course across the way is refused",
        step.crosses.implies(~passed),
        statement="a fix whose course makes a greater angle with the way than a switch and the error of a course explain is not passed on",
    )
    yield for_all_inputs(
        "a course against the permitted direction is refused",
        (only & step.runs_back).implies(~passed),
        statement="if the way permits its own direction only, the machine does not pass on a fix whose course runs against it",
    )
    yield for_all_inputs(
        "a refused course costs the row",
        (step.fair.one_of(ACROSS, AGAINST)).implies(
            own.agreed_fixes.eq(0) & own.fair_fixes.eq(0) & own.agreed_fixes.ne(most)
        ),
        statement="after a fix across or against the way, the machine requires as many fixes in a row as at the beginning",
    )
    along = ~own.course.present | (own.course.value <= own.config.course_limit_mrad)
    yield for_all_inputs(
        "a course along the way is not refused",
        (along | (~only & (own.course.value >= HALF_TURN_MRAD - own.config.course_limit_mrad))).implies(
            ~own.last_verdict.one_of(ACROSS, AGAINST)
        )
        & (~step.runs_back | ~only).implies(own.last_verdict.ne(AGAINST)),
        statement="a course within the limit of the way, or none, is no reason to refuse; nor is one backwards where both directions are permitted",
    )


def _carried(model: Guard) -> Iterator[Property]:
    """Properties of the last known place, which is carried through every withdrawal."""
    machine, own, step = model.machine, model.own, Step(model)
    least, most = step.known
    yield for_all_inputs(
        "a place out of reach is refused",
        step.out_of_reach.implies(~machine.flag("passed")),
        statement="the machine does not pass on a fix at a place that the vehicle cannot have reached since a row "
        "was last full, however long no interval was stored",
    )
    yield for_all_inputs(
        "a place in reach is not refused",
        own.last_verdict.eq(OUT_OF_REACH).implies(step.out_of_reach & step.alone.eq(PASSED)),
        statement="the machine refuses no fix as out of reach at a place that the vehicle can have reached in its direction at the highest speed",
    )
    fills = step.fair.eq(PASSED) & step.fair_row.eq(own.config.confirmations)
    yield for_all_inputs(
        "fair fixes are counted",
        own.fair_fixes.eq(ite(own.start_anew, as_num(0, COUNT), step.fair_row)),
        statement="the row of fair fixes grows by each that follows from the one before, and ends with one that is off the track, runs "
        "across or against it, or is out of reach",
    )
    yield for_all_inputs(
        "the place last known is carried",
        own.start_anew
        | own.known_low.eq(ite(fills, maximum(least, step.place - step.added_error), least))
        & own.known_high.eq(ite(fills, minimum(most, step.place + step.added_error), most)),
        statement="a fix that fills a row narrows the place last known to its error; without one the place widens "
        "by a run at the highest speed, backwards only if that is permitted, also while no interval is "
        "stored",
    )


def _new_start(model: Guard) -> Iterator[Property]:
    """Properties of the host's new start: its effect, and that nothing else has it."""
    machine, own, line = model.machine, model.own, Step(model).line_nm
    lost = machine.modes[0]
    nowhere = own.known_low.eq(-line) & own.known_high.eq(line) & own.near_low.eq(-line) & own.near_high.eq(line)
    yield for_all_inputs(
        "a new start forgets",
        own.start_anew.implies(
            machine.mode.eq(lost) & own.agreed_fixes.eq(0) & own.fair_fixes.eq(0) & nowhere & ~machine.flag("passed")
        ),
        statement="at a new start no interval is stored and no place known, and the next fix begins a row wherever "
        "it lies",
    )


def _reported(model: Guard) -> Iterator[Property]:
    """Properties of the reason for which a delivery is withheld."""
    machine, own, step = model.machine, model.own, Step(model)
    lost = machine.modes[0]
    verdict = ite(before(machine.mode).eq(lost) | own.start_anew, step.fair, step.verdict)
    yield for_all_inputs(
        "a delivery agrees or has the first reason against it",
        ite(verdict.eq(PASSED), own.last_verdict.one_of(PASSED, UNCONFIRMED), own.last_verdict.eq(verdict)),
        statement="the reason for a refusal is the first of these that applies: a fault, the map, the vehicle's "
        "limits, its course, the place last known, its present place and speed; if none applies, the fix "
        "agrees",
    )


def _trust(model: Guard) -> Iterator[Property]:
    """Properties of losing trust in the receiver, while an interval is stored."""
    machine, own, step = model.machine, model.own, Step(model)
    _, _, passing, probation = machine.modes
    was_holding, holding, now = _was_holding(model), machine.flag("holding"), machine.mode
    passed, contradicts = machine.flag("passed"), step.fair.eq(PASSED) & ~step.follows
    yield for_all_inputs(
        "an implausible fix costs the trust",
        (was_holding & step.implausible).implies(now.ne(passing) & own.agreed_fixes.eq(0)),
        statement="a fix that contradicts map or motion puts the receiver on probation in the same step",
    )
    yield for_all_inputs(
        "nothing else costs the trust",
        (was_holding & holding & ~step.implausible & ~step.agrees & ~contradicts).implies(
            own.agreed_fixes.eq(before(own.agreed_fixes)) & now.eq(before(now))
        )
        & (before(now).eq(passing) & now.eq(probation)).implies(step.implausible | contradicts),
        statement="a delivery that is missing, faulty, coarse or in doubt changes the trust in the receiver neither way",
    )
    yield for_all_inputs(
        "a receiver that contradicts itself loses the trust",
        (was_holding & contradicts).implies(
            ~passed & now.ne(passing) & own.agreed_fixes.eq(ite(holding & step.agrees, as_num(1, COUNT), 0))
        ),
        statement="if no vehicle can have run from the last fix near the way to this one, the machine withholds "
        "this one; it begins a row if it agrees with the stored interval",
    )


def _stored(model: Guard) -> Iterator[Property]:
    """Properties of the last fix near the way, and of the stored interval's end."""
    machine, own, step = model.machine, model.own, Step(model)
    was_holding, holding = _was_holding(model), machine.flag("holding")
    least, most = step.near
    by_itself = step.alone.eq(PASSED)
    yield for_all_inputs(
        "a fix is compared with the last one near the way",
        own.start_anew
        | own.near_low.eq(ite(by_itself, step.place - step.added_error, least))
        & own.near_high.eq(ite(by_itself, step.place + step.added_error, most)),
        statement="a fix that agrees with map and vehicle is stored with its error, also if it is withheld, and "
        "widens by a run at the highest speed",
    )
    yield for_all_inputs(
        "a stored interval that bounds nothing is dropped",
        was_holding.implies(holding.iff((step.can_be_held | step.fills) & ~own.start_anew)),
        statement="the machine drops the stored interval at a new start, and when it is too wide, beyond the line "
        "or empty, unless a fix that is passed on narrows it in the same step; and never otherwise",
    )


def _recovering(model: Guard) -> Iterator[Property]:
    """Properties of the first trust in a receiver."""
    machine, own, step = model.machine, model.own, Step(model)
    lost, recovering, passing, _ = machine.modes
    now, was, begins = machine.mode, before(machine.mode), step.fair.eq(PASSED)
    goes_on = ~own.start_anew
    yield for_all_inputs(
        "a row begins with a fix that may be true",
        (was.eq(lost) & goes_on).implies(ite(begins, now.eq(recovering) & own.agreed_fixes.eq(1), now.eq(lost))),
        statement="while no interval is stored, a fix that agrees with map, vehicle, course and the place last "
        "known begins a row of one, and nothing else does",
    )
    anew = now.eq(recovering) & own.agreed_fixes.eq(1)
    dropped = now.eq(lost) & own.agreed_fixes.eq(0)
    kept = now.eq(recovering) & own.agreed_fixes.eq(before(own.agreed_fixes))
    otherwise = ite(begins, anew, ite(step.implausible | ~step.can_be_held, dropped, kept))
    grows = ite(step.fills, now.eq(passing), now.eq(recovering) & own.agreed_fixes.eq(before(own.agreed_fixes) + 1))
    yield for_all_inputs(
        "a row that does not agree begins anew",
        (was.eq(recovering) & goes_on).implies(ite(step.agrees, grows, otherwise)),
        statement="while the receiver recovers, a fix that agrees lengthens the row, one that does not begins it "
        "anew, and one that contradicts the map or comes too late ends it",
    )


def _coming_back(model: Guard) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, passed = machine.flag("valid"), machine.flag("passed")
    most = own.config.confirmations
    back = machine.fired(*BACK)
    _, _, passing, probation = machine.modes
    yield for_all_inputs(
        "no resurrection",
        (machine.mode.eq(passing) & before(machine.mode).ne(passing)).implies(
            back & before(own.agreed_fixes).eq(most - 1)
        ),
        statement="a receiver that was in doubt is trusted again only from the fix on that completes the row of agreeing ones",
    )
    yield for_all_inputs(
        "only a passed fix reports",
        (valid & ~earlier_bool(valid)).implies(passed & machine.mode.eq(passing)),
        statement="a position that was not reported is reported again only with a fix that is passed on",
    )
    yield for_all_inputs(
        "one fix counts once",
        (own.agreed_fixes <= before(own.agreed_fixes) + 1)
        & ((own.agreed_fixes > before(own.agreed_fixes)).implies(own.last_verdict.one_of(PASSED, UNCONFIRMED))),
        statement="the row grows by one, and only with a fix that passes every check",
    )
    yield for_all_inputs(
        "only a full row passes",
        passed.implies(own.agreed_fixes.eq(most)),
        statement="the machine passes no fix on before the required number of fixes in a row agree",
    )
    yield for_all_inputs(
        "passing is trust",
        machine.mode.eq(passing).implies(own.agreed_fixes.eq(most))
        & machine.mode.eq(probation).implies(own.agreed_fixes < most),
        statement="fixes are passed on exactly while the row is full",
    )


def _use(model: Guard) -> Iterator[Property]:
    machine, own, passed = model.machine, model.own, model.machine.flag("passed")
    most = own.config.confirmations
    step = Step(model)
    agrees = ~own.start_anew & step.agrees & (step.can_be_held | step.fills | ~_was_holding(model))
    was = before(own.agreed_fixes)
    longer = ite(was >= most - 1, as_num(most, COUNT), was + 1)
    counted = own.agreed_fixes.eq(ite(step.follows, longer, as_num(1, COUNT)))
    yield for_all_inputs(
        "every agreeing fix counts",
        (agrees & (was > 0)).implies(counted) & (agrees & step.follows & (was >= most - 1)).implies(passed),
        statement="a row grows with each fix that agrees and follows from the one before, begins anew with one that only agrees, and "
        "is passed on when it is full, unless the window ends first",
    )
    yield reachable(
        "probation is survived",
        machine.fired("receiver believed again"),
        further_assumption=_plain(model),
        statement="a receiver can regain its trust without losing the interval",
        requirements=REQUIREMENTS,
    )


def _plain(model: Guard) -> Bool:
    """The fix is fresh, on the track's axis, and comes without speed and course: a witness needs no others."""
    own = model.own
    with_it = ~own.speed.present & ~own.course.present & own.offset.eq(0) & own.age.eq(0)
    clear = own.fault.eq(NO_FAULT) & ~own.ambiguous & ~own.elsewhere & own.advance
    return own.fix.present & with_it & clear & own.forwards_only & ~own.start_anew
