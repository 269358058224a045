"""Properties of a counted entry as one: what a verified position rests on where the counter and the train are known (FVA-3, FVA-4).

No record is an input of the whole: that an undisturbed one is true is proved of the counter. What the verification claims of a fibre
that may be wrong in everything, it keeps here of the train that passed the head. The count of the record is compared with the axles
that passed, in the counter's world, and not with what the machine has stored.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, between, exact_to, ite, maximum
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import NM, UM, UM_PER_MM
from safeloc.models.axle_head import UP
from safeloc.models.counted_entry import CountedEntry
from safeloc.models.verification.variables import VERIFIED
from safeloc.properties import axle_counter, verification

LAW = (
    f"{axle_counter.LAW}; no vehicle overhangs its axles, and no axle is counted beyond the head, farther than configured; no train runs faster than the top speed, and no other "
    "one takes its place unreported; nothing is assumed of the messages of the fibre, the emitter or train control"
)
REQUIREMENTS = ("FVA-3", "FVA-12", "FVA-4", "FVA-13")
_OF_THE_VERIFICATION = (
    "a place at the counter",
    "a place at any time",
    "the reported doubt holds",
    "a wrong count withholds",
    "a wrong length withholds",
    "a speed at the counter",
)
"""Claimed of the verification where a record is assumed to be true; here the counter makes it."""
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: CountedEntry) -> list[Property]:
    """Return the properties of the whole device."""
    return [*_counted(whole), *_disturbed(whole), *_heard(whole), *_kept(whole), *_reached(whole)]


# ------------------------------------------------------------------ terms


def _recorded(whole: CountedEntry) -> Bool:
    """An undisturbed record comes in this cycle."""
    return whole.composition.of(whole.counter.machine).bool(whole.counter.machine.flag("record_sound"))


def _trusted(whole: CountedEntry) -> Bool:
    return whole.composition.of(whole.verified.machine).bool(whole.verified.machine.flag("trusted"))


def _stored(whole: CountedEntry) -> Bool:
    """The verification has a record to compare with: it reports a position, or could."""
    machine = whole.verified.machine
    return whole.composition.of(machine).bool(machine.mode.one_of(machine.modes[1], machine.modes[2]))


# ------------------------------------------------------------------ what passed the head


def _counted(whole: CountedEntry) -> Iterator[Property]:
    counter, verified = whole.counter, whole.composition.of(whole.verified.machine)
    of_counter, machine = whole.composition.of(counter.machine), whole.verified.machine
    yield under_assumption(
        "the axles that passed are compared",
        (_recorded(whole) & _trusted(whole)).implies(
            verified.num(machine.output("handover_axles")).eq(of_counter.num(counter.own.axles))
        ),
        statement="a position that is trusted with a record is compared with as many axles as passed the head",
    )
    low, high = (verified.num(machine.output(f"handover_length_{end}_mm")) for end in ("low", "high"))
    along = of_counter.num(counter.own.length)
    length = ite(of_counter.bool(counter.own.last_axle_upwards), along, -along)
    yield under_assumption(
        "the length that passed is compared",
        (_recorded(whole) & _trusted(whole) & (length >= 0)).implies(
            between(exact_to(low, NM), length, exact_to(high, NM))
        ),
        statement="the bounds with which a trusted train's length is compared contain its length from first to last axle",
    )


def _disturbed(whole: CountedEntry) -> Iterator[Property]:
    """Claim what a passage with a flaw leaves: nothing."""
    counter, stored = whole.composition.of(whole.counter.machine), _stored(whole)
    ready = counter.bool(whole.counter.machine.flag("record_ready"))
    fault = counter.bool(whole.counter.own.fault)
    yield for_all_inputs(
        "no position without an undisturbed record",
        (~earlier_bool(stored) & stored).implies(_recorded(whole)),
        statement="a train is verified only from the cycle on in which its undisturbed record comes",
    )
    yield for_all_inputs(
        "a disturbed record verifies nobody",
        (ready & ~_recorded(whole)).implies(~stored),
        statement="in the cycle of a record with a flaw no position is trusted, and no earlier record is gone on with",
    )
    yield for_all_inputs(
        "a head at fault begins no verification",
        (fault & ~earlier_bool(stored)).implies(~stored),
        statement="in a cycle in which the counting head is at fault no train begins to be verified",
    )


def _heard(whole: CountedEntry) -> Iterator[Property]:
    """Claim that a sound record is used, and as narrow as it is: a wider one would be true as well, and verify less."""
    own, into = whole.verified.own, whole.composition.of(whole.verified.machine)
    machine, recorded = whole.verified.machine, _recorded(whole)
    yield for_all_inputs(
        "an undisturbed record is handed over",
        into.bool(own.due & own.sound).iff(recorded) & recorded.implies(into.num(own.record_age).eq(0)),
        statement="the verification gets a sound record in exactly the cycles in which the counter has an undisturbed one, and in that cycle",
    )
    place, speed = (into.bool(machine.flag(f"verified_{one}_at_entry")) for one in ("place", "speed"))
    told = into.bool(own.associated & own.fibre_speed.present)
    yield for_all_inputs(
        "at the counter place and speed are compared",
        (recorded & _trusted(whole)).implies(place & told.implies(speed)),
        statement="a train that is trusted in the cycle of its record has had its place compared with the counter's, and its speed if the fibre told one",
    )
    yield for_all_inputs(
        "the record is no wider than the counter's",
        recorded.implies(all_of(_narrow(whole))),
        statement="the bounds of length, place and speed that are compared are those of the counter, rounded to whole millimetres, and at the "
        "place of the front with the overhang",
    )


def _narrow(whole: CountedEntry) -> Iterator[Bool]:
    """Widths alone: that the bounds contain the train's length, place and speed is owed anyway."""
    own, into = whole.verified.own, whole.composition.of(whole.verified.machine)
    counter, machine = whole.composition.of(whole.counter.machine), whole.counter.machine

    def recorded(name: str) -> Num:
        return counter.num(machine.output(f"record_{name}"))

    def width(name: str, unit: str) -> Num:
        return recorded(f"{name}_high_{unit}") - recorded(f"{name}_low_{unit}")

    low, high = (exact_to(into.num(bound), UM) for bound in (own.record_length_low, own.record_length_high))
    yield low > recorded("length_low_um") - 1_000
    yield high < maximum(recorded("length_high_um"), 0) + 1_000
    upwards = recorded("direction").eq(UP)
    overhang_um = (whole.config.overhang_mm + 2) * UM_PER_MM
    along = exact_to(into.num(own.record_place_high) - into.num(own.record_place_low), UM) - overhang_um
    yield along <= width("run", "um") + ite(upwards, 0, width("length", "um"))
    yield (into.num(own.record_speed_high) - into.num(own.record_speed_low)).eq(width("speed", "mm_s"))


def _kept(whole: CountedEntry) -> Iterator[Property]:
    """Return the properties that the verification keeps although the fibre may be wrong, because it relies on the
    counter's record.
    """
    for claim in verification.properties(whole.verified):
        if claim.name in _OF_THE_VERIFICATION:
            kept = whole.composition.inherited(whole.verified.machine, claim)
            yield replace(kept, assumption=LAW, requirements=(*REQUIREMENTS, *claim.requirements))


def _reached(whole: CountedEntry) -> Iterator[Property]:
    machine = whole.verified.machine
    reason = whole.composition.of(machine).num(machine.output("reason"))
    yield reachable(
        "a counted train is verified",
        _recorded(whole) & _trusted(whole) & reason.eq(VERIFIED),
        statement="a train is trusted in the cycle of its record",
        requirements=REQUIREMENTS,
    )
