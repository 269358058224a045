"""The contract of a source that a user added, as claims on its machine by itself (RFL-13)."""

from __future__ import annotations

from functools import partial

from safeloc.language.expr import all_of, between, exact_to
from safeloc.language.spec import Property, always
from safeloc.language.units import NM
from safeloc.models.localizer.own_source import OwnSource
from safeloc.models.vocabulary.reasons import LOCATED

REQUIREMENTS = ("RFL-13",)


def properties(source: OwnSource) -> list[Property]:
    """Return the contract that the localizer relies on; each statement names file and line of the function that made the machine."""
    machine, vehicle = source.machine, source.vehicle
    valid, reason = machine.flag("valid"), machine.output("reason")
    position, below, above = (machine.output(name) for name in ("position_mm", "margin_below_mm", "margin_above_mm"))
    far = vehicle.position_limit_mm
    in_range = [between(-far, position, far), *(between(0, margin, vehicle.widest_mm) for margin in (below, above))]
    holds = between(exact_to(position - below, NM), vehicle.truth, exact_to(position + above, NM))
    free = partial(always, requirements=REQUIREMENTS, unconditional=True)
    clause = f"{source.place}, contract of a source: "
    return [
        always(
            "the interval holds the front end",
            valid.implies(holds),
            statement=f"{clause}while valid, the interval holds the vehicle's front end",
            requirements=REQUIREMENTS,
            assumption="the source's own laws",
        ),
        free(
            "the interval is in range",
            valid.implies(all_of(in_range)),
            statement=f"{clause}while valid, the position is at most {far} mm from 0, and each margin is from 0 to {vehicle.widest_mm} mm",
        ),
        free(
            "a reason is stated",
            reason.eq(LOCATED).iff(valid),
            statement=f"{clause}the reason is NONE exactly while valid",
        ),
        free(
            "a reference comes with an interval",
            machine.flag("reference_accepted").implies(valid),
            statement=f"{clause}a reference is accepted only in a cycle that ends valid",
        ),
    ]
