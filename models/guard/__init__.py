"""The guard of a receiver: it passes on only those of the receiver's positions that map and motion allow (MRK-D6).

A receiver's position may serve as marker information, but the receiver's quality flags do not bound its error. So the guard
checks a fix by the map (is it on the track, and on which one), by the vehicle's possible motion (can it be there by now, at
that speed) and by the number of fixes in a row that agreed with both. It does not read the flags.

    WITHDRAWN   no interval is stored: the receiver alone is not enough
    RECOVERING  one or more fixes in a row agree with each other; none is passed on
    PASSING     a fix that agrees with the stored interval is passed on and narrows it
    PROBATION   a fix was implausible, or contradicted the one before: none is passed on and nothing narrows, until the
                configured number of fixes in a row agree

A row also ends where a vehicle cannot have run from one fix near the way to the next, whatever the verdict on the first was.
The guard refuses a fix whose course crosses the way, or runs against the only permitted direction, and one at a place that the
vehicle cannot have reached from its last known place, however long ago. Only the host's new start forgets that place.

The guard stores an interval of places along the way and one of speeds. Without a fix that passes, both grow by the vehicle's
possible motion; an interval wider than the tolerance is not reported, and beyond a limit it is given up. Distances are nm along
the way, speeds um/s, negative against the way's direction.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from safeloc.language.expr import (
    Bool,
    Expr,
    Lit,
    Num,
    as_num,
    between,
    ceil_to,
    floor_div,
    floor_to,
    ite,
    maximum,
    minimum,
)
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM, NM, UM_S
from safeloc.models.guard import law
from safeloc.models.guard.box import Box, Held, begun, of_fix, tolerable, usable
from safeloc.models.guard.judgement import Judgement, judge
from safeloc.models.guard.variables import OFF_TRACK, PASSED, UNCONFIRMED, GuardConfig, Parts, parts
from safeloc.models.vocabulary.absent import margin_if, position_if

REQUIREMENTS = ("MRK-D6",)


def machine(config: GuardConfig | None = None) -> Machine:
    """Return the guard's machine (MRK-D6)."""
    return build(parts(config or GuardConfig())).machine


@dataclass(frozen=True, eq=False)
class Guard(Model[Parts]):
    """The machine together with the terms it was built from, for properties to speak about."""

    judgement: Judgement

    @property
    def holding(self) -> Bool:
        """An interval is stored that contains the true place."""
        return self.machine.mode.one_of(*self.machine.modes[2:])


def build(own: Parts) -> Guard:
    """Build the machine over the given variables."""
    table = modes("WITHDRAWN", "RECOVERING", "PASSING", "PROBATION")
    current, judgement = current_mode(table), judge(own)
    holding, recovering = current.one_of(*table[2:]), current.eq(table[1])
    made = own.declared.machine(
        name="guard",
        modes=table,
        outputs=_outputs(own, holding),
        transitions=[
            _new_start(own, judgement, table),
            *(
                _recording_fix(own, judgement, row)
                for row in (*_held(own, judgement, table), *_free(own, judgement, table))
            ),
        ],
        world=own.declared.world(
            moves=law.moves(own, holding),
            clauses=law.clauses(own, holding),
            reads_machine="the host may count places from another origin while the output `holding` is false, and the way since "
            "the machine's anchor is a definition; no law of receiver or vehicle reads the machine",
        ),
        lemmas={**_rows(own, current, table), **law.lemmas(own, holding, current.one_of(*table[:2]), recovering)},
        definitions=_definitions(judgement),
        doc=(
            "Passes on those of a receiver's positions that map and motion allow, each with the interval along the way that "
            "contains the vehicle. Assumed: the vehicle moves within its speed, acceleration and brake; of fixes near the way "
            "that each follow from the one before as a vehicle can run, the one that completes the number asked for, and every "
            "further one, is wrong by no more than its error bound. Nothing is assumed of any other fix, nor of the receiver's "
            "quality flags. A receiver that errs along the track, slowly enough for a vehicle, for that many fixes, is not noticed."
        ),
    )
    return Guard(made, own, judgement)


