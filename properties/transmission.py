"""What must hold of a position on its way between computers (FVA-9, FVA-18, RFL-14): its age is charged, and limited."""

from __future__ import annotations

from functools import partial

from safeloc.language.expr import before, between, exact_to, with_unit
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import MM, NM
from safeloc.models.transmission import Transmission

LAW = "a position that is sent holds the truth when it is sent; the vehicle moves no faster than its highest speed"
REQUIREMENTS = ("FVA-9", "FVA-18", "RFL-14")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(model: Transmission) -> list[Property]:
    """Containment, age, revocation and widening."""
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    position, below, above = (machine.output(f"{name}_mm") for name in ("position", "margin_below", "margin_above"))
    landed = machine.fired("report arrives")
    kept = valid & earlier_bool(valid) & ~landed
    return [
        always(
            "containment",
            valid.implies(between(exact_to(position - below, NM), own.truth, exact_to(position + above, NM))),
            statement="what has arrived holds the true position now, however long it was on its way",
            requirements=REQUIREMENTS,
            assumption=LAW,
        ),
        for_all_inputs(
            "tolerance",
            valid.implies((below <= own.config.margin_limit_mm) & (above <= own.config.margin_limit_mm)),
            statement="what is given out is never wider than the limit",
        ),
        for_all_inputs(
            "age",
            machine.output("age_ms") <= own.config.age_limit_ms,
            statement="nothing older than the limit is given out: a link that falls silent withdraws the position in time",
        ),
        for_all_inputs(
            "age is charged",
            kept.implies(
                (below - before(own.held.below) >= with_unit(before(own.held.age) * own.config.run_mm, MM))
                & own.held.age.eq(before(own.held.age) + 1)
            ),
            statement="while no report arrives the one that is held grows older and wider in every cycle",
        ),
        for_all_inputs(
            "no resurrection",
            (valid & ~earlier_bool(valid)).implies(landed),
            statement="a position is given out again only when a report arrives",
        ),
        for_all_inputs(
            "revocation",
            machine.fired("report revokes").implies(~valid),
            statement="a report that revokes takes the position away in the step in which it arrives",
        ),
    ]
