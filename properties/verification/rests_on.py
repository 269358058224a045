"""Claims on the comparisons that a followed train's trust is told to rest on, and on forgetting a train that is gone or untrusted (FVA-1 to FVA-8)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, before, between, was
from safeloc.language.spec import Property, always
from safeloc.models.verification import Verification
from safeloc.models.verification import variables as v
from safeloc.models.verification.variables import Parts
from safeloc.properties.verification.requirements import CLAIM, CONTROL, COURSE, EMITTER, ENTRY, STAY

for_all_inputs = partial(always, requirements=(*CLAIM, *STAY), unconditional=True)


def properties(model: Verification) -> Iterator[Property]:
    """Return the claims on the comparisons that are reported, in both directions, and on what is forgotten."""
    yield from _last_verification(model)
    yield from _comparisons(model)
    yield from _reason(model)
    yield from _given(model)
    yield from _stored(model)
    yield from _forgotten(model)


def _followed(model: Verification) -> Bool:
    """Return the condition that the train has a reference and no mismatch after the step; a record that was due is accepted then."""
    _, withheld, trusted, _ = model.machine.modes
    return model.machine.mode.one_of(withheld, trusted)


def _counted(own: Parts) -> Bool:
    return own.associated & own.fibre_axles.present & own.fibre_axles.value.eq(own.stored_axles)


def _measured(own: Parts) -> Bool:
    length, tolerance = own.fibre_length.value, own.config.length_tolerance_mm
    near = between(own.stored_length_low, length + tolerance, own.stored_length_high + 2 * tolerance)
    return own.associated & own.fibre_length.present & near


def _last_verification(model: Verification) -> Iterator[Property]:
    """Claim that count and length are reported as compared in the last cycle in which either was."""
    machine, own = model.machine, model.own
    anew = own.due | _counted(own) | _measured(own)
    for output, now, earlier in (
        ("verified_count", _counted(own), own.by_count),
        ("verified_length", _measured(own), own.by_length),
    ):
        expected = (anew & now) | (~anew & was(earlier))
        yield for_all_inputs(
            f"{output} is of the last verification",
            _followed(model).implies(machine.flag(output).iff(expected)),
            statement=f"{output} is reported exactly if it matched in the last cycle in which count or length matched, or a record came",
        )


def _comparisons(model: Verification) -> Iterator[Property]:
    """Claim that the other comparisons are reported exactly if they were made."""
    machine, own = model.machine, model.own
    elsewhere = ~own.due | own.reference_from.ne(v.AXLE_COUNTER) | ~own.associated
    for output, unread, earlier in (
        ("verified_speed_at_entry", ~own.fibre_speed.present, own.by_speed_at_entry),
        ("verified_place_at_entry", ~own.located | ~own.fibre_position.present, own.by_place_at_entry),
    ):
        yield for_all_inputs(
            f"{output} is reported if it was compared",
            _followed(model).implies(machine.flag(output).iff(~(elsewhere | unread) | (~own.due & was(earlier)))),
            statement=f"{output} is reported exactly if the record came from a counter and the fibre read the train there",
            requirements=ENTRY,
        )
    heard = own.control_axles.present | own.control_length.present
    yield for_all_inputs(
        "train control is reported if it agreed",
        _followed(model).implies(
            machine.flag("verified_train_control").iff(heard | (~own.due & was(own.by_control_data)))
        ),
        statement="train control counts as heard exactly if it has told count or length since the last record, without contradiction",
        requirements=CONTROL,
    )
    yield for_all_inputs(
        "the emitter is reported if it was tested",
        machine.flag("verified_by_emitter").iff(machine.flag("trusted") & own.chain_tested),
        statement="a trusted position is reported as tested by the emitter exactly while the fibre chain is tested",
        requirements=EMITTER,
    )


def _reason(model: Verification) -> Iterator[Property]:
    """Claim that a trusted train is reported as verified."""
    machine = model.machine
    yield for_all_inputs(
        "a trusted train is verified",
        machine.flag("trusted").implies(machine.output("reason").eq(v.VERIFIED)),
        statement="the reason of a trusted train is that it is verified",
        requirements=COURSE,
    )
    own, (_, withheld, _, untrusted) = model.own, machine.modes
    placed, reason = own.located & own.fibre_position.present, machine.output("reason")
    yield for_all_inputs(
        "a withheld train has the first reason",
        machine.mode.eq(withheld).implies(
            reason.eq(v.NOT_ASSOCIATED).iff(~own.associated)
            & reason.eq(v.NOT_LOCATED).iff(own.associated & ~placed)
            & reason.ne(v.VERIFIED)
        ),
        statement="a train is withheld as not associated exactly if no pattern is its own, and as not located exactly if its pattern has no place",
        requirements=COURSE,
    )
    yield for_all_inputs(
        "untrusted is reported while a mismatch is latched",
        machine.flag("untrusted").iff(machine.mode.eq(untrusted))
        & machine.flag("revoked").implies(machine.flag("untrusted")),
        statement="a train is reported as untrusted in the state in which a mismatch is latched, and in no other; only then a position is revoked",
        requirements=COURSE,
    )


def _given(model: Verification) -> Iterator[Property]:
    """Claim that a train is trusted whenever nothing is missing and its verification is recent enough."""
    machine, own, config = model.machine, model.own, model.own.config
    _, _, trusted, _ = machine.modes
    told = own.possible_high - own.possible_low <= config.place_doubt_limit_mm
    complete = [own.associated & own.located & own.fibre_position.present & told]
    complete += [own.control_axles.present | own.control_length.present] if config.needs_control_data else []
    complete += [own.chain_tested] if config.needs_emitter else []
    recent = before(machine.mode).eq(trusted) & ~own.due & (own.verified_ago <= config.currency_cycles)
    yield for_all_inputs(
        "a verified train is trusted",
        (_followed(model) & all_of(complete) & (_counted(own) | _measured(own) | recent)).implies(
            machine.flag("trusted")
        ),
        statement="a train of which nothing is missing is trusted in each cycle in which count or length matches, and for currency_cycles after it",
    )


def _stored(model: Verification) -> Iterator[Property]:
    """Claim that the last reading of each kind stays stored, with the margins of the last place."""
    own, position = model.own, model.own.fibre_position
    placed = ~(~own.associated | ~own.located | ~position.present)
    readings = (
        (placed, own.front, position.value),
        (placed, own.last_place, position.value),
        (placed, own.front_margin_above, own.fibre_margin_above),
        (placed, own.front_margin_below, own.fibre_margin_below),
        (own.associated & own.fibre_length.present, own.last_length, own.fibre_length.value),
        (own.associated & own.fibre_speed.present, own.last_speed, own.fibre_speed.value),
    )
    stays = all_of(
        read.implies(stored.eq(reading)) & (read | stored.eq(before(stored))) for read, stored, reading in readings
    )
    yield for_all_inputs(
        "the last reading of each kind is stored",
        _followed(model).implies(stays),
        statement="what the fibre read of a followed train's own pattern is stored until it reads the same again: place with margins, length, speed",
        requirements=COURSE,
    )


def _forgotten(model: Verification) -> Iterator[Property]:
    """Claim that no data of a train serve the next one."""
    machine, own = model.machine, model.own
    none, _, _, untrusted = machine.modes
    numbers = all_of(number.eq(0) for number in (*own.numbers, own.verified_ago))
    yield for_all_inputs(
        "nothing is kept of a train that is gone or untrusted",
        machine.mode.one_of(none, untrusted).implies(numbers & all_of(~flag for flag in (*own.flags, *own.known))),
        statement="once a train has left, or a parameter did not match, all its stored data are cleared, so that none serves the next train",
    )
    yield for_all_inputs(
        "without a train there is no record and nothing to revoke",
        machine.mode.eq(none).implies(machine.output("reason").eq(v.NO_RECORD) & ~own.given_out),
        statement="while there is no train, the reason is that there is no record, and no position counts as given out: the next train "
        "begins with nothing to revoke",
    )
