"""What helps to prove the verification of a train."""

from __future__ import annotations

from safeloc.language.expr import Bool, between, exact_to
from safeloc.language.units import NM
from safeloc.models.verification.variables import Parts


def lemmas(own: Parts, trusted: Bool) -> dict[str, Bool]:
    """What is trusted is true, and was verified lately."""
    interval = between(exact_to(own.front - own.front_below, NM), own.truth, exact_to(own.front + own.front_above, NM))
    return {
        "a trusted position holds the truth": trusted.implies(interval),
        "trusted is verified lately": trusted.implies(own.age <= own.config.currency_cycles),
        "trusted rests on count or length": trusted.implies(own.by_count | own.by_length),
        "a count verified now is the train's": (trusted & own.by_count & own.age.eq(0)).implies(
            own.axles.eq(own.kept_count)
        ),
    }
