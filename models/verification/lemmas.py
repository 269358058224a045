"""Lemmas for the proofs of a train's verification."""

from __future__ import annotations

from safeloc.language.expr import Bool, between, exact_to, with_unit
from safeloc.language.units import MM, NM, UM
from safeloc.models.verification.doubted import Doubted
from safeloc.models.verification.variables import Parts


def lemmas(own: Parts, trusted: Bool) -> dict[str, Bool]:
    """Return the lemmas for a fibre whose readings are true within their bounds: a trusted position is true and recently verified."""
    interval = between(
        exact_to(own.front - own.front_margin_below, NM), own.truth, exact_to(own.front + own.front_margin_above, NM)
    )
    return {
        "a trusted position holds the truth": trusted.implies(interval),
        **_trust(own, trusted),
        "a count verified now is the train's": (trusted & own.by_count & own.verified_ago.eq(0)).implies(
            own.axles.eq(own.stored_axles)
        ),
    }


def without_belief(train: Doubted, known: Bool, trusted: Bool) -> dict[str, Bool]:
    """Return the lemmas for a fibre that may be wrong: the stored record is true, and a trusted position agrees with it."""
    own, limit = train.own, train.own.config.place_doubt_limit_mm
    width = own.possible_high - own.possible_low
    serves, tolerance = known & (width <= limit), own.config.place_tolerance_mm
    met = (own.front - own.front_margin_below - own.possible_high <= tolerance) & (
        own.possible_low - own.front - own.front_margin_above <= tolerance
    )
    return {
        **_trust(own, trusted),
        "the stored count is the train's": known.implies(own.axles.eq(own.stored_axles)),
        "the stored length is the train's": known.implies(
            between(exact_to(own.stored_length_low, UM), own.length, exact_to(own.stored_length_high, UM))
        ),
        "the spread of the length is the record's": known.implies(
            train.spread.eq(exact_to(own.stored_length_high - own.stored_length_low, UM))
        ),
        "the front is where it can be": serves.implies(
            between(exact_to(own.possible_low, NM), own.truth, exact_to(own.possible_high, NM))
        ),
        "the world follows the width that the record leaves open": serves.implies(train.width.eq(exact_to(width, NM))),
        "the width that the record leaves open grows": serves.implies(
            with_unit(train.record_ago * (2 * own.config.fastest_run_mm), MM) <= width
        ),
        "trusted is no farther than the record allows": trusted.implies(met & (width <= limit)),
        "a trusted position is the last place": trusted.implies(
            own.place_known & own.reach_since.eq(0) & own.last_place.eq(own.front)
        ),
        "a verification is no younger than the fibre's right data": known.implies(
            train.since_confirmed <= own.verified_ago
        ),
    }


def _trust(own: Parts, trusted: Bool) -> dict[str, Bool]:
    """Return the lemmas of either world: trust rests on a recent verification."""
    return {
        "trusted is verified lately": trusted.implies(own.verified_ago <= own.config.currency_cycles),
        "trusted rests on count or length": trusted.implies(own.by_count | own.by_length),
    }