def _rows(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas on the number of agreeing fixes in each mode."""
    lost, recovering, passing, probation = table
    full = own.config.confirmations
    return {
        "no row while withdrawn": current.eq(lost).iff(own.agreed_fixes.eq(0) & ~current.eq(probation)),
        "a row begun while recovering": current.eq(recovering).implies(between(1, own.agreed_fixes, full - 1)),
        "a full row while passing": current.eq(passing).iff(own.agreed_fixes.eq(full)),
    }


# ------------------------------------------------------------------ the transition table


def _recording_fix(own: Parts, cycle: Judgement, row: Transition) -> Transition:
    """Add to every other transition that it stores the fix as the last one near the way, and as the last known place, if it is one."""
    return replace(row, set=together(row.set, _last_near(own, cycle), _last_known(own, cycle)))


def _new_start(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Transition:
    """Return the transition of the host's new start: it forgets everything known before, and uses no fix of the same step."""
    verdict = ite(cycle.fair.eq(PASSED), UNCONFIRMED, cycle.fair)
    nothing = together(
        stored(own, _nothing()), _nowhere(own), {own.agreed_fixes: as_num(0, COUNT), own.last_verdict: verdict}
    )
    return Transition("new start", table, table[0], own.start_anew, nothing, REQUIREMENTS, -1)


def _held(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions while an interval is stored that contains the truth."""
    lost, _, passing, probation = table
    both, config = (passing, probation), own.config
    narrow, coasted = cycle.with_fix, cycle.coasted
    full, none = as_num(config.confirmations, COUNT), as_num(0, COUNT)
    kept = usable(config, coasted.box)

    def coast(agreed: Num, verdict: Num) -> Updates:
        return together(stored(own, coasted), {own.agreed_fixes: agreed, own.last_verdict: verdict})

    passed = together(stored(own, narrow), {own.agreed_fixes: full, own.last_verdict: PASSED})
    goes_on = cycle.agrees & cycle.follows
    yield Transition("fix passed on", passing, passing, goes_on, passed, REQUIREMENTS, 0)
    yield Transition("receiver believed again", probation, passing, goes_on & cycle.confirmed, passed, REQUIREMENTS, 0)
    lose = together(stored(own, _nothing()), {own.agreed_fixes: none, own.last_verdict: _withheld(cycle)})
    yield Transition("window given up", both, lost, ~kept, lose, REQUIREMENTS, 1)
    doubt = coast(none, cycle.verdict)
    yield Transition("implausible fix", both, probation, cycle.implausible, doubt, REQUIREMENTS, 2)
    none_or_one = ite(cycle.agrees, as_num(1, COUNT), none)
    contradicts = cycle.begins & ~cycle.follows
    begun_anew = coast(none_or_one, _withheld(cycle))
    yield Transition("fix contradicts the one before", both, probation, contradicts, begun_anew, REQUIREMENTS, 3)
    agreeing = coast(cycle.more, as_num(UNCONFIRMED, own.last_verdict.unit))
    yield Transition("fix agrees on probation", probation, probation, cycle.agrees, agreeing, REQUIREMENTS, 4)
    for mode in both:
        yield Transition(
            f"coast while {mode.label.lower()}",
            mode,
            mode,
            set=coast(own.agreed_fixes, _withheld(cycle)),
            requirements=REQUIREMENTS,
            rank=5,
        )


def _free(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions while no stored interval is known to contain the true place: fixes are only compared with each other."""
    lost, recovering, passing, _ = table
    fresh, config = cycle.fresh, own.config
    none, one = as_num(0, COUNT), as_num(1, COUNT)

    def begun_by(agreed: Num, verdict: Num) -> Updates:
        return together(stored(own, fresh), {own.agreed_fixes: agreed, own.last_verdict: verdict})

    full = begun_by(as_num(config.confirmations, COUNT), PASSED)
    agrees = cycle.agrees & cycle.begins
    yield Transition("receiver believed", recovering, passing, agrees & cycle.confirmed, full, REQUIREMENTS, 6)
    another = begun_by(cycle.more, UNCONFIRMED)
    yield Transition("fix agrees", recovering, recovering, agrees, another, REQUIREMENTS, 7)
    begin, anew = begun_by(one, UNCONFIRMED), begun_by(one, cycle.verdict)
    yield Transition("first fix", lost, recovering, cycle.begins, begin, REQUIREMENTS, 7)
    yield Transition("fix begins anew", recovering, recovering, cycle.begins, anew, REQUIREMENTS, 8)
    unusable = cycle.implausible | ~usable(config, cycle.coasted.box)
    empty = together(stored(own, _nothing()), {own.agreed_fixes: none, own.last_verdict: cycle.verdict})
    yield Transition("fixes dropped", recovering, lost, unusable, empty, REQUIREMENTS, 9)
    waiting = together(_carried(own, cycle.coasted.box), {own.last_verdict: cycle.verdict})
    yield Transition("agreeing fixes carried", recovering, recovering, set=waiting, requirements=REQUIREMENTS, rank=10)
    yield Transition(
        "wait for a fix", lost, lost, set={own.last_verdict: cycle.fair}, requirements=REQUIREMENTS, rank=10
    )


# ------------------------------------------------------------------ groups of updates: what the transitions set


def stored(own: Parts, now: Held) -> Updates:
    """Return whether the box and its anchor are those."""
    box, anchor = now.box, now.anchor
    return {
        own.low: box.low, own.high: box.high, own.slow: box.slow, own.fast: box.fast,
        own.anchor_low: anchor.low, own.anchor_high: anchor.high, own.anchor_steps: anchor.steps,
    }  # fmt: skip


def _last_near(own: Parts, cycle: Judgement) -> Updates:
    """This fix is the last one near the way, if it is one; otherwise the stored places are moved on."""
    fix, (low, high), passes = of_fix(own), cycle.near, cycle.alone.eq(PASSED)
    return {own.near_low: ite(passes, fix.low, low), own.near_high: ite(passes, fix.high, high)}


def _last_known(own: Parts, cycle: Judgement) -> Updates:
    """Fair fixes in a row are counted; one that fills the row narrows the last known place, which else is moved on."""
    fix, (low, high), full = of_fix(own), cycle.known, own.config.confirmations
    ends = (cycle.alone.eq(PASSED) & ~cycle.begins) | cycle.alone.eq(OFF_TRACK)
    longer = ite(cycle.follows & ~own.elsewhere, minimum(own.fair_fixes + 1, full), as_num(1, COUNT))
    row = ite(cycle.begins, longer, ite(ends, as_num(0, COUNT), own.fair_fixes))
    fills = cycle.begins & row.eq(full)
    return {
        own.fair_fixes: row,
        own.known_low: ite(fills, maximum(fix.low, low), low),
        own.known_high: ite(fills, minimum(fix.high, high), high),
    }


def _nowhere(own: Parts) -> Updates:
    """No fix near the way and no place of the vehicle is known: both may be anywhere on the line."""
    low, high = as_num(own.near_low.low, NM), as_num(own.near_low.high, NM)
    return {
        own.near_low: low, own.near_high: high, own.known_low: low, own.known_high: high, own.fair_fixes: as_num(0, COUNT),
    }  # fmt: skip


def _carried(own: Parts, box: Box) -> Updates:
    """Return updates that store the moved box of the last fix, as its own anchor."""
    return stored(own, begun(box))


def _nothing() -> Held:
    zero, rest = as_num(0, NM), as_num(0, UM_S)
    return begun(Box(zero, zero, rest, rest))


def _withheld(cycle: Judgement) -> Num:
    """Return the reason: that of the verdict, or UNCONFIRMED for a fix that passed all checks and is withheld all the same."""
    return ite(cycle.agrees, UNCONFIRMED, cycle.verdict)


def _definitions(cycle: Judgement) -> dict[str, Expr]:
    """Name the terms of the table."""
    return {
        "verdict on the delivery": cycle.verdict,
        "verdict on the delivery alone": cycle.alone,
        "verdict by course and reach": cycle.fair,
        "fix agrees": cycle.agrees,
        "as many agree as asked for": cycle.confirmed,
        "fix follows from the one before": cycle.follows,
        "fix implausible": cycle.implausible,
        "low without it": cycle.coasted.box.low,
        "high without it": cycle.coasted.box.high,
        "slow without it": cycle.coasted.box.slow,
        "fast without it": cycle.coasted.box.fast,
        "low with it": cycle.with_fix.box.low,
        "high with it": cycle.with_fix.box.high,
        "slow with it": cycle.with_fix.box.slow,
        "fast with it": cycle.with_fix.box.fast,
    }


# ------------------------------------------------------------------ what is reported


def _outputs(own: Parts, holding: Bool) -> dict[str, Expr]:
    valid = holding & tolerable(own.config, Box(own.low, own.high, own.slow, own.fast))
    low, high = floor_to(own.low, MM), ceil_to(own.high, MM)
    middle = floor_div(low + high, 2)
    return {
        "valid": valid,
        "passed": own.last_verdict.eq(PASSED),
        "position_mm": position_if(valid, middle),
        "margin_below_mm": margin_if(valid, middle - low),
        "margin_above_mm": margin_if(valid, high - middle),
        "window_from_mm": position_if(holding, low),
        "window_to_mm": position_if(holding, high),
        "holding": holding,
        "known_from_mm": floor_to(own.known_low, MM) - own.config.rollback_mm,
        "known_to_mm": ceil_to(own.known_high, MM),
        "agreed_fixes": own.agreed_fixes,
        "reason": own.last_verdict,
    }
