"""A train's fibre position, reported only while it is verified against the record of an axle counter (FVA-1 to FVA-8).

    NO_REFERENCE  no record to verify against: withheld
    WITHHELD      a reference is stored, but at present the position is not verified: withheld
    TRUSTED       verified: the position is reported
    UNTRUSTED     a mismatch was found: withheld, and a position reported before is revoked

A reference is the entry record of an axle counter, or that record handed over by the neighbouring area while it trusted the
train. The machine accepts it once and uses it for the whole stay. The axle count must be identical, the length equal
within the tolerances of both sides; speed and place are compared with the counter's only in the cycle of the reference.
Later the place is compared with the stretch that the train can have reached since that reference at top speed, as long as
this stretch is no longer than permitted. Any mismatch withholds the position in the same cycle and is latched; only another
accepted reference ends it. Missing data withhold as well, and never count as success.

The machine has two worlds: the fibre's readings are true within their bounds (`world`), or may be wrong in any way (`doubted`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from safeloc.language.expr import FALSE, TRUE, Bool, Expr, Lit, NumVar, as_num, ite, maximum, minimum
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM
from safeloc.models.verification.doubted import Doubted, doubted
from safeloc.models.verification.doubted import world as doubted_world
from safeloc.models.verification.judgement import Judgement, judge
from safeloc.models.verification.lemmas import lemmas, without_belief
from safeloc.models.verification.variables import NO_RECORD, NOT_VERIFIED, VERIFIED, Parts, VerificationConfig, parts
from safeloc.models.verification.world import world
from safeloc.models.vocabulary.absent import margin_if, position_if

__all__ = ["Verification", "VerificationConfig", "build", "build_doubted", "machine", "parts"]
REQUIREMENTS = ("FVA-1", "FVA-2", "FVA-10", "FVA-11")
ENTRY = (*REQUIREMENTS, "FVA-3", "FVA-12", "FVA-4", "FVA-13", "FVA-14", "FVA-D1")
BELIEVED = (
    "Verifies one train's fibre parameters against the record of an axle counter. Assumed: a count that the "
    "fibre reports is that of the train whose pattern it is; a length is true within the fibre's tolerance; a "
    "located interval contains the front (proved of the fibre machine). Nothing is assumed of the record beyond "
    "its bounds, of train control data, or of which train a pattern belongs to: the machine verifies these."
)
_DOUBTED = (
    "Verifies one train's fibre parameters against the record of an axle counter. Nothing is assumed of the "
    "fibre's readings: count, length, speed, place and the pattern's identity may be wrong, alone or together, "
    "from any moment on. Assumed: the axle counter's record is true, the data that a neighbour hands over are "
    "true, no train runs faster than the top speed, and no other train takes its place unreported."
)
COURSE = ("FVA-6", "FVA-15", "FVA-7", "FVA-16", "FVA-8", "FVA-17")


@dataclass(frozen=True, eq=False)
class Verification(Model[Parts]):
    """The machine together with the terms from which it was built; properties refer to these terms.

    train  ghosts of the train if nothing is assumed of the fibre; None if its readings are true within their bounds
    """

    judgement: Judgement
    train: Doubted | None = None


def machine(config: VerificationConfig | None = None) -> Machine:
    """Return the machine that verifies one train (FVA-1)."""
    return build(parts(config or VerificationConfig())).machine


def build(own: Parts, *, name: str = "verification", place_kept: bool = False) -> Verification:
    """Return the machine over the given variables; `place_kept`: an earlier machine guarantees the interval, so it is not assumed."""
    around = world(own, place_kept=place_kept)
    return _built(own, name, lambda _, trusted: {"world": around, "lemmas": lemmas(own, trusted), "doc": BELIEVED})


def build_doubted(own: Parts) -> Verification:
    """Return the same machine in the world in which the fibre's readings may be wrong and an axle counter's record is true."""
    train = doubted(own)

    def around(known: Bool, trusted: Bool) -> dict[str, Any]:
        found = without_belief(train, known, trusted)
        return {"world": doubted_world(train), "lemmas": found, "doc": _DOUBTED}

    return replace(_built(own, "verification_doubted", around), train=train)


def _built(own: Parts, name: str, around: Callable[[Bool, Bool], Mapping[str, Any]]) -> Verification:
    """Return the machine in a world; `around` maps "reference stored" and "trusted" to world, lemmas and doc."""
    table = modes("NO_REFERENCE", "WITHHELD", "TRUSTED", "UNTRUSTED")
    current = current_mode(table)
    known = current.one_of(table[1], table[2])
    judgement = judge(own, known, current.eq(table[3]))
    made = own.declared.machine(
        name=name,
        modes=table,
        outputs=_outputs(own, current, table),
        transitions=list(_table(own, judgement, table)),
        definitions={
            "mismatch": judgement.mismatch,
            "why": judgement.flaw,
            "reference accepted": judgement.accepted,
            "count matches": judgement.count_matches,
            "length matches": judgement.length_matches,
            "missing": judgement.missing,
            "cycles since a verification": judgement.age,
        },
        **around(known, current.eq(table[2])),
    )
    return Verification(made, own, judgement)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, judgement: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    none, withheld, trusted, untrusted = table
    known, course = (withheld, trusted), (*REQUIREMENTS, *COURSE)
    good, fresh = judgement.verified & ~judgement.missing, judgement.current & ~judgement.missing
    lack: Updates = {own.why: ite(judgement.missing, judgement.lack, NOT_VERIFIED)}
    verified: Updates = {own.why: VERIFIED, own.given_out: TRUE}
    taken = together(_readings(own, judgement), _record(own), _rests_on_record(own, judgement))
    goes_on = together(_readings(own, judgement), _rests_on(own, judgement))
    gone = together(_forgotten(own), {own.why: NO_RECORD, own.given_out: FALSE})
    yield Transition("train has left", table, none, own.leaves, gone, REQUIREMENTS, 0)
    yield Transition(
        "mismatch", table, untrusted, judgement.mismatch,
        together(_forgotten(own), {own.why: judgement.flaw}), (*REQUIREMENTS, "FVA-6", "FVA-7", "FVA-8"), 1)  # fmt: skip
    yield Transition(
        "reference accepted and verified", table, trusted, judgement.accepted & good,
        together(taken, verified), ENTRY, 2)  # fmt: skip
    yield Transition(
        "reference accepted", table, withheld, judgement.accepted & ~good,
        together(taken, lack, {own.given_out: FALSE}), ENTRY, 2)  # fmt: skip
    yield Transition("verified", known, trusted, good, together(goes_on, verified), course, 3)
    yield Transition("still verified", trusted, trusted, fresh, together(goes_on, verified), course, 4)
    yield Transition("not verified now", known, withheld, TRUE, together(goes_on, lack), course, 5)
    yield Transition("mismatch stays latched", untrusted, untrusted, TRUE, {}, REQUIREMENTS, 5)
    yield Transition("no train", none, none, TRUE, gone, REQUIREMENTS, 5)


# ------------------------------------------------------------------ groups of updates


def _readings(own: Parts, judgement: Judgement) -> Updates:
    """Store the last readings with bounds of later changes, the places possible by the record, and the front's interval."""
    slower, faster = judgement.abilities
    speed, length = own.associated & own.fibre_speed.present, own.associated & own.fibre_length.present
    return {
        own.possible_low: judgement.possible[0],
        own.possible_high: judgement.possible[1],
        own.length_known: own.length_known | length,
        own.last_length: ite(length, own.fibre_length.value, own.last_length),
        own.speed_known: own.speed_known | speed,
        own.last_speed: ite(speed, own.fibre_speed.value, own.last_speed),
        own.slower_by: ite(speed, 0, slower),
        own.faster_by: ite(speed, 0, faster),
        own.place_known: own.place_known | judgement.placed,
        own.last_place: ite(judgement.placed, own.fibre_position.value, own.last_place),
        own.reach_since: ite(judgement.placed, 0, judgement.reach),
        own.front: ite(judgement.placed, own.fibre_position.value, own.front),
        own.front_margin_above: ite(judgement.placed, own.fibre_margin_above, own.front_margin_above),
        own.front_margin_below: ite(judgement.placed, own.fibre_margin_below, own.front_margin_below),
    }


