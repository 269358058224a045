"""Properties of each mismatch that withholds a fibre position, and of all of them together (FVA-1 to FVA-8).

Every mismatch is written from the inputs of the cycle and from the state, in figures of its own. Rounding makes two
figures of a jump: from one millimetre beyond the reach on it must withhold, and within the reach it must not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial

from safeloc.language.expr import Bool, Lit, Num, abs_, all_of, any_of, before, was, with_unit
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, MM_S, NM
from safeloc.models.verification import Verification
from safeloc.models.verification import variables as v
from safeloc.models.verification.variables import Parts
from safeloc.properties.verification.abilities import Abilities
from safeloc.properties.verification.reach import beyond_reach
from safeloc.properties.verification.requirements import CLAIM, CONTROL, COUNTED, COURSE, ENTRY, STAY

NAMED: Mapping[str, tuple[Lit, str, tuple[str, ...]]] = {
    "another count is withheld": (
        v.COUNT_DIFFERS,
        "a count that differs from the counter's withholds in the same cycle",
        (*CLAIM, *STAY),
    ),
    "another length is withheld": (
        v.LENGTH_DIFFERS,
        "a length that differs from the counter's beyond both tolerances withholds in the same cycle",
        (*CLAIM, *STAY),
    ),
    "another length by train control is withheld": (
        v.CONTROL_LENGTH,
        "a length from train control that contradicts the reference withholds; it never replaces it",
        CONTROL,
    ),
    "control data do not repair": (
        v.CONTROL_COUNT,
        "train control data that contradict the reference withhold; they never replace it",
        CONTROL,
    ),
    "ends too far apart are withheld": (
        v.ENDS_APART,
        "two located ends whose distance fits no length of the reference withhold in the same cycle",
        (*CLAIM, *STAY),
    ),
    "another speed at the counter is withheld": (
        v.SPEED_AT_ENTRY,
        "at the counter the fibre's speed is the counter's, within the tolerance and the possible change since "
        "the record",
        ENTRY,
    ),
    "another place at the counter is withheld": (
        v.PLACE_AT_ENTRY,
        "at the counter the fibre's interval overlaps the counter's, within the tolerance and the farthest run "
        "since the record",
        ENTRY,
    ),
    "another record of the same stay is withheld": (
        v.REFERENCE_CONTRADICTS,
        "a record that contradicts the stored one withholds in the same cycle, also if the fibre agrees with it",
        (*COUNTED, *STAY),
    ),
    "a length that changes withholds": (
        v.LENGTH_CHANGED,
        "a length that differs from the one before withholds in the same cycle",
        COURSE,
    ),
    "a speed that no train changes withholds": (
        v.SPEED_CHANGED,
        "the speed changes by no more than traction, brakes and both tolerances allow; the brakes are those that "
        "train control reports, if it does",
        (*COURSE, *CONTROL),
    ),
    "a jump withholds": (
        v.JUMP,
        "the front is no farther from its last place than its speed and both intervals allow",
        COURSE,
    ),
    "a place out of reach is withheld": (
        v.OUT_OF_REACH,
        "an interval that the train cannot have reached from its last counter, even at top speed, withholds in "
        "the same cycle",
        (*CLAIM, *STAY),
    ),
}
for_all_inputs = partial(always, requirements=(*CLAIM, *COURSE), unconditional=True)


def properties(model: Verification) -> Iterator[Property]:
    """Yield the properties: each mismatch withholds; all of them make the train untrusted; nothing else does."""
    machine, own = model.machine, model.own
    _, withheld, trusted, untrusted = machine.modes
    mode, was_known = machine.mode, before(machine.mode).one_of(withheld, trusted)
    must, may = mismatches(own, was_known, 1), mismatches(own, was_known, 0)
    for name, (reason, statement, trace) in NAMED.items():
        withholds = must[reason].implies(~machine.flag("trusted"))
        yield for_all_inputs(name, withholds, statement=statement, requirements=trace)
    compared = any_of([own.due, *(before(mode).eq(one) for one in (withheld, trusted))]) & ~own.leaves
    yield for_all_inputs(
        "mismatch withholds in the same cycle",
        (compared & any_of(must.values())).implies(mode.eq(untrusted)),
        statement="with any mismatch the train is untrusted in the same cycle",
    )
    newly = before(mode).ne(untrusted) & mode.eq(untrusted)
    yield for_all_inputs(
        "a train is untrusted only for the reported reason",
        newly.implies(compared & any_of(own.why.eq(reason) & one for reason, one in may.items())),
        statement="a train becomes untrusted only by a mismatch of that cycle, and the reason names it",
        requirements=COURSE,
    )


def mismatches(own: Parts, was_known: Bool, least_mm: int) -> dict[Lit, Bool]:
    """Return every mismatch by its reason; a jump from `least_mm` beyond the reach on."""
    return {
        **_of_record(own, was_known),
        **_of_parameters(own),
        **_at_counter(own),
        **_of_course(own, least_mm),
        v.OUT_OF_REACH: beyond_reach(own),
        v.FIBRE_ERROR: own.fibre_error,
        **({v.CHAIN_FAILED: own.chain_failed} if own.config.needs_emitter else {}),
    }


# ------------------------------------------------------------------ the record


def _of_record(own: Parts, was_known: Bool) -> dict[Lit, Bool]:
    """Return the mismatches of a record: it did not come, is unusable, or contradicts the stored one."""
    config, came = own.config, own.due & own.reference_from.one_of(v.AXLE_COUNTER, v.NEIGHBOUR)
    old = own.record_age > config.reference_age_limit_cycles
    crossed = any_of(high < low for low, high in record_bounds(own))
    other = [
        own.record_axles.ne(before(own.stored_axles)),
        before(own.stored_length_low) > own.record_length_high,
        before(own.stored_length_high) < own.record_length_low,
    ]
    return {
        v.REFERENCE_LOST: own.due & own.reference_from.eq(v.NOBODY),
        v.REFERENCE_REFUSED: came & any_of([~own.sound, old, own.record_axles.eq(0), crossed]),
        v.REFERENCE_CONTRADICTS: was_known & any_of(came & one for one in other),
    }


def record_bounds(own: Parts) -> tuple[tuple[Num, Num], ...]:
    """Return the lower and the upper bound of each measurement of the record: length, place and speed."""
    return (
        (own.record_length_low, own.record_length_high),
        (own.record_place_low, own.record_place_high),
        (own.record_speed_low, own.record_speed_high),
    )


def _against(own: Parts, differs: Callable[[Num, Num, Num], Bool]) -> Bool:
    """Return the condition that a reading differs from the record that is due, or else from the stored one."""
    told = differs(own.record_axles, own.record_length_low, own.record_length_high)
    kept = differs(before(own.stored_axles), before(own.stored_length_low), before(own.stored_length_high))
    return (own.due & told) | (~own.due & kept)


# ------------------------------------------------------------------ parameters that do not change during a stay


def _of_parameters(own: Parts) -> dict[Lit, Bool]:
    """Return the mismatches of count, length and distance of the ends; the same for train control."""
    near, far, tolerance = own.ends_low, own.ends_high, own.config.length_tolerance_mm

    def length(stated: Num) -> Bool:
        return _against(own, lambda _, low, high: (stated + tolerance < low) | (stated - tolerance > high))

    def count(stated: Num) -> Bool:
        return _against(own, lambda count, _low, _high: stated.ne(count))

    apart = _against(
        own,
        lambda _, low, high: (
            (near.present & (near.value - tolerance > high)) | (far.present & (far.value + tolerance < low))
        ),
    )
    return {
        v.COUNT_DIFFERS: own.associated & own.fibre_axles.present & count(own.fibre_axles.value),
        v.LENGTH_DIFFERS: own.associated & own.fibre_length.present & length(own.fibre_length.value),
        v.ENDS_APART: apart | all_of([near.present, far.present, near.value > far.value]),
        v.CONTROL_COUNT: own.control_axles.present & count(own.control_axles.value),
        v.CONTROL_LENGTH: own.control_length.present & length(own.control_length.value),
    }


# ------------------------------------------------------------------ at the counter


def _at_counter(own: Parts) -> dict[Lit, Bool]:
    """Return the mismatches of speed and place in the cycle of the record."""
    config = own.config
    here = own.associated & own.due & own.reference_from.eq(v.AXLE_COUNTER)
    most = -(-max(config.traction_mm_s2, config.brake_mm_s2) * config.period_ms // 1_000)
    run = -(-config.max_speed_mm_s * config.period_ms // 1_000)
    changed, ran = with_unit(own.record_age * most, MM_S), with_unit(own.record_age * run, MM)
    speed, place = own.fibre_speed, own.fibre_position
    less, more = own.record_speed_low - speed.value, speed.value - own.record_speed_high
    off = (less - config.speed_tolerance_mm_s > changed) | (more - config.speed_tolerance_mm_s > changed)
    beyond = place.value - own.record_place_high - own.fibre_margin_below - config.place_tolerance_mm > ran
    short = own.record_place_low - place.value - own.fibre_margin_above - config.place_tolerance_mm > ran
    return {
        v.SPEED_AT_ENTRY: here & speed.present & off,
        v.PLACE_AT_ENTRY: here & own.located & place.present & (beyond | short),
    }


# ------------------------------------------------------------------ the course over time


def _of_course(own: Parts, least_mm: int) -> dict[Lit, Bool]:
    """Return the mismatches of length, speed and place with the last readings."""
    length, speed, able = own.fibre_length, own.fibre_speed, Abilities(own)
    change = abs_(before(own.last_length) - length.value)
    run, place = own.fibre_position.value - before(own.last_place), own.fibre_position
    reach = able.run_nm + Lit((own.config.jump_mm + least_mm) * 1_000_000, NM)
    above = _nm(run - before(own.reach_since) - before(own.front_margin_above) - own.fibre_margin_below)
    below = _nm(-run - before(own.reach_since) - before(own.front_margin_below) - own.fibre_margin_above)
    jump = (above >= reach) | (below >= reach) if least_mm else (above > reach) | (below > reach)
    return {
        v.LENGTH_CHANGED: own.associated
        & length.present
        & was(own.length_known)
        & (change > own.config.length_change_mm),
        v.SPEED_CHANGED: own.associated & speed.present & was(own.speed_known) & able.exceeded_by(speed.value),
        v.JUMP: all_of([own.associated, was(own.place_known), own.located, place.present, jump]),
    }


def _nm(mm: Num) -> Num:
    return with_unit(mm * 1_000_000, NM)
