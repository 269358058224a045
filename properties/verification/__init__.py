"""Properties of a verified fibre position (FVA-1 to FVA-8, FVA-D1)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, any_of, before, between, exact_to, ite, minimum, was
from safeloc.language.spec import Property, always, reachable, since
from safeloc.language.units import NM, UM
from safeloc.models.verification import Verification
from safeloc.models.verification import variables as v
from safeloc.models.verification.variables import Parts
from safeloc.properties.no_interval import no_interval
from safeloc.properties.verification.abilities import properties as ability_properties
from safeloc.properties.verification.doubted import properties as doubted_properties
from safeloc.properties.verification.mismatch import properties as mismatch_properties
from safeloc.properties.verification.mismatch import record_bounds
from safeloc.properties.verification.reach import properties as reach_properties
from safeloc.properties.verification.requirements import CLAIM, CONTROL, COUNTED, COURSE, EMITTER, ENTRY, STAY
from safeloc.properties.verification.rests_on import properties as rests_on_properties
from safeloc.properties.verification.told import properties as told_properties

LAW = (
    "the fibre's readings of a train are true of that train within their bounds; a located interval contains the front"
)
for_all_inputs = partial(always, requirements=(*CLAIM, *STAY), unconditional=True)
under_assumption = partial(always, requirements=(*CLAIM, "FVA-D1"), assumption=LAW)


def properties(model: Verification) -> list[Property]:
    """Return the properties: only verified positions are reported; a mismatch withholds at once, until another reference is accepted.

    If the fibre may be wrong, only the properties of that world: those for all inputs are claimed of the same machine elsewhere.
    """
    if model.train is not None:
        return doubted_properties(model, model.train)
    return [
        *_truth(model),
        *_identity(model),
        *_age(model),
        *_latch(model),
        *_withheld(model),
        *_revoked(model),
        *_given_out(model),
        *_inputs(model),
        *_control(model),
        *_record(model),
        *_missing(model),
        *_at_entry(model),
        *mismatch_properties(model),
        *ability_properties(model),
        *reach_properties(model),
        *rests_on_properties(model),
        *told_properties(model),
        *_handed_over(model),
        *_reached(model),
    ]


def _truth(model: Verification) -> Iterator[Property]:
    """Claim that a trusted position contains the front."""
    machine, own = model.machine, model.own
    trusted = machine.flag("trusted")
    position = machine.output("position_mm")
    low, high = position - machine.output("margin_below_mm"), position + machine.output("margin_above_mm")
    yield under_assumption(
        "containment",
        trusted.implies(between(exact_to(low, NM), own.truth, exact_to(high, NM))),
        statement="a position that is reported as trusted contains the front of the train",
        requirements=CLAIM,
    )


def _identity(model: Verification) -> Iterator[Property]:
    """Claim that count and length of the followed train are those of the record."""
    machine, own = model.machine, model.own
    trusted = machine.flag("trusted")
    tolerance = own.config.length_tolerance_mm * 2_000
    now = trusted & machine.output("verified_cycles_ago").eq(0)
    yield under_assumption(
        "verified count is the train's",
        (now & machine.flag("verified_count")).implies(own.axles.eq(own.stored_axles)),
        statement="in a cycle verified by count, the followed train had as many axles as the counter counted, at the "
        "moment to which the count refers: identity",
    )
    yield under_assumption(
        "verified length is the train's",
        (now & machine.flag("verified_length")).implies(
            between(
                exact_to(own.stored_length_low, UM) - tolerance,
                own.length,
                exact_to(own.stored_length_high, UM) + tolerance,
            )
        ),
        statement="in a cycle verified by length, the train's length agrees with the counter's within both tolerances",
    )
    counted = own.associated & own.fibre_axles.present
    yield under_assumption(
        "another train is withheld",
        (counted & own.axles.ne(own.stored_axles)).implies(~trusted),
        statement="in a cycle in which the fibre counts a train with another number of axles, the train is not trusted: it "
        "is another train, or has lost a wagon",
        requirements=(*CLAIM, *STAY),
    )


def _age(model: Verification) -> Iterator[Property]:
    """Claim the beginning of trust, and the age of a verification."""
    machine, own = model.machine, model.own
    _, withheld, trusted_mode, _ = machine.modes
    mode, trusted = machine.mode, machine.flag("trusted")
    yield for_all_inputs(
        "trusted is currently verified",
        trusted.implies((own.verified_ago <= own.config.currency_cycles) & (own.by_count | own.by_length)),
        statement="a train is trusted only with a verification by count or length within the last currency_cycles",
    )
    yield for_all_inputs(
        "trust begins with a verification",
        (trusted & before(mode).ne(trusted_mode)).implies(own.verified_ago.eq(0) & _verified_now(own)),
        statement="a position is trusted again only in a cycle in which count or length was determined and matched",
        requirements=CLAIM,
    )
    follows = before(mode).one_of(withheld, trusted_mode) & mode.one_of(withheld, trusted_mode)
    older = ite(own.due, own.verified_ago.high, minimum(before(own.verified_ago) + 1, own.verified_ago.high))
    yield for_all_inputs(
        "the age of a verification is counted",
        follows.implies(own.verified_ago.eq(ite(_verified_now(own), 0, older))),
        statement="a verification is as old as the cycles since the last one in which count or length was determined and matched",
    )


def _latch(model: Verification) -> Iterator[Property]:
    """Claim that a mismatch is latched."""
    machine, own = model.machine, model.own
    _, _, _, untrusted = machine.modes
    mode = machine.mode
    was_untrusted = before(mode).eq(untrusted)
    yield for_all_inputs(
        "mismatch is latched",
        (was_untrusted & mode.ne(untrusted)).implies(
            own.leaves | (own.due & own.sound & own.reference_from.ne(v.NOBODY) & (own.record_axles > 0))
        ),
        statement="an untrusted train changes its state only by an accepted reference, or by leaving",
    )
    yield for_all_inputs(
        "the first reason stays stored",
        (was_untrusted & mode.eq(untrusted)).implies(own.why.eq(before(own.why))),
        statement="the first reason stays until the train is trusted again or gone",
        requirements=COURSE,
    )


def _withheld(model: Verification) -> Iterator[Property]:
    """Claim that an untrusted position is not reported, and has a reason."""
    machine, own = model.machine, model.own
    none, withheld, _, untrusted = machine.modes
    mode, trusted = machine.mode, machine.flag("trusted")
    yield for_all_inputs(
        "withheld is nothing",
        (~trusted).implies(no_interval(machine) & ~machine.flag("handover_trusted")),
        statement="a position that is not trusted is not reported, and not handed over as trusted",
        requirements=CLAIM,
    )
    yield for_all_inputs(
        "a reason is reported",
        mode.one_of(none, withheld, untrusted).implies(own.why.ne(v.VERIFIED)),
        statement="every train that is not trusted has a reason",
        requirements=COURSE,
    )


def _revoked(model: Verification) -> Iterator[Property]:
    """Claim that a mismatch revokes a reported position."""
    machine = model.machine
    _, _, trusted_mode, untrusted = machine.modes
    mode = machine.mode
    yield for_all_inputs(
        "a reported position is revoked",
        (before(mode).eq(trusted_mode) & mode.eq(untrusted)).implies(machine.flag("revoked")),
        statement="a mismatch revokes, in the same cycle, the position that was reported before",
        requirements=(*CLAIM, *COURSE),
    )


def _given_out(model: Verification) -> Iterator[Property]:
    """Claim that the machine remembers a reported position through a pause."""
    machine, own = model.machine, model.own
    _, withheld, trusted_mode, untrusted = machine.modes
    mode, trusted = machine.mode, machine.flag("trusted")
    was_untrusted, believed = before(mode).eq(untrusted), mode.one_of(withheld, trusted_mode)
    given_out = since(believed & ~own.due, trusted)
    yield for_all_inputs(
        "the machine stores that a position was reported",
        believed.implies(own.given_out.iff(given_out))
        & (was_untrusted & mode.eq(untrusted)).implies(own.given_out.iff(was(own.given_out))),
        statement="while the train is withheld, the machine remembers that a position was reported, from the last trusted "
        "cycle on, until another reference comes; and once the train is untrusted, until that ends",
        requirements=(*CLAIM, *COURSE),
    )
    yield for_all_inputs(
        "a reported position is revoked after a pause too",
        (before(mode).eq(withheld) & mode.eq(untrusted)).implies(machine.flag("revoked").iff(was(own.given_out))),
        statement="a mismatch of a train that is withheld for the time being revokes the position that was reported "
        "before, if there was one",
        requirements=(*CLAIM, *COURSE),
    )


def _inputs(model: Verification) -> Iterator[Property]:
    trusted = model.machine.flag("trusted")
    for name, (fault, what, trace) in _unusable(model.own).items():
        yield for_all_inputs(
            f"{name} withholds",
            fault.implies(~trusted),
            statement=f"{what} withholds the position in the same cycle",
            requirements=trace,
        )


def _unusable(own: Parts) -> dict[str, tuple[Bool, str, tuple[str, ...]]]:
    """Return the missing or faulty inputs of a cycle, in words."""
    unusable: dict[str, tuple[Bool, str, tuple[str, ...]]] = {
        "not associated": (~own.associated, "a pattern that belongs to no known train", CLAIM),
        "not located": (~own.located | ~own.fibre_position.present, "a missing interval", CLAIM),
        "fibre error": (own.fibre_error, "an error signal F of the fibre machine", CLAIM),
    }
    if own.config.needs_emitter:
        unusable["chain failed"] = (own.chain_failed | ~own.chain_tested, "a chain that is not tested", EMITTER)
    if own.config.needs_control_data:
        silent = ~own.control_axles.present & ~own.control_length.present
        unusable["control data missing"] = (silent, "train control data that do not come", CONTROL)
    return unusable


def _control(model: Verification) -> Iterator[Property]:
    """Claim the conditions under which train control data count as verified."""
    machine, own = model.machine, model.own
    silent = ~own.control_axles.present & ~own.control_length.present
    yield for_all_inputs(
        "silence is no success",
        (silent & own.by_control_data).implies(was(own.by_control_data)),
        statement="train control data count as verified only if they came and matched",
        requirements=CONTROL,
    )
    came, new_control = (
        own.control_axles.present | own.control_length.present,
        own.by_control_data & ~was(own.by_control_data),
    )
    agrees = own.control_axles.present.implies(own.control_axles.value.eq(own.stored_axles))
    believed = machine.mode.one_of(*machine.modes[1:3])
    yield for_all_inputs(
        "train control is listed where it agreed",
        new_control.implies(agrees & came) & (believed & came).implies(own.by_control_data),
        statement="train control data are listed as verified from the first cycle on in which they came and agreed",
        requirements=CONTROL,
    )


def _record(model: Verification) -> Iterator[Property]:
    """Claim the conditions of an accepted record."""
    machine, own = model.machine, model.own
    mode = machine.mode
    kept = (own.stored_axles, own.stored_length_low, own.stored_length_high)
    record = (own.record_axles, own.record_length_low, own.record_length_high)
    known = machine.flag("trusted") | mode.eq(machine.modes[1])
    same = all_of(one.eq(before(one)) for one in kept)
    new = all_of(one.eq(told) for one, told in zip(kept, record, strict=True))
    yield for_all_inputs(
        "each reference is stored once",
        known.implies(same | (own.due & new)),
        statement="the stored reference changes only in the cycle of another accepted record",
        requirements=(*STAY, *ENTRY),
    )
    recent = own.record_age <= own.config.reference_age_limit_cycles
    yield for_all_inputs(
        "only sound references",
        (own.due & known).implies(own.sound & recent & own.reference_from.ne(v.NOBODY) & (own.record_axles > 0)),
        statement="a record that is disturbed, old, empty or did not come is not accepted",
        requirements=(*COUNTED, *STAY),
    )
    yield for_all_inputs(
        "a record whose bounds are crossed is not accepted",
        (own.due & known).implies(all_of(high >= low for low, high in record_bounds(own))),
        statement="a record whose length, place or speed has a lower bound above its upper bound is not accepted: its place would "
        "leave less open than nothing, and be trusted for too long",
        requirements=(*COUNTED, *STAY),
    )


def _missing(model: Verification) -> Iterator[Property]:
    """Claim that a train without a reference is not verified."""
    machine, own = model.machine, model.own
    none, *_ = machine.modes
    mode = machine.mode
    yield for_all_inputs(
        "a lost hand-over is untrusted",
        (own.due & own.reference_from.eq(v.NOBODY) & ~own.leaves).implies(mode.eq(machine.modes[3])),
        statement="a train for which no reference came when it was due is untrusted in the same cycle",
        requirements=("FVA-D1", *STAY),
    )
    yield for_all_inputs(
        "no train without a reference",
        (before(mode).eq(none) & mode.ne(none)).implies(own.due),
        statement="without a reference nothing is ever verified",
        requirements=CLAIM,
    )


def _at_entry(model: Verification) -> Iterator[Property]:
    """Claim that place and speed are compared in the cycle of the record only."""
    own = model.own
    at_entry = own.why.one_of(v.SPEED_AT_ENTRY, v.PLACE_AT_ENTRY)
    yield for_all_inputs(
        "place and speed at entry only",
        (at_entry & own.why.ne(before(own.why))).implies(own.due & own.reference_from.eq(v.AXLE_COUNTER)),
        statement="place and speed are compared with the record only in its own cycle, and never later",
        requirements=ENTRY,
    )
    newly = (own.by_speed_at_entry & ~was(own.by_speed_at_entry)) | (
        own.by_place_at_entry & ~was(own.by_place_at_entry)
    )
    yield for_all_inputs(
        "verified at entry in that cycle",
        newly.implies(own.due & own.associated),
        statement="place and speed are listed as verified only from a cycle in which they were compared at the counter",
        requirements=ENTRY,
    )


def _verified_now(own: Parts) -> Bool:
    """Return the condition that count or length was determined of the train's own pattern, and is the record's."""
    tolerance, length = own.config.length_tolerance_mm, own.fibre_length
    count = own.fibre_axles.present & own.fibre_axles.value.eq(own.stored_axles)
    near = (length.value + tolerance >= own.stored_length_low) & (length.value - tolerance <= own.stored_length_high)
    return own.associated & (count | (length.present & near))


def _handed_over(model: Verification) -> Iterator[Property]:
    """Claim the data that are handed over to the neighbour."""
    machine, own = model.machine, model.own
    length = machine.output("handover_length_low_mm"), machine.output("handover_length_high_mm")
    handed_over = (
        machine.output("handover_axles").eq(own.stored_axles)
        & length[0].eq(own.stored_length_low)
        & length[1].eq(own.stored_length_high)
    )
    yield for_all_inputs(
        "the record is handed over",
        machine.flag("handover_trusted").implies(machine.flag("trusted") & handed_over),
        statement="the record that is handed over as trusted is the stored one, while the train is trusted",
        requirements=("FVA-D1", *STAY),
    )
    yield for_all_inputs(
        "listed with the emitter",
        machine.flag("verified_by_emitter").implies(machine.flag("trusted") & own.chain_tested),
        statement="the chain is listed as tested only in a cycle in which it is tested",
        requirements=EMITTER,
    )


def _reached(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield reachable("trusted", machine.flag("trusted"), statement="a train can be trusted", requirements=CLAIM)
    both = any_of([own.by_speed_at_entry & own.by_place_at_entry & own.by_count & own.by_length])
    yield reachable(
        "all verified", machine.flag("trusted") & both, statement="all parameters can be verified", requirements=ENTRY
    )