def _record(own: Parts) -> Updates:
    """Store the accepted record."""
    return {
        own.stored_axles: own.record_axles,
        own.stored_length_low: own.record_length_low,
        own.stored_length_high: own.record_length_high,
    }


def _rests_on_record(own: Parts, judgement: Judgement) -> Updates:
    """Rest trust on the comparison with the record accepted in this cycle."""
    return {
        own.verified_ago: ite(judgement.verified, 0, as_num(own.verified_ago.high, COUNT)),
        own.by_count: judgement.count_matches,
        own.by_length: judgement.length_matches,
        own.by_speed_at_entry: judgement.speed_compared,
        own.by_place_at_entry: judgement.place_compared,
        own.by_control_data: judgement.controlled,
        own.by_emitter: own.chain_tested,
    }


def _rests_on(own: Parts, judgement: Judgement) -> Updates:
    """Rest trust on the last verification; the comparisons made at the entry stay."""
    return {
        own.verified_ago: judgement.age,
        own.by_count: ite(judgement.verified, judgement.count_matches, own.by_count),
        own.by_length: ite(judgement.verified, judgement.length_matches, own.by_length),
        own.by_control_data: judgement.controlled | own.by_control_data,
        own.by_emitter: own.chain_tested,
    }


def _forgotten(own: Parts) -> Updates:
    """Clear all data of the train."""
    return together(dict.fromkeys((*own.numbers, own.verified_ago), 0), dict.fromkeys((*own.flags, *own.known), FALSE))


# ------------------------------------------------------------------ outputs


def _outputs(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Expr]:
    """Return the outputs: position while trusted, the verified parameters, and the record for the neighbour."""
    trusted, known = current.eq(table[2]), current.one_of(table[1], table[2])
    zero = as_num(0, MM)
    return {
        "trusted": trusted,
        "untrusted": current.eq(table[3]),
        "revoked": current.eq(table[3]) & own.given_out,
        "position_mm": position_if(trusted, own.front),
        "margin_above_mm": margin_if(trusted, own.front_margin_above),
        "margin_below_mm": margin_if(trusted, own.front_margin_below),
        "reason": own.why,
        "verified_count": own.by_count,
        "verified_length": own.by_length,
        "verified_speed_at_entry": own.by_speed_at_entry,
        "verified_place_at_entry": own.by_place_at_entry,
        "verified_train_control": own.by_control_data,
        "verified_by_emitter": trusted & own.by_emitter,
        "verified_cycles_ago": own.verified_ago,
        "handover_trusted": trusted,
        "handover_axles": ite(known, own.stored_axles, as_num(0, COUNT)),
        "handover_length_low_mm": ite(known, own.stored_length_low, zero),
        "handover_length_high_mm": ite(known, own.stored_length_high, zero),
        "handover_place_low_mm": ite(known, maximum(own.possible_low, own.record_place_low.low), zero),
        "handover_place_high_mm": ite(known, minimum(own.possible_high, own.record_place_high.high), zero),
        "place_doubt_mm": ite(trusted, own.possible_high - own.possible_low + own.config.place_tolerance_mm, zero),
    }
