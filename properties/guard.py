"""What must hold of the guard of a receiver (MRK-D6)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Num, as_num, before, between, exact_to, ite, maximum, minimum, with_unit
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import COUNT, NM
from safeloc.models.guard import Guard
from safeloc.models.guard.variables import NO_FAULT, PASSED, UNCONFIRMED
from safeloc.properties.in_step import in_step, num_in_step

LAW = (
    "the vehicle keeps its figures; a fix that completes the row of agreeing ones is no farther off than it is charged"
)
TRACE = ("MRK-D6",)
NM_PER_MM = 1_000_000
BEGINS = ("first fix", "fix agrees", "fix begins anew", "receiver believed")
BACK = ("receiver believed", "receiver believed again")


def properties(model: Guard) -> list[Property]:
    """Every property of the guard."""
    return [*_safety(model), *_charged(model), *_withheld(model), *_gates(model), *_coming_back(model), *_use(model)]


def _safety(model: Guard) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, position = machine.flag("valid"), machine.output("position_mm")
    under, over = machine.output("under_mm"), machine.output("over_mm")
    yield always(
        "containment",
        valid.implies(between(exact_to(position - under, NM), own.truth, exact_to(position + over, NM))),
        statement="the reported interval along the way holds the vehicle",
        requirements=TRACE,
        assumption=LAW,
    )
    yield always(
        "window",
        machine.flag("holding").implies(_between_mm(machine.output("window_from_mm"), own.truth, machine.output("window_to_mm"))),
        statement="the window that fixes are compared with holds the vehicle, also where it is too wide to report",
        requirements=TRACE,
        assumption=LAW,
    )  # fmt: skip
    tolerance = own.config.tolerance_mm
    yield always(
        "tolerance",
        between(0, under, tolerance) & between(0, over, tolerance),
        statement="a reported interval is never wider than the tolerable error, on either side",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "what is passed is reported",
        machine.flag("passed").implies(valid),
        statement="a fix that is passed on comes with a valid interval",
        requirements=TRACE,
        unconditional=True,
    )


def _between_mm(low: Num, truth: Num, high: Num) -> Bool:
    return between(exact_to(low, NM), truth, exact_to(high, NM))


def _charged(model: Guard) -> Iterator[Property]:
    """What a fix may be wrong by, in figures of its own: the law speaks of what the machine charges."""
    machine, own, config = model.machine, model.own, model.own.config
    box = model.judged.coasted.box
    off = with_unit(own.offset * (config.offset_charge_permille * NM_PER_MM // 1_000), NM)
    aged = with_unit(own.age * (config.max_speed_mm_s * 1_000), NM)
    charge, place = config.fix_error_mm * NM_PER_MM + off + aged, exact_to(own.fix.value, NM)
    yield always(
        "a fix is charged all it may be off",
        machine.fired(*BEGINS).implies((own.low <= place - charge) & (own.high >= place + charge)),
        statement="an interval that begins with a fix is as wide as its error, its distance off the track, and its age at full "
        "speed make it",
        requirements=TRACE,
        unconditional=True,
    )
    low, high = num_in_step(machine, box.low), num_in_step(machine, box.high)
    narrowed = (own.low <= maximum(low, place - charge)) & (own.high >= minimum(high, place + charge))
    yield always(
        "a fix narrows to its charge only",
        (in_step(machine, model.holding) & machine.flag("passed")).implies(narrowed),
        statement="a fix that is passed on narrows what is held no further than to what it may be off itself",
        requirements=TRACE,
        unconditional=True,
    )


def _withheld(model: Guard) -> Iterator[Property]:
    machine, own, judged = model.machine, model.own, model.judged
    passed, holding = machine.flag("passed"), model.holding
    was_holding = in_step(machine, holding)
    coasted = judged.coasted.box
    low, high = num_in_step(machine, coasted.low), num_in_step(machine, coasted.high)
    slow, fast = num_in_step(machine, coasted.slow), num_in_step(machine, coasted.fast)
    yield always(
        "what is withheld narrows nothing",
        (was_holding & holding & ~passed).implies(
            own.low.eq(low) & own.high.eq(high) & own.slow.eq(slow) & own.fast.eq(fast)
        ),
        statement="after a delivery that is not passed on, place and speed are held exactly as if nothing had been delivered",
        requirements=TRACE,
        unconditional=True,
    )
    grown = (own.low <= before(own.low)) | (before(own.slow) > 0)
    yield always(
        "without a fix it only widens",
        (was_holding & holding & ~passed).implies(
            (own.high - own.low >= before(own.high) - before(own.low)) | (before(own.slow) > before(own.fast))
        )
        & (grown | ~was_holding | ~holding | passed),
        statement="without a fix that is passed on, the interval never becomes narrower",
        requirements=TRACE,
        unconditional=True,
    )


def _gates(model: Guard) -> Iterator[Property]:
    machine, own, judged = model.machine, model.own, model.judged
    passed, was_holding = machine.flag("passed"), in_step(machine, model.holding)
    low, high = num_in_step(machine, judged.coasted.box.low), num_in_step(machine, judged.coasted.box.high)
    yield always(
        "faults are never passed",
        (own.fault.ne(NO_FAULT) | ~own.fix.present).implies(~passed),
        statement="what is no fix, or not finite, stale, late, repeated or out of order, is not passed on",
        requirements=TRACE,
        unconditional=True,
    )
    off = own.offset > own.config.offset_limit_mm
    yield always(
        "the map is kept",
        (off | own.ambiguous | own.elsewhere).implies(~passed),
        statement="a fix off the track, on no clear track, or where no way leads in the time, is not passed on",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "the place itself is inside",
        passed.implies(between(own.low, exact_to(own.fix.value, NM), own.high)),
        statement="a position that is passed on lies in the interval that is passed on with it",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "where the vehicle can be",
        (passed & was_holding).implies(between(low, own.low, high) & between(low, own.high, high)),
        statement="what is passed on while an interval is held lies in what the vehicle can have reached",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "an implausible fix costs the trust",
        (was_holding & in_step(machine, judged.implausible)).implies(machine.mode.ne(machine.modes[2]) & own.agreed.eq(0)),
        statement="a fix that contradicts map or motion puts the receiver on probation in the same step",
        requirements=TRACE,
        unconditional=True,
    )  # fmt: skip


def _coming_back(model: Guard) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, passed = machine.flag("valid"), machine.flag("passed")
    most = own.config.confirmations
    back = machine.fired(*BACK)
    _, _, passing, probation = machine.modes
    yield always(
        "no resurrection",
        (machine.mode.eq(passing) & before(machine.mode).ne(passing)).implies(back & before(own.agreed).eq(most - 1)),
        statement="a receiver that was in doubt is believed again only with the fix that completes the row of agreeing ones",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "only a passed fix reports",
        (valid & ~earlier_bool(valid)).implies(passed & machine.mode.eq(passing)),
        statement="a position that was not reported is reported again only with a fix that is passed on",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "one fix counts once",
        (own.agreed <= before(own.agreed) + 1)
        & ((own.agreed > before(own.agreed)).implies(own.judged.one_of(PASSED, UNCONFIRMED))),
        statement="the row grows by one, and only with a fix that keeps every gate",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "only a full row passes",
        passed.implies(own.agreed.eq(most)),
        statement="nothing is passed on before as many fixes in a row agree as are asked for",
        requirements=TRACE,
        unconditional=True,
    )
    yield always(
        "passing is trust",
        machine.mode.eq(passing).implies(own.agreed.eq(most)) & machine.mode.eq(probation).implies(own.agreed < most),
        statement="fixes are passed on exactly while the row is full",
        requirements=TRACE,
        unconditional=True,
    )


def _use(model: Guard) -> Iterator[Property]:
    machine, own, passed = model.machine, model.own, model.machine.flag("passed")
    most = own.config.confirmations
    agrees = in_step(machine, model.judged.agrees & model.judged.begins) & ~machine.fired("window given up")
    was = before(own.agreed)
    one_more = own.agreed.eq(ite(was >= most - 1, as_num(most, COUNT), was + 1))
    yield always(
        "every agreeing fix counts",
        (agrees & (was > 0)).implies(one_more) & (agrees & (was >= most - 1)).implies(passed),
        statement="a row grows with each fix that agrees, and is passed on when it is full, unless the window ends first",
        requirements=TRACE,
        unconditional=True,
    )
    yield reachable(
        "probation is survived",
        machine.fired("receiver believed again"),
        statement="a receiver can regain its trust without losing the interval",
        requirements=TRACE,
    )
