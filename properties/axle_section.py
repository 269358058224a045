"""Properties of a section between axle counters (FVA-4, FVA-5; as a device FVA-13, FVA-14).

Every property is written from the axles reported in a cycle, from the axles really in the section, and from the state that
the requirement names: mode, count, lead time, and the ways of a sweep since the reset.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, BoolVar, Num, NumVar, all_of, any_of, before, ite, minimum, was
from safeloc.language.spec import Property, reachable
from safeloc.models.axle_section import AxleSection
from safeloc.models.axle_section.variables import (
    ACCEPTED,
    AXLE_PASSED,
    AXLES_COUNTED,
    HEAD_DAMPED,
    HEAD_FAULT,
    NOT_ASKED,
    RAN_THROUGH,
    Parts,
)
from safeloc.properties.claims import Claims

REQUIREMENTS = ("FVA-4", "FVA-5", "FVA-13", "FVA-14")
LAW = (
    "heads without a fault count truly; the driver who reports a sweep ran it on sight after the reset was "
    "requested, has left, and met nothing where he ran through"
)


def properties(model: AxleSection) -> list[Property]:
    """Return the properties: clear is clear; a reset never clears; a fault is occupied in the same step."""
    return [
        *_healthy(model),
        *_truth(model),
        *_resets(model),
        *_refused(model),
        *_lead_time(model),
        *_answers(model),
        *_occupied(model),
        *_disturbed(model),
        *_no_count(model),
        *_from_power_up(model),
        *_sweeps(model),
        *_frees(model),
    ]


_CLAIMS = Claims(REQUIREMENTS, LAW)
_held, _lawful = _CLAIMS.for_all_inputs, _CLAIMS.lawful


# ------------------------------------------------------------------ terms from the inputs


def _passed(own: Parts) -> Bool:
    return any_of(axles.ne(0) for axles in (*own.into, *own.out))


def _came_in(own: Parts) -> Num:
    """Return the count before the cycle plus the axles that came in at both ends."""
    return before(own.counted_axles) + own.into[0] + own.into[1]


def _went_out(own: Parts) -> Num:
    return own.out[0] + own.out[1]


def _ways(own: Parts) -> list[tuple[BoolVar, NumVar]]:
    """Return the state for each way of the sweep, with the axles reported there."""
    return list(zip((*own.swept_from, *own.swept_to), (*own.into, *own.out), strict=True))


def _ran_through(own: Parts) -> Bool:
    """Return the condition that before this cycle axles had come in at one end only, and gone out at the other only."""
    (in_low, in_high), (out_low, out_high) = map(was, own.swept_from), map(was, own.swept_to)
    return (in_low & ~in_high & ~out_low & out_high) | (in_high & ~in_low & ~out_high & out_low)


# ------------------------------------------------------------------ claims


def _healthy(model: AxleSection) -> Iterator[Property]:
    """Claim the states with a healthy count."""
    machine = model.machine
    _, clear, occupied, *_ = machine.modes
    yield _held(
        "a section that counts is healthy",
        machine.flag("healthy").iff(machine.mode.eq(clear) | machine.mode.eq(occupied)),
        "the count is reported as healthy while the section is clear or occupied, and at no other time",
    )


def _truth(model: AxleSection) -> Iterator[Property]:
    """Claim clear, count and reset against the axles that are really in the section."""
    machine, own = model.machine, model.own
    _, clear, occupied, *_ = machine.modes
    is_clear, before_ = machine.flag("clear"), before(machine.mode)
    accepted = own.answer.eq(ACCEPTED)
    yield _lawful("clear is clear", is_clear.implies(own.axles.eq(0)), "a section reported clear has no axle in it")
    yield _lawful(
        "a healthy count is the truth",
        machine.flag("healthy").implies(machine.output("axles").eq(own.axles)),
        "while the count is healthy, the reported number of axles is the true one",
    )
    yield _lawful(
        "cleared only by a sweep that met nothing",
        (is_clear & ~before_.one_of(clear, occupied)).implies(
            before(own.sweep).eq(RAN_THROUGH) & before(own.true_axles_before_sweep).eq(0)
        ),
        "after unknown, disturbed or reset, a section becomes clear only if a sweep really ran from one end to the "
        "other, and no axle stood in the section when it came in",
    )
    yield _lawful(
        "refused while a train is in",
        (accepted & before_.one_of(clear, occupied)).implies(before(own.axles).eq(0)),
        "while the count is believed, a reset is accepted only if no axle really is in the section",
    )


def _resets(model: AxleSection) -> Iterator[Property]:
    """Claim that a reset never clears."""
    machine, own = model.machine, model.own
    _, clear, occupied, disturbed, sweeping = machine.modes
    mode, is_clear, before_ = machine.mode, machine.flag("clear"), before(machine.mode)
    accepted = own.answer.eq(ACCEPTED)
    yield _held(
        "a reset never frees",
        own.reset_requested.implies(~is_clear | before_.eq(clear) | ~accepted),
        "in a cycle with an accepted reset an occupied section does not become clear",
    )
    yield _held(
        "a reset leads to a sweep",
        accepted.implies(mode.one_of(sweeping, disturbed)),
        "an accepted reset is followed by a sweep, never by clear",
    )
    yield _held(
        "clear after a reset needs a sweep",
        (is_clear & ~before_.one_of(clear, occupied)).implies(
            before_.eq(sweeping) & _ran_through(own) & ~_passed(own) & own.reported_clear
        ),
        "unknown, disturbed or reset, a section becomes clear only when a sweep ran through, was counted in and "
        "out, and its driver reported the section free",
    )


def _refused(model: AxleSection) -> Iterator[Property]:
    """Claim the reasons to refuse a reset."""
    machine, own = model.machine, model.own
    unknown, clear, _, disturbed, _ = machine.modes
    before_ = before(machine.mode)
    accepted = own.answer.eq(ACCEPTED)
    yield _held(
        "refused while occupied",
        (accepted & ~before_.one_of(unknown, clear, disturbed)).implies(before(own.counted_axles).eq(0)),
        "a reset is refused while axles are counted in",
    )
    yield _held(
        "refused at a damped or faulty head",
        accepted.implies(~own.damped & ~own.fault & ~_passed(own)),
        "a reset is refused while a head is damped or at fault, and in a cycle with an axle",
    )
    yield _held(
        "refused within the lead time",
        accepted.implies(before(own.quiet) >= own.config.lead_cycles),
        "a reset is refused until no axle passed for the lead time",
    )


def _lead_time(model: AxleSection) -> Iterator[Property]:
    own = model.own
    longer = minimum(before(own.quiet) + 1, own.config.lead_cycles)
    yield _held(
        "the lead time is counted",
        _always_in_a_step(model, own.quiet.eq(ite(_passed(own), 0, longer))),
        "the lead time begins anew with every axle, at whichever end and in whichever direction, and grows by one cycle in "
        "every other cycle",
    )


def _answers(model: AxleSection) -> Iterator[Property]:
    """Claim that each answer comes exactly in its case."""
    machine, own = model.machine, model.own
    unknown, clear, _, disturbed, _ = machine.modes
    counted = ~before(machine.mode).one_of(unknown, clear, disturbed) & before(own.counted_axles).ne(0)
    early = _passed(own) | (before(own.quiet) < own.config.lead_cycles)
    cases = {
        HEAD_FAULT: own.fault,
        HEAD_DAMPED: ~own.fault & own.damped,
        AXLES_COUNTED: ~own.fault & ~own.damped & counted,
        AXLE_PASSED: ~own.fault & ~own.damped & ~counted & early,
        ACCEPTED: ~own.fault & ~own.damped & ~counted & ~early,
    }
    right = [own.answer.eq(answer).iff(own.reset_requested & case) for answer, case in cases.items()]
    yield _held(
        "a request for reset is answered",
        _always_in_a_step(model, all_of([*right, own.answer.eq(NOT_ASKED).iff(~own.reset_requested)])),
        "a request is answered with the first reason against it, and accepted if there is none",
    )


def _always_in_a_step(model: AxleSection, term: Bool) -> Bool:
    """Return the term for every step; the first state is not concerned."""
    return (model.machine.stayed() | ~model.machine.stayed()).implies(term)


def _occupied(model: AxleSection) -> Iterator[Property]:
    """Claim the inputs that keep the section from being clear at once."""
    machine, own = model.machine, model.own
    is_clear = machine.flag("clear")
    yield _held(
        "a fault is occupied",
        own.fault.implies(~is_clear),
        "in a cycle with a fault of a head the section is not clear",
    )
    yield _held(
        "a damped head is occupied",
        own.damped.implies(~is_clear),
        "while a wheel stands on a counting head the section is not clear, whatever is counted",
    )


def _disturbed(model: AxleSection) -> Iterator[Property]:
    """Claim the events that disturb the count; only a reset ends that."""
    machine, own = model.machine, model.own
    _, clear, occupied, disturbed, sweeping = machine.modes
    mode, before_ = machine.mode, before(machine.mode)
    impossible = (_came_in(own) < _went_out(own)) | (_came_in(own) > _went_out(own) + own.config.axle_limit)
    believed = before_.one_of(clear, occupied, sweeping)
    yield _held(
        "an impossible count is disturbed",
        (believed & impossible).implies(mode.eq(disturbed)),
        "more axles out than in, or more in than there can be: disturbed in the same cycle",
    )
    yield _held(
        "only a fault or an impossible count disturbs",
        (before_.ne(disturbed) & mode.eq(disturbed)).implies(believed & (own.fault | impossible)),
        "without a fault of a head and with a possible count the section is not disturbed",
    )
    yield _held(
        "a fault is not forgotten",
        before_.eq(disturbed).implies(mode.one_of(disturbed, sweeping)),
        "a disturbed section stays so, also when the fault is gone, until it is reset",
    )


def _no_count(model: AxleSection) -> Iterator[Property]:
    """Claim that a count that cannot be believed is not reported."""
    machine = model.machine
    unknown, _, _, disturbed, _ = machine.modes
    yield _held(
        "no axles are reported without a count",
        machine.mode.one_of(unknown, disturbed).implies(machine.output("axles").eq(0)),
        "after power-up and while it is disturbed, the section reports no number of axles",
    )


def _from_power_up(model: AxleSection) -> Iterator[Property]:
    machine = model.machine
    unknown, _, _, disturbed, sweeping = machine.modes
    mode, before_ = machine.mode, before(machine.mode)
    yield _held(
        "power-up is occupied",
        before_.eq(unknown).implies(mode.one_of(unknown, sweeping)),
        "after power-up the section is not clear until reset and swept",
    )
    yield _held(
        "a needed reset is requested",
        machine.flag("needs_reset").iff(mode.one_of(unknown, disturbed)),
        "the section reports that it needs a reset after power-up and while it is disturbed, and at no other time",
    )


def _sweeps(model: AxleSection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, clear, _, disturbed, sweeping = machine.modes
    mode, before_, accepted = machine.mode, before(machine.mode), own.answer.eq(ACCEPTED)
    goes_on = mode.eq(sweeping) & before_.eq(sweeping) & ~accepted
    kept = all_of(latch.iff(was(latch) | axles.ne(0)) for latch, axles in _ways(own))
    yield _held(
        "axles of a sweep stay counted at each end",
        goes_on.implies(kept & _came_in(own).eq(_went_out(own) + own.counted_axles)),
        "the axles of the sweep since the reset, at each end and in each direction, are counted and not forgotten on the way",
    )
    yield _held(
        "a sweep ends clear or disturbed",
        before_.eq(sweeping).implies(mode.one_of(sweeping, clear, disturbed)),
        "a sweep goes on until the section is clear, or disturbed anew",
    )
    yield _held(
        "a sweep begins with the reset",
        (mode.eq(sweeping) & accepted).implies(own.counted_axles.eq(0) & ~any_of(latch for latch, _ in _ways(own))),
        "axles before the reset are no part of the sweep",
    )


def _frees(model: AxleSection) -> Iterator[Property]:
    """Claim the events with which the section must become clear."""
    machine, own = model.machine, model.own
    _, clear, occupied, _, sweeping = machine.modes
    mode, is_clear, before_ = machine.mode, machine.flag("clear"), before(machine.mode)
    calm = ~own.fault & ~own.damped & own.answer.ne(ACCEPTED) & _came_in(own).eq(_went_out(own))
    yield _held(
        "axles counted out clear",
        (before_.one_of(clear, occupied) & calm).implies(is_clear),
        "when every axle that was counted in is counted out, the section is clear in the same cycle",
    )
    swept = _ran_through(own) & own.reported_clear & ~_passed(own)
    yield _held(
        "a sweep through clears",
        (before_.eq(sweeping) & swept & calm).implies(mode.eq(clear)),
        "a sweep that ran through and was counted in and out clears the section when its driver reports it free",
    )
    yield reachable("clear", is_clear, statement="a section can become clear", requirements=REQUIREMENTS)
