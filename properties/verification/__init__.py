"""What must hold of a verified fibre position (FVA-1 to FVA-8, FVA-D1)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import all_of, any_of, before, between, exact_to, was
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import NM, UM
from safeloc.models.verification import Verification
from safeloc.models.verification import variables as v
from safeloc.properties.in_step import in_step
from safeloc.properties.verification.mismatch import properties as mismatch_properties

LAW = "what the fibre tells of a train is true of that train within its bounds; a located interval holds the front"
CLAIM = ("FVA-1", "FVA-10")
STAY = ("FVA-2", "FVA-11")
ENTRY = ("FVA-3", "FVA-12")
SAFE = ("FVA-4", "FVA-13", "FVA-5", "FVA-14")
COURSE = ("FVA-6", "FVA-15")
CONTROL = ("FVA-7", "FVA-16")
EMITTER = ("FVA-8", "FVA-17")


def properties(model: Verification) -> list[Property]:
    """Only what is verified is given out; a mismatch withholds at once and until another accepted reference."""
    return [
        *_truth(model),
        *_latch(model),
        *_inputs(model),
        *_entry(model),
        *mismatch_properties(model),
        *_course(model),
        *_reached(model),
    ]


def _truth(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    trusted = machine.flag("trusted")
    low, high = own.front - own.front_under, own.front + own.front_over
    tolerance = own.config.length_tolerance_mm * 2_000
    yield always(
        "containment",
        trusted.implies(between(exact_to(low, NM), own.truth, exact_to(high, NM))),
        statement="a position that is given out as trusted holds the front of the train",
        requirements=CLAIM,
        assumption=LAW,
    )
    now = machine.fired("verified", "reference accepted and verified")
    yield always(
        "verified count is the train's",
        (now & own.by_count).implies(own.axles.eq(own.kept_count)),
        statement="in a cycle verified by count, the train followed has as many axles as the counter counted: identity",
        requirements=(*CLAIM, "FVA-D1"),
        assumption=LAW,
    )
    yield always(
        "verified length is the train's",
        (now & own.by_length).implies(
            between(exact_to(own.kept_low, UM) - tolerance, own.length, exact_to(own.kept_high, UM) + tolerance)
        ),
        statement="in a cycle verified by length, the train's length agrees with the counter's within both tolerances",
        requirements=(*CLAIM, "FVA-D1"),
        assumption=LAW,
    )
    counted = own.associated & own.seen_count.present
    yield always(
        "another train is withheld",
        (counted & own.axles.ne(own.kept_count)).implies(~trusted),
        statement="in a cycle in which the fibre counts a train with another number of axles, nothing is trusted: whether "
        "it is another train or has lost a wagon",
        requirements=(*CLAIM, *STAY),
        assumption=LAW,
    )


def _latch(model: Verification) -> Iterator[Property]:
    machine, own, judged = model.machine, model.own, model.judged
    none, withheld, trusted_mode, untrusted = machine.modes
    mode, trusted = machine.mode, machine.flag("trusted")
    was_untrusted = before(mode).eq(untrusted)
    yield always(
        "trusted is currently verified",
        trusted.implies((own.age <= own.config.currency_cycles) & (own.by_count | own.by_length)),
        statement="nothing is trusted without a verification by count or length at most so many cycles ago",
        requirements=(*CLAIM, *STAY),
        unconditional=True,
    )
    yield always(
        "trust begins with a verification",
        (trusted & before(mode).ne(trusted_mode)).implies(
            own.age.eq(0) & own.associated & (own.seen_count.present | own.seen_length.present)
        ),
        statement="a position is trusted again only in a cycle in which count or length was determined and matched",
        requirements=CLAIM,
        unconditional=True,
    )
    yield always(
        "mismatch withholds in the same cycle",
        (in_step(machine, judged.mismatch) & ~own.leaves).implies(mode.eq(untrusted)),
        statement="whatever does not match, the train is untrusted in the same cycle",
        requirements=(*CLAIM, *COURSE),
        unconditional=True,
    )
    yield always(
        "mismatch is latched",
        (was_untrusted & mode.ne(untrusted)).implies(
            own.leaves | (own.due & own.sound & own.source.ne(v.NOBODY) & (own.record_count > 0))
        ),
        statement="an untrusted train becomes anything else only by an accepted reference, or by leaving",
        requirements=(*CLAIM, *STAY),
        unconditional=True,
    )
    yield always(
        "first reason is kept",
        (was_untrusted & mode.eq(untrusted)).implies(own.reason.eq(before(own.reason))),
        statement="the first reason stays until the train is trusted again or gone",
        requirements=COURSE,
        unconditional=True,
    )
    nothing = all_of(machine.output(f"{name}_mm").eq(0) for name in ("position", "over", "under"))
    yield always(
        "withheld is nothing",
        (~trusted).implies(nothing & ~machine.flag("handover_trusted")),
        statement="a position that is not trusted is not given out, and not handed over as trusted",
        requirements=CLAIM,
        unconditional=True,
    )
    yield always(
        "what was given out is revoked",
        (before(mode).eq(trusted_mode) & mode.eq(untrusted)).implies(machine.flag("revoked")),
        statement="a mismatch revokes in the same cycle what was given out before",
        requirements=(*CLAIM, *COURSE),
        unconditional=True,
    )
    yield always(
        "a reason is told",
        mode.one_of(none, withheld, untrusted).implies(own.reason.ne(v.VERIFIED)),
        statement="whatever is not trusted has a reason",
        requirements=COURSE,
        unconditional=True,
    )


def _inputs(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    trusted = machine.flag("trusted")
    unusable = {
        "not associated": (~own.associated, "a pattern that belongs to no known train", CLAIM),
        "not located": (~own.located | ~own.place.present, "a missing interval", CLAIM),
        "fibre error": (own.fibre_error, "an error signal F of the fibre machine", CLAIM),
    }
    if own.config.needs_emitter:
        unusable["chain failed"] = (own.chain_failed | ~own.chain_tested, "a chain that is not tested", EMITTER)
    if own.config.needs_control_data:
        silent = ~own.control_count.present & ~own.control_length.present
        unusable["control data missing"] = (silent, "train control data that do not come", CONTROL)
    for name, (fault, what, trace) in unusable.items():
        yield always(
            f"{name} withholds",
            fault.implies(~trusted),
            statement=f"{what} withholds the position in the same cycle",
            requirements=trace,
            unconditional=True,
        )
    silent = ~own.control_count.present & ~own.control_length.present
    yield always(
        "silence is no success",
        (silent & own.by_control).implies(was(own.by_control)),
        statement="train control data count as verified only where they came and matched",
        requirements=CONTROL,
        unconditional=True,
    )
    differs = own.control_count.present & own.control_count.value.ne(own.kept_count)
    yield always(
        "control data do not repair",
        differs.implies(~trusted),
        statement="train control data that contradict the reference withhold; they never replace it",
        requirements=CONTROL,
        unconditional=True,
    )


def _entry(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    none, *_ = machine.modes
    mode = machine.mode
    kept = (own.kept_count, own.kept_low, own.kept_high)
    record = (own.record_count, own.record_low, own.record_high)
    known = machine.flag("trusted") | mode.eq(machine.modes[1])
    same = all_of(one.eq(before(one)) for one in kept)
    new = all_of(one.eq(told) for one, told in zip(kept, record, strict=True))
    yield always(
        "reference is taken once",
        known.implies(same | (own.due & new)),
        statement="the stored reference changes only in the cycle of another accepted record",
        requirements=(*STAY, *ENTRY),
        unconditional=True,
    )
    recent = own.record_age <= own.config.reference_age_limit_cycles
    yield always(
        "only sound references",
        (own.due & known).implies(own.sound & recent & own.source.ne(v.NOBODY) & (own.record_count > 0)),
        statement="a record that is disturbed, old, empty or did not come is not accepted",
        requirements=(*SAFE, *STAY),
        unconditional=True,
    )
    yield always(
        "a lost hand-over is untrusted",
        (own.due & own.source.eq(v.NOBODY) & ~own.leaves).implies(mode.eq(machine.modes[3])),
        statement="a train for which no reference came when it was due is untrusted in the same cycle",
        requirements=("FVA-D1", *STAY),
        unconditional=True,
    )
    yield always(
        "no train without a reference",
        (before(mode).eq(none) & mode.ne(none)).implies(own.due),
        statement="without a reference nothing is ever verified",
        requirements=CLAIM,
        unconditional=True,
    )
    at_entry = own.reason.one_of(v.SPEED_AT_ENTRY, v.PLACE_AT_ENTRY)
    yield always(
        "place and speed at entry only",
        (at_entry & own.reason.ne(before(own.reason))).implies(own.due & own.source.eq(v.AXLE_COUNTER)),
        statement="place and speed are compared with the record only in its own cycle, and never later",
        requirements=ENTRY,
        unconditional=True,
    )
    newly = (own.by_speed & ~was(own.by_speed)) | (own.by_place & ~was(own.by_place))
    yield always(
        "verified at entry in that cycle",
        newly.implies(own.due & own.associated),
        statement="place and speed are listed as verified only from a cycle in which they were compared at the counter",
        requirements=ENTRY,
        unconditional=True,
    )


def _course(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    trusted, config = machine.flag("trusted"), own.config
    length = own.seen_length.value - before(own.last_length)
    changed = own.associated & own.seen_length.present & was(own.length_known)
    yield always(
        "a length that changes withholds",
        (changed & ~between(-config.length_change_mm, length, config.length_change_mm)).implies(
            ~trusted | ~was(own.length_known) | machine.fired("train has left")
        ),
        statement="a length that differs from the one before withholds in the same cycle",
        requirements=COURSE,
        unconditional=True,
    )
    ability = max(config.traction_mm_s2, config.brake_mm_s2) * config.period_ms // v.MS_PER_S
    slack = 2 * config.speed_tolerance_mm_s + ability + 1
    change = own.seen_speed.value - before(own.last_speed)
    compared = own.associated & own.seen_speed.present & was(own.speed_known) & before(own.slower).eq(0)
    yield always(
        "a speed that no train changes withholds",
        (compared & before(own.faster).eq(0) & ~between(-slack, change, slack)).implies(~trusted),
        statement="between two cycles the speed changes by no more than traction, brakes and both tolerances allow",
        requirements=COURSE,
        unconditional=True,
    )
    step = config.max_speed_mm_s * config.period_ms // v.MS_PER_S + 1 + config.jump_mm
    run = own.place.value - before(own.last_place)
    above, below = before(own.front_over) + own.place_under, before(own.front_under) + own.place_over
    placed = own.associated & own.located & own.place.present & was(own.place_known) & before(own.reach).eq(0)
    yield always(
        "a jump withholds",
        (placed & ~between(-(below + step), run, above + step)).implies(~trusted),
        statement="between two cycles the front comes no farther than the highest speed and both intervals allow",
        requirements=COURSE,
        unconditional=True,
    )


def _reached(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield reachable("trusted", machine.flag("trusted"), statement="a train can be trusted", requirements=CLAIM)
    both = any_of([own.by_speed & own.by_place & own.by_count & own.by_length])
    yield reachable(
        "all verified", machine.flag("trusted") & both, statement="all parameters can be verified", requirements=ENTRY
    )
