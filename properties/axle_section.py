"""What must hold of a section between axle counters (FVA-4, FVA-5)."""

from __future__ import annotations

from safeloc.language.expr import Bool, before, was
from safeloc.language.spec import Property, always, reachable
from safeloc.models.axle_section import ACCEPTED, AxleSection

TRACE = ("FVA-4", "FVA-5")
LAW = "heads without a fault count truly; a sweep through that is counted in and out and reports the section free leaves nothing"


def properties(model: AxleSection) -> list[Property]:
    """Clear is clear; a reset never frees; a fault is occupied in the same step."""
    machine, own = model.machine, model.own
    unknown, clear, occupied, disturbed, sweeping = machine.modes
    mode, is_clear = machine.mode, machine.flag("clear")
    before_ = before(mode)
    accepted = own.answer.eq(ACCEPTED)
    return [
        always(
            "clear is clear",
            is_clear.implies(own.axles.eq(0)),
            statement="a section reported clear has no axle in it",
            requirements=TRACE,
            assumption=LAW,
        ),
        always(
            "a reset never frees",
            own.reset.implies(~is_clear | before_.eq(clear) | ~accepted),
            statement="in a cycle with an accepted reset an occupied section does not become clear",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a reset leads to a sweep",
            accepted.implies(mode.one_of(sweeping, disturbed)),
            statement="an accepted reset is followed by a sweep, never by clear",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "clear after a reset needs a sweep",
            (is_clear & ~before_.one_of(clear, occupied)).implies(
                machine.fired("swept") & _ran_through(model) & own.reported_clear
            ),
            statement="unknown, disturbed or reset, a section becomes clear only when a sweep ran through, was counted in and "
            "out and reported it free",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "refused while occupied",
            (accepted & before_.one_of(occupied, sweeping)).implies(before(own.count).eq(0)),
            statement="a reset is refused while axles are counted in",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "refused at a damped or faulty head",
            accepted.implies(~own.damped & ~own.fault & ~own.moved),
            statement="a reset is refused while a head is damped or at fault, and in a cycle with an axle",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "refused within the lead time",
            accepted.implies(before(own.quiet) >= own.config.lead_cycles),
            statement="a reset is refused until no axle passed for the lead time",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a fault is occupied",
            own.fault.implies(~is_clear),
            statement="in a cycle with a fault of a head the section is not clear",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a damped head is occupied",
            own.damped.implies(~is_clear),
            statement="while a wheel stands on a counting head the section is not clear, whatever is counted",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "an impossible count is disturbed",
            (before_.one_of(clear, occupied, sweeping) & (before(own.count) + own.change < 0)).implies(
                mode.eq(disturbed)
            ),
            statement="more axles out than in: disturbed in the same cycle",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a fault is not forgotten",
            before_.eq(disturbed).implies(mode.one_of(disturbed, sweeping)),
            statement="a disturbed section stays so, also when the fault is gone, until it is reset",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "power-up is occupied",
            before_.eq(unknown).implies(mode.one_of(unknown, sweeping)),
            statement="after power-up the section is not clear until reset and swept",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "sweep ways are kept",
            (mode.eq(sweeping) & ~accepted & before_.eq(sweeping) & was(own.swept_from[0])).implies(own.swept_from[0]),
            statement="what the sweep did since the reset is not forgotten on the way",
            requirements=TRACE,
            unconditional=True,
        ),
        reachable("clear", is_clear, statement="a section can become clear", requirements=TRACE),
    ]


def _ran_through(model: AxleSection) -> Bool:
    """Since the reset axles came in at one end only, and went out at the other only."""
    (in_low, in_high), (out_low, out_high) = map(was, model.own.swept_from), map(was, model.own.swept_to)
    return (in_low & ~in_high & ~out_low & out_high) | (in_high & ~in_low & ~out_high & out_low)
